// The program's commands, but for sweep.hpp. Results go to `out`.
#pragma once
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace almesh {

struct Certificate;
struct Deck;
struct InvalidElements;
struct Mesh;
struct Problem;
struct Solution;

// arguments: without the program's name. Prints errors to `error`; returns the exit code.
int command_line(const std::vector<std::string>& arguments, std::FILE* out, std::FILE* error);

// One run of a deck, from the mesh file to the files of results, with a table of its iterations. Throws Error for what
// the user can mend before anything is solved.
struct RunHooks {
    std::function<void(const Problem&)> begins;             // before the folder of results is touched
    std::function<void(const Problem&, Solution&)> solved;  // where it converged; an Error is told when all is written
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

// How many elements the certificate could not prove valid, and the worst ten: id, centre, lower bound of the scaled
// Jacobian and, if it is known (check/infeasible.hpp), why. Prints nothing where all are certified. x: nodes x dim in
// units of the file.
void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate,
                       const std::string& folder, const std::vector<std::string>& why = {});

// Where there are more than ten, writes them all to invalid.csv in the folder, which is made if it is missing; "": to
// none. Returns a line that says so, else "".
std::string write_invalid(const InvalidElements& list, const std::string& folder);

// What was built, for --version and for every file that a run writes.
std::string version();   // "almesh 0.1.0"
std::string commit();    // abbreviated git commit, -dirty where the tree had changes, "unknown" outside git
std::string compiler();  // name, version and flags

}  // namespace almesh
