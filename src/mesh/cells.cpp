// The table of cell types, and the order of the nodes in a cell.
//
// A tetrahedron is refined into four corner tetrahedra and an octahedron, which one of its diagonals cuts into four
// more (Bey, Computing 55, 1995).
#include "mesh/cells.hpp"

#include <algorithm>

namespace almesh {
namespace {

constexpr std::array<CellEdge, 1> line_edges = {{{0, 1}}};
constexpr std::array<CellFace, 2> line_faces = {{{1, -1, -1}, {0, -1, -1}}};
constexpr std::array<CellChild, 2> line_children = {{{0, 2}, {2, 1}}};

constexpr std::array<CellEdge, 3> triangle_edges = {{{0, 1}, {1, 2}, {2, 0}}};
constexpr std::array<CellFace, 3> triangle_faces = {{{1, 2, -1}, {2, 0, -1}, {0, 1, -1}}};
constexpr std::array<CellChild, 4> triangle_children = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

constexpr std::array<CellEdge, 6> tetrahedron_edges = {{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}}};
constexpr std::array<CellFace, 4> tetrahedron_faces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
constexpr std::array<CellFace, 4> tetrahedron_interior_faces = {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}}};
constexpr std::array<CellEdge, 6> tetrahedron_bisected = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
constexpr std::array<CellChild, 4> tetrahedron_children = {{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}};
constexpr std::array<CellOctahedron, 3> tetrahedron_octahedra = {
    {{4, 9, 5, 6, 8, 7}, {5, 8, 4, 7, 9, 6}, {6, 7, 4, 5, 9, 8}}};

// Edges, and refinement into four around the centre, vertex 8.
constexpr std::array<CellEdge, 4> quadrilateral_edges = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
constexpr std::array<CellFace, 4> quadrilateral_faces = {{{0, 1, -1}, {1, 2, -1}, {2, 3, -1}, {3, 0, -1}}};
constexpr std::array<CellChild, 4> quadrilateral_children = {{{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}}};

constexpr CellType cells[] = {
    {"point", "points", 0, 1, 1, {}, {}, {}, {}, {}, {}, {15}, {1, 1, 1}},
    {"line", "lines", 1, 2, 1, line_edges, line_faces, {}, line_edges, line_children, {},
     {1, 8, 26, 27, 28, 62, 63}, {3, 21, 68}},
    {"triangle", "triangles", 2, 3, 2, triangle_edges, triangle_faces, {}, triangle_edges, triangle_children, {},
     {2, 9, 21, 23, 25, 42, 43}, {5, 22, 69}},
    {"tetrahedron", "tetrahedra", 3, 4, 6, tetrahedron_edges, tetrahedron_faces, tetrahedron_interior_faces,
     tetrahedron_bisected, tetrahedron_children, tetrahedron_octahedra, {4, 11, 29, 30, 31, 71, 72}, {10, 24, 71}},
    {"quadrilateral", "quadrilaterals", 2, 4, 1, quadrilateral_edges, quadrilateral_faces, {}, quadrilateral_edges,
     quadrilateral_children, {}, {3, 10, 36, 37, 38, 47, 48}, {9, 28, 70}}};

}  // namespace

const CellType& simplex(int dim) { return cells[dim]; }

const CellType& quadrilateral() { return cells[4]; }

std::span<const CellType> cell_types() { return cells; }

int CellType::node_count(int degree) const {
    return is_simplex() ? simplex_node_count(dim, degree) : (degree + 1) * (degree + 1);
}

const CellType* cell_of_vtk_type(int type) {
    const auto cell = std::find_if(std::begin(cells), std::end(cells),
                                   [&](const CellType& c) { return c.vtk_types[0] == type; });
    return cell == std::end(cells) ? nullptr : cell;
}

std::vector<MultiIndex> lattice_nodes(int dim, int degree, std::span<const CellEdge> edges,
                                      std::span<const CellFace> interior_faces) {
    if (degree == 0) return {MultiIndex{}};
    std::vector<MultiIndex> nodes;
    for (int v = 0; v <= dim; ++v) nodes.emplace_back()[v] = degree;
    for (const auto& [from, to] : edges)
        for (int s = 1; s < degree; ++s) {
            nodes.emplace_back()[from] = degree - s;
            nodes.back()[to] = s;
        }
    if (degree >= 3)
        for (const CellFace& face : interior_faces)
            for (const MultiIndex& inner : gmsh_node_order(2, degree - 3)) {
                nodes.emplace_back();
                for (int k = 0; k < 3; ++k) nodes.back()[face[k]] = inner[k] + 1;
            }
    if (dim >= 2 && degree > dim)
        for (const MultiIndex& inner : lattice_nodes(dim, degree - dim - 1, edges, interior_faces)) {
            nodes.emplace_back();
            for (int v = 0; v <= dim; ++v) nodes.back()[v] = inner[v] + 1;
        }
    return nodes;
}

std::vector<MultiIndex> gmsh_node_order(const CellType& cell, int degree) {
    if (cell.is_simplex()) return gmsh_node_order(cell.dim, degree);
    if (degree == 0) return {MultiIndex{}};
    const int p = degree;
    const std::array<MultiIndex, 4> vertex = {{{p, 0, p, 0}, {0, p, p, 0}, {0, p, 0, p}, {p, 0, 0, p}}};
    std::vector<MultiIndex> nodes(vertex.begin(), vertex.end());
    for (const auto& [from, to] : cell.edges)
        for (int s = 1; s < p; ++s) {
            nodes.emplace_back();
            for (int k = 0; k < 4; ++k) nodes.back()[k] = ((p - s) * vertex[from][k] + s * vertex[to][k]) / p;
        }
    if (p >= 2)
        for (const MultiIndex& inner : gmsh_node_order(cell, p - 2)) {
            nodes.emplace_back();
            for (int k = 0; k < 4; ++k) nodes.back()[k] = inner[k] + 1;
        }
    return nodes;
}

std::vector<MultiIndex> gmsh_node_order(int dim, int degree) {
    const CellType& cell = simplex(dim);
    return lattice_nodes(dim, degree, cell.edges, cell.interior_faces);
}

}  // namespace almesh
