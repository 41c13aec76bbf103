// What is in a mesh file, as a deck to start from.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "deck/deck.hpp"

namespace almesh {

// mesh: of the deck, as it is in the file. What it has, as comments, and a deck: all boundaries fixed, and the keys that
// were given. notes: of reading it.
void describe_mesh(const Output& out, const Deck& deck, const Mesh& mesh, const std::vector<std::string>& notes);

}  // namespace almesh
