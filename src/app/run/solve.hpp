// The parts of a run, for runs of one mesh (run.cpp) and of many (frames.cpp).
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "report/report.hpp"
#include "report/results.hpp"
#include "base/error.hpp"

namespace almesh {

class Checkpoint;

// What is run, on the terminal. bytes: of memory that will be needed.
void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem, double bytes);

// The solution on coarser meshes, where the deck starts from there, the functional, and Algorithm 1. checkpoint: null
// for none.
Solution solve(const Deck& deck, const Problem& problem, Checkpoint* checkpoint, Report& report, std::FILE* out);

// Sets the nodes inside elements of volumes that follow a motion to where it takes them, like those on their sides,
// which the constraint has brought there; they stay where an element would not be valid. x: a valid mesh, in the run's
// frame.
void place_inside_volumes(const Problem& problem, std::vector<double>& x);

// Sets the nodes of fixed boundaries to their targets, and where the deck wants it all of what has converged.
void snap(const Deck& deck, const Problem& problem, Solution& solution);

// Gives x, in the run's frame, the digits that it has in the file's.
void round_as_file(const Problem& problem, std::vector<double>& x);

// Certificates, distances, and the diagnosis of what went wrong.
void examine(const Deck& deck, const Problem& problem, Solution& solution);

// Of a solution with its certificates; kind none where it converged and is certified, and where nothing held it up.
// Each status has its own kind (method/status.cpp).
Diagnosis diagnose(const Deck& deck, const Problem& problem, const Solution& solution);

// The last lines of a run's report. fallbacks: Newton steps in which Cholesky took over.
void print_ending(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution, int fallbacks);

// For each physical group of elements, where there are several: energy, relative quality, and largest distortion as of
// a mesh of its own; and least scaled Jacobian.
void print_volumes(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution);

// A motion in time. The exit code is that of the worst frame. Throws Error where a frame cannot begin, unless
// keep_going.
ExitCode run_frames(const Deck& deck, std::FILE* out);

}  // namespace almesh
