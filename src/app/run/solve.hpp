// What runs of one mesh (run.cpp) and of many (frames.cpp) print.
#pragma once
#include <cstdio>

#include "problem/problem.hpp"
#include "report/iteration_table.hpp"
#include "report/results.hpp"
#include "base/error.hpp"

namespace almesh {

// What is run, on the terminal. bytes: of memory that will be needed.
void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem, double bytes);

// The last lines of a run's report. fallbacks: Newton steps in which Cholesky took over.
void print_ending(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution, int fallbacks);

// For each physical group of elements, where there are several: energy, relative quality, and largest distortion as of
// a mesh of its own; and least scaled Jacobian.
void print_volumes(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution);

// A motion in time. The exit code is that of the worst frame. Throws Error where a frame cannot begin, unless
// keep_going.
ExitCode run_frames(const Deck& deck, std::FILE* out);

}  // namespace almesh
