// The program's commands, but for sweep.hpp. Results go to `out`.
#pragma once
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace almesh {

struct Deck;
struct Problem;
struct Solution;

// arguments: without the program's name. Prints errors to `error`; returns the exit code.
int command_line(const std::vector<std::string>& arguments, std::FILE* out, std::FILE* error);

// One run of a deck, from the mesh file to the files of results, with a table of its iterations. Throws Error for what
// the user can mend before anything is solved.
struct RunHooks {
    std::function<void(const Problem&)> begins = {};  // before the folder of results is touched
    // Where it converged; an Error is told when all is written.
    std::function<void(const Problem&, Solution&)> solved = {};
    std::function<void()> stepped = {};  // after every Newton step, and every part of a mesh that is curved in place
    double seconds_between_meshes = 60;  // that are written on the way (problem/so_far.hpp)
};
ExitCode run(const Deck& deck, std::FILE* out, const RunHooks& hooks = {});

// Derivatives of the moved mesh (method/derivative.hpp). arguments: `adjoint` or `tangent`, a deck, files of vectors at
// nodes, settings. Throws Error where there are none.
ExitCode differentiate(const std::vector<std::string>& arguments, std::FILE* out);

// Certificate and statistics of the deck's mesh. success: every element is certified valid, else not_certified. before:
// a file of the same mesh, from which the distance of the boundary is measured; "": none. Throws InputError for a file
// that is no mesh, and where the two are not the same.
ExitCode quality(const Deck& deck, const std::string& before, std::FILE* out);

// What is in the deck's mesh file, as comments, and a deck to start from, wherever it is put: all boundaries fixed,
// and the keys that were given. Throws InputError for a file that is no mesh.
ExitCode info(const Deck& deck, std::FILE* out);

}  // namespace almesh
