// Targets that make faces or elements infeasible (check/infeasible.hpp): found and dealt with before solving, as the
// keys `split` and `surface` say.
#pragma once
#include <string>
#include <vector>

namespace almesh {

struct Deck;
struct Problem;

// With split = auto, divides infeasible elements of the base mesh by nodes inside, and adds a note. Returns how many; 0
// where there are none. The level and the target are to be made again from the base.
int split_infeasible(const Deck& deck, Problem& problem, std::vector<std::string>& notes);

// Frees the nodes around what is infeasible to slide along the surface of the target, and adds a note. Throws
// InputError where that cannot help, or the deck keeps the surface.
void free_infeasible(const Deck& deck, Problem& problem);

}  // namespace almesh
