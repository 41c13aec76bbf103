// Which line of the deck moves which boundary of the mesh.
#pragma once
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Makes the boundaries of the mesh those of the deck: inner faces and volumes that it names become boundaries, faces in
// several groups that one line moves are one boundary of its name. In a mesh that is improved, `rest` and `all` stand
// for all boundaries inside too, named ones and those between groups of elements. Notes what is left free inside.
// Throws UsageError where a line or `wall` names no group of the mesh, where a motion does not fit the dimension, and
// where faces belong to two groups whose motions disagree.
void assign_boundaries(const Deck& deck, Mesh& mesh, std::vector<std::string>& notes);

// One motion per boundary of the mesh; each must have one in the deck, `all` and `rest` stand for those not named.
// Throws UsageError with the lines that are missing.
std::vector<Motion> motions_of(const Deck& deck, const Mesh& mesh);

}  // namespace almesh
