// What a run, of one mesh or of many, prints, besides its iterations (iteration_table.hpp).
#pragma once
#include <cstdio>

#include "deck/deck.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// What is run; of a single mesh, whether it needs much memory.
void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem);

// How good the elements are before and after; also writes quality.csv.
void report_improvement(const Output& out, const Deck& deck, const Problem& problem, const Solution& solution);

// The last lines of a run's report. fallbacks: Newton steps in which Cholesky took over.
void print_ending(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution, int fallbacks);

// For each physical group of elements, where there are several: energy, relative quality, and largest distortion as of
// a mesh of its own; and certified bound.
void print_volumes(const Output& out, const Deck& deck, const Problem& problem, const Solution& solution);

}  // namespace almesh
