// The program's commands. What they say goes to `out`; its objects: outputs/schema.json.
#pragma once
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/table.hpp"

namespace almesh {

struct Deck;
struct Problem;
struct Solution;

// arguments: without the program's name. Prints errors to `error`, with --json all text; returns the exit code.
int command_line(std::vector<std::string> arguments, std::FILE* out, std::FILE* error);

// One run of a deck, from the mesh file to the files of results, with a table of its iterations. Throws Error for what
// the user can mend before anything is solved.
struct RunHooks {
    std::function<void(const Problem&)> begins = {};  // before the folder of results is touched
    // Where it converged; an Error is told when all is written.
    std::function<void(const Problem&, Solution&)> solved = {};
    std::function<void()> stepped = {};  // after every Newton step, and every part of a mesh that is curved in place
    double seconds_between_meshes = 60;  // that are written on the way (deck/so_far.hpp)
};
ExitCode run(const Deck& deck, const Output& out, const RunHooks& hooks = {});

// The same of a motion in time. The exit code is that of the worst frame. Throws Error where a frame cannot begin,
// unless keep_going.
ExitCode run_frames(const Deck& deck, const Output& out);

// Derivatives of the moved mesh (method/derivative.hpp). arguments: `adjoint` or `tangent`, a deck, files of vectors at
// nodes, settings. Throws Error where there are none.
ExitCode differentiate(const std::vector<std::string>& arguments, const Output& out);

// Certificate and statistics of the deck's mesh. success: every element is certified valid, else not_certified; so too
// where there is no proof that was asked for. Throws InputError for a file that is no mesh, and where the two are not
// the same.
struct QualityFiles {
    std::string before;  // a file of the same mesh, from which the distance of the boundary is measured; "": none
    std::string proof;   // to write (io/proof_file.hpp); "": none
};
ExitCode quality(const Deck& deck, const QualityFiles& files, const Output& out);

// What is in the deck's mesh file, as comments, and a deck to start from, wherever it is put: all boundaries fixed,
// and the keys that were given. Throws InputError for a file that is no mesh.
ExitCode info(const Deck& deck, const Output& out);

// A run for each combination of the values of the lines `sweep`. arguments: DECK, settings of the command line, and at
// most one of
//
//   --slurm      write sweep.sh, the batch script of a job array of Slurm, instead of running
//   --run K/N    only the runs K, K + N, K + 2 N, ...: a task of that array
//   --collect    only gather what has been run
//
// Otherwise as many runs at a time as there are cores for their threads. Writes sweep.csv in the deck's folder of
// results: a row for each run that has ended, with all quantities of its summary. The exit code is the lowest of a run
// but success; a run that is missing counts as not_converged. Throws UsageError for what is wrong with any run's deck
// before the first one starts, and InputError where another sweep writes to the folder.
ExitCode sweep(const std::vector<std::string>& arguments, const Output& out);

}  // namespace almesh
