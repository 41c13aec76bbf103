// The cell types of meshes: everything that depends on the shape of a cell, one row of a table for each type.
//
// The rows are the simplices of dimension 0 to 3 and the quadrilateral. Hexahedra, prisms and pyramids would be further
// rows. What the program assumes beyond the table would have to change with them:
//
//   faces of elements are simplices                             Mesh::faces, constraint/, check/target_check
//   nodes are multi-indices of a simplex or of two lines        LagrangeBasis, gmsh_node_order()
//   a cell is cut into simplices along its vertices             sub_simplices.hpp, for certificates and valid steps
//   quadrature                                                  cell_quadrature()
//   children have vertices, edge midpoints and the middle as    CellType::children, refine.cpp
//   vertices
//   the best shape is the regular simplex or the square         check/quality
//
// The reference simplex is {xi >= 0, sum xi <= 1}; its vertex 0 is the origin, vertex k the unit vector k - 1.
#pragma once
#include <array>
#include <span>
#include <vector>

namespace almesh {

inline constexpr int max_degree = 7;  // the highest that Gmsh has element types for

// Local vertices. In children and octahedra, numbers from dim + 1 on stand for the midpoints of `bisected`.
using CellEdge = std::array<int, 2>;
using CellFace = std::array<int, 3>;        // an edge in 2D: the last entry is -1
using CellChild = std::array<int, 4>;       // dim + 1 entries
using CellOctahedron = std::array<int, 6>;  // a diagonal (a, b), and the ring of the other four vertices around it

struct CellType {
    const char *name, *plural;
    int dim, vertices;
    int inverse_volume;                           // 1 / volume of the reference cell: dim! of a simplex
    std::span<const CellEdge> edges;              // in the order of Gmsh's edge nodes
    std::span<const CellFace> faces;              // oriented outward; face k of a simplex is opposite vertex k
    std::span<const CellFace> interior_faces;     // in the order of Gmsh's face nodes, each from its first vertex
    std::span<const CellEdge> bisected;           // edges in the order in which refinement numbers their midpoints
    std::span<const CellChild> children;          // of uniform refinement, positively oriented
    std::span<const CellOctahedron> octahedra;    // the rest of a tetrahedron, seen along each of its diagonals
    std::array<int, max_degree> msh_types;        // element types of Gmsh (GmshDefines.h) by degree - 1; 0: none
    std::array<int, 3> vtk_types;                 // cell types of VTK: linear, quadratic, Lagrange of any degree

    double volume() const { return 1.0 / inverse_volume; }  // of the reference cell
    bool is_simplex() const { return vertices == dim + 1; }
    int node_count(int degree) const;
};

// The simplex of dimension 0 to 3.
const CellType& simplex(int dim);
// The reference quadrilateral is [0, 1]^2, its vertices are (0, 0), (1, 0), (1, 1), (0, 1).
const CellType& quadrilateral();
std::span<const CellType> cell_types();

// The cell type with this linear cell type of VTK, or nullptr.
const CellType* cell_of_vtk_type(int type);

// Of a simplex a_0 .. a_dim, sum = degree; entries beyond dim are zero. Of a quadrilateral those of both coordinates,
// a_0 + a_1 = a_2 + a_3 = degree.
using MultiIndex = std::array<int, 4>;

// Nodes of a simplex: binomial(degree + dim, dim). Inline and without a general division: called in inner loops.
constexpr int simplex_node_count(int dim, int degree) {
    if (dim == 3) return (degree + 1) * (degree + 2) * (degree + 3) / 6;
    if (dim == 2) return (degree + 1) * (degree + 2) / 2;
    return dim == 1 ? degree + 1 : 1;
}

// Multi-indices of the nodes: vertices, edges from their first vertex to their second, the interior of each face and
// the interior of the cell, the last two recursively as a simplex of degree - 3 and degree - 4.
std::vector<MultiIndex> lattice_nodes(int dim, int degree, std::span<const CellEdge> edges,
                                      std::span<const CellFace> interior_faces);

// The same in Gmsh's order (Gmsh reference manual, "Node ordering"), which is that of all meshes here.
std::vector<MultiIndex> gmsh_node_order(int dim, int degree);
std::vector<MultiIndex> gmsh_node_order(const CellType& cell, int degree);

}  // namespace almesh
