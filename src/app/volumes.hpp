// Groups of elements in a run: what they came to, and the nodes inside the elements of those that follow a motion.
#pragma once
#include <cstdio>

#include "app/deck.hpp"
#include "app/problem.hpp"
#include "app/results.hpp"

namespace almesh {

// Sets the nodes inside elements of volumes that follow a motion to where it takes them, like those on their sides,
// which the constraint has brought there; they stay where an element would not be valid. x: a valid mesh, in the run's
// frame.
void place_inside_volumes(const Problem& problem, std::vector<double>& x);

// For each physical group of elements, where there are several: energy, relative quality, and largest distortion as of
// a mesh of its own; and least scaled Jacobian.
void print_volumes(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution);

}  // namespace almesh
