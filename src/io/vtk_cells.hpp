// The cells of VTK's files, legacy and XML.
#pragma once
#include <string>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Cell c has the points connectivity[offsets[c] ... offsets[c + 1]).
struct VtkCells {
    std::vector<long long> offsets, connectivity, types;
    bool are_of_vtk_8 = false;  // Lagrange hexahedra with two edges in another order
};

// Appends them, once the nodes are there. line: of the elements. Throws InputError, which begins with `where`, where
// numbers are out of range, and for cells of other types, all together.
void append_vtk_cells(const VtkCells& cells, const std::string& where, int line, RawMesh& mesh);

}  // namespace almesh
