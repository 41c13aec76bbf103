// The surfaces of other meshes along which boundaries slide: the step `slide along FILE` of a motion.
#pragma once
#include <string>
#include <vector>

#include "app/deck.hpp"
#include "constraint/sliding.hpp"

namespace almesh {

// Per boundary of the mesh; empty where all slide along their own, if at all. notes: what was corrected in the files.
// Throws InputError, with the line of the deck, for files that are no mesh of this dimension or have not the boundary.
std::vector<OtherSurface> read_other_surfaces(const Deck& deck, const Mesh& mesh, std::vector<std::string>& notes);

}  // namespace almesh
