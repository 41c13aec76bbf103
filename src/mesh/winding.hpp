// In which order the file has the vertices of a cell that is turned for the run: an element whose volume is negative in
// the file, a face that is oriented outward here. Data of a file by element and corner fit the cells as it has them.
//
// A winding is the number of a permutation: vertex k of the file is vertex windings[w][k] of the cell here.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// Of a cell here, by `count` <= 4 vertices of it, which are also those in the file.
std::uint8_t winding(const int* here, const int* in_file, int count);

// Turns the given elements over, with all their nodes: by the last two vertices of their triangles or tetrahedra, or
// two lines as their factors, exchanged.
void reverse(Mesh& mesh, const std::vector<int>& elements);

// Records that these elements were reversed.
void set_winding(Mesh& mesh, const std::vector<int>& turned);

// The mesh with its elements and faces as the file has them.
Mesh as_in_file(Mesh mesh);

}  // namespace almesh
