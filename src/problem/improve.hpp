// Meshes that are to be made better in place: ideal = regular | size FORMULA | mesh FILE, and almesh improve FILE.
//
// Where the mesh has inverted elements, it is made valid first (untangling.hpp), with the boundary where it is, or
// sliding. The distortion relative to the ideal elements is then minimised from there, by the method and with the
// boundary of the deck. With ideal = regular and boundaries that are fixed or only slide, a valid mesh stays as it is
// where this would lower its least scaled Jacobian, and a boundary whose nodes slide to no valid mesh is fixed.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

// The deck of `improve FILE [key=value ...]`: regular elements, all boundaries slide.
Deck improvement_deck(const std::vector<std::string>& arguments);

// Throws UsageError for what does not go with it.
void check_improve(const Deck& deck);

// Of the level of the problem, in its frame.
void set_ideal_elements(const Deck& deck, Problem& problem);

// newton_steps: those besides the ones of `solve` are added.
Solution improve(const Deck& deck, Problem& problem, const Solve& solve, int& newton_steps, std::FILE* out);

}  // namespace almesh
