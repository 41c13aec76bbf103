// Cells in the files of programs other than Gmsh: their orders of nodes, and what is read of them.
#pragma once
#include <string>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Node i of a cell of VTK is node vtk_node_order(...)[i] of Gmsh's. Up to degree 2 also in the other formats.
std::vector<int> vtk_node_order(const CellType& cell, int degree);

// The same of a cell of SU2: vertices in VTK's order, from degree 2 on lexicographic, the first coordinate fastest.
std::vector<int> su2_node_order(const CellType& cell, int degree);

// "triangles, quadrilaterals and tetrahedra": the cells of the table of these dimensions.
std::string readable_cells(int lowest = 2, int highest = 3);

// Gives quadrilaterals of degree 2 that have -1 for their centre, as those of 8 nodes, a node there, and a note.
void add_centres(RawMesh& mesh);

// Throws InputError where a mesh in space has cells that only plane ones may have.
void check_cells(const RawMesh& mesh);

}  // namespace almesh
