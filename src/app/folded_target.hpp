// Targets that fold elements by themselves, whatever the nodes inside do: faces of the boundary that are invalid or
// cross, elements whose nodes are all on it. Found and dealt with before solving, as the key `surface` says.
#pragma once
#include <vector>

#include "app/deck.hpp"

namespace almesh {

struct Problem;

// Releases the nodes around faces and elements that the target folds, to slide along its surface; notes it. Throws
// InputError where that cannot help, or the deck keeps the surface.
void release_folded(const Deck& deck, Problem& problem);

// Makes faces flat that the target folds, and notes it. Throws InputError where that does not help.
void straighten_folded(const Deck& deck, Problem& problem);

// Makes the chosen faces of the target flat, and more until it folds nothing. chosen: per face. Throws as above.
void straighten_target(const Deck& deck, std::vector<char> chosen, Problem& problem);

}  // namespace almesh
