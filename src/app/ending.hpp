// How a run ended, for its user: whether it converged and what is certified, and of any other ending what held it up
// (check/diagnosis.hpp), at which boundary, node and element, and what to try against that. Places and lengths are in
// the unit of the mesh file, ids those of final.msh.
#pragma once
#include <cstdio>

#include "check/diagnosis.hpp"

namespace almesh {

struct Deck;
struct Problem;
struct Solution;

// Of a solution with its certificates; kind none where it converged and is certified, and where nothing held it up.
// Each status has its own kind (method/status.cpp).
Diagnosis diagnose(const Deck& deck, const Problem& problem, const Solution& solution);

// The last lines of a run's report. fallbacks: Newton steps in which Cholesky took over.
void print_ending(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution, int fallbacks);

}  // namespace almesh
