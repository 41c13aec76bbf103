// Cells in files: their types in those of Gmsh, their orders of nodes in those of other programs, and what is read.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "mesh/cells.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// Node i of a cell of a legacy VTK file is node vtk_node_order(...)[i] of Gmsh's. Lagrange cells, which are
// written from degree 3 on, have another order than VTK's older ones.
std::vector<int> vtk_node_order(const CellType& cell, int degree, bool is_lagrange);
inline std::vector<int> vtk_node_order(const CellType& cell, int degree) {
    return vtk_node_order(cell, degree, degree > 2);
}

// The same of a cell of SU2: vertices in VTK's order, from degree 2 on lexicographic, the first coordinate fastest.
std::vector<int> su2_node_order(const CellType& cell, int degree);

// "triangles and quadrilaterals": the cells of the table of these dimensions.
std::string readable_cells(int lowest = 2, int highest = 3);

// Cells of degree 2 that have nodes at their vertices and on their edges alone, with their types in files.
struct SerendipityCell {
    const CellType* cell;
    int msh_type, vtk_type;

    int nodes() const { return cell->vertices + static_cast<int>(cell->edges.size()); }
};
std::span<const SerendipityCell> serendipity_cells();

// Gives these the other nodes of their degree, where they have -1 for them: in the middle of a quadrilateral one node
// of all cells there, that of a complete cell where there is one. Adds a note.
void complete_serendipity(RawMesh& mesh);

// In some programs a hexahedron with a node at two of its vertices stands for a prism: makes linear cells of that kind
// the triangles, tetrahedra, pyramids and prisms that they are, with a note. Throws InputError for others.
void simplify_cells(RawMesh& mesh);

// An element type of MSH files, by its number (GmshDefines.h).
struct MshType {
    int number;
    const CellType* cell = nullptr;  // none: not a complete cell of the table of a degree up to max_degree
    int degree = 0, nodes = 0;  // nodes: in the file
};

MshType msh_type(int number);

// Elements of types that are not read, counted to be refused all together.
struct ForeignMshElements {
    struct Kind {
        int type, line;  // of the first; 0: of a binary file
        long long count;
    };
    std::vector<Kind> kinds;

    void add(int type, int line, long long count);
    std::string message() const;  // what they are, with what to do about them
};

}  // namespace almesh
