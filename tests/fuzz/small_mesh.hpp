// Small meshes to start from, and damage to their files.
#pragma once
#include "fuzz/choices.hpp"
#include "mesh/mesh.hpp"

namespace almesh::fuzz {

// A square, ring or cube of at most 12 elements of degree 1 to 3, straight or curved, somewhere in space,
// sometimes with a few nodes moved or as two parts; to be written in any format that has it.
Mesh small_mesh(Choices& choose);

// Its file.
std::string text_of_mesh(const Mesh& mesh);

// At up to three places: a byte replaced, a line removed or repeated, or the end cut off.
std::string damaged(std::string text, Choices& choose);

}  // namespace almesh::fuzz
