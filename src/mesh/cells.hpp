// The cell types of meshes: everything that depends on the shape of a cell, one row of a table for each type.
//
// A cell is a product of simplices, its factors: a quadrilateral of two lines, a hexahedron of three, a prism of a
// triangle and a line; a simplex is its only factor. Nodes, bases, Bernstein forms, quadrature, faces and refinement
// follow from those of the factors. The reference simplex is {xi >= 0, sum xi <= 1}.
//
// The pyramid is a cube whose top is collapsed to the apex: its reference coordinates are (a, b, c) in [0, 1]^3, at
// xi = a (1 - c), eta = b (1 - c), zeta = c of the pyramid with the base [0, 1]^2. Its functions of degree p are those
// of Gmsh's complete pyramid, the sums over k = 0 .. p of products of degree p - k in a and in b with
// B_k(c) = binomial(p, k) c^k (1 - c)^(p - k). Derivatives are always the reduced ones,
//
//     (1 / (1 - c) d/da,  1 / (1 - c) d/db,  d/dc),
//
// polynomials at the apex too. They are those by (xi, eta, zeta) but for a matrix of determinant one, so that det J is
// theirs, and F = J A^-1 does not change (Bergot, Cohen, Durufle, J. Sci. Comput. 42, 2010).
#pragma once
#include <array>
#include <span>
#include <vector>

namespace almesh {

inline constexpr int max_degree = 7;  // the highest that Gmsh has element types for

// Local vertices. In children and octahedra, numbers beyond those stand for the midpoints of `bisected`, then for the
// middles of quadrilateral faces in the order of `faces` and of quadrilaterals and hexahedra themselves.
using CellEdge = std::array<int, 2>;
using CellFace = std::array<int, 4>;        // a triangle in 3D: the last entry is -1; an edge in 2D: the last two
using CellChild = std::array<int, 8>;       // the last entries -1 of a tetrahedron in a pyramid
using CellOctahedron = std::array<int, 6>;  // a diagonal (a, b), and the ring of the other four vertices around it

// Of a node: the barycentric indices of each factor one after the other, those of each with the sum `degree`; entries
// beyond are zero. Of a pyramid (m - i, i, m - j, j, k) with m = degree - k, at a = i / m, b = j / m, c = k / degree.
using MultiIndex = std::array<int, 6>;

// Where a reference coordinate is among the entries of a multi-index: 1 at `to` and 0 at `from`, the first of its factor.
struct Coordinate {
    int factor, from, to;
};

struct CellType {
    const char *name, *plural;
    int dim, vertices;
    std::array<int, 3> factors;                 // dimensions of the simplices it is a product of; 0: no more
    bool is_collapsed;                          // the pyramid
    int inverse_volume;                         // 1 / volume of the reference cell: dim! of a simplex
    std::span<const MultiIndex> corners;        // the vertices, of degree 1
    std::span<const CellEdge> edges;            // in the order of Gmsh's edge nodes
    std::span<const CellFace> faces;            // oriented outward; face k of a simplex is opposite vertex k
    std::span<const CellFace> interior_faces;   // in the order of Gmsh's face nodes, each from its first vertex
    std::span<const CellEdge> bisected;         // edges in the order in which refinement numbers their midpoints
    std::span<const CellChild> children;        // of uniform refinement, positively oriented
    std::span<const CellOctahedron> octahedra;  // the rest of a tetrahedron, seen along each of its diagonals
    std::array<int, max_degree> msh_types;      // element types of Gmsh (GmshDefines.h) by degree - 1; 0: none
    std::array<int, 3> vtk_types;               // cell types of VTK: linear, quadratic, Lagrange of any degree

    double volume() const { return 1.0 / inverse_volume; }  // of the reference cell
    bool is_simplex() const { return vertices == dim + 1; }
    int node_count(int degree) const;
    int entries() const;  // of a multi-index
    Coordinate coordinate(int number) const;
    const CellType& face_type(int k) const;
    const CellType& child_type(const CellChild& child) const;
};

// The simplex of dimension 0 to 3.
const CellType& simplex(int dim);
const CellType& quadrilateral();  // (0, 0), (1, 0), (1, 1), (0, 1)
const CellType& hexahedron();     // the quadrilateral at zeta = 0, then at 1
const CellType& prism();          // the triangle at zeta = 0, then at 1
const CellType& pyramid();        // the quadrilateral at zeta = 0, and the apex
std::span<const CellType> cell_types();

// The cell type with this linear cell type of VTK, or nullptr.
const CellType* cell_of_vtk_type(int type);

// Of a node: whole numbers in the ratio of the weights of the vertices whose mean it is in the straight-sided cell.
std::array<int, 8> vertex_weights(const CellType& cell, const MultiIndex& a);

// Nodes of a simplex: binomial(degree + dim, dim). Inline and without a general division: called in inner loops.
constexpr int simplex_node_count(int dim, int degree) {
    if (dim == 3) return (degree + 1) * (degree + 2) * (degree + 3) / 6;
    if (dim == 2) return (degree + 1) * (degree + 2) / 2;
    return dim == 1 ? degree + 1 : 1;
}

inline constexpr int most_element_nodes = (max_degree + 1) * (max_degree + 1) * (max_degree + 1);

// Multi-indices of the nodes: vertices, edges from their first vertex to their second, the interior of each face and
// the interior of the cell, the last two as the nodes of a cell of a lower degree.
std::vector<MultiIndex> lattice_nodes(const CellType& cell, int degree, std::span<const CellEdge> edges,
                                      std::span<const CellFace> interior_faces);

// The same in Gmsh's order (Gmsh reference manual, "Node ordering"), which is that of all meshes here.
std::vector<MultiIndex> gmsh_node_order(int dim, int degree);
std::vector<MultiIndex> gmsh_node_order(const CellType& cell, int degree);

}  // namespace almesh
