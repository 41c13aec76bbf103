// start = FILE: the first iterate from another file than the ideal mesh, such as the final mesh of an earlier run; and
// ideal = mesh FILE.
#pragma once
#include <vector>

#include "deck/deck.hpp"
#include "base/frame.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// The positions of the nodes of the file `path`, which `key` of the deck names, that have the ids of those of `mesh`, in
// the run's frame. Throws InputError where its elements are not those of the mesh, and where one is not valid.
std::vector<double> read_positions(const Deck& deck, const std::string& key, const std::string& path,
                                   const Mesh& mesh, const Frame& frame);

}  // namespace almesh
