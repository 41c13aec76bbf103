// The parts of a run between the problem and the files, for runs of one mesh (run.cpp) and of many (frames.hpp).
#pragma once
#include <cstdio>

#include "app/problem.hpp"
#include "app/report.hpp"
#include "app/results.hpp"

namespace almesh {

class Checkpoint;

// What is run, on the terminal. bytes: of memory that will be needed.
void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem, double bytes);

// The solution on coarser meshes, where the deck starts from there, the functional, and Algorithm 1. checkpoint: null
// for none.
Solution solve(const Deck& deck, const Problem& problem, Checkpoint* checkpoint, Report& report, std::FILE* out);

// Where the deck wants it, sets the boundary nodes of what has converged to their targets.
void snap(const Deck& deck, Level& level, Solution& solution);

// Gives x, in the run's frame, the digits that it has in the file's.
void round_as_file(const Problem& problem, std::vector<double>& x);

// Certificates, distances, and the diagnosis of what went wrong.
void examine(const Deck& deck, const Problem& problem, Solution& solution);

}  // namespace almesh
