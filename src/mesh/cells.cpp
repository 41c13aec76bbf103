// The table of cell types, and the order of the nodes in a cell.
//
// A tetrahedron is refined into four corner tetrahedra and an octahedron, which one of its diagonals cuts into four
// more (Bey, Computing 55, 1995).
#include "mesh/cells.hpp"

#include <algorithm>

namespace almesh {
namespace {

constexpr std::array<MultiIndex, 4> simplex_corners = {{{1}, {0, 1}, {0, 0, 1}, {0, 0, 0, 1}}};

constexpr std::array<CellEdge, 1> line_edges = {{{0, 1}}};
constexpr std::array<CellFace, 2> line_faces = {{{1, -1, -1, -1}, {0, -1, -1, -1}}};
constexpr std::array<CellChild, 2> line_children = {{{0, 2}, {2, 1}}};

constexpr std::array<CellEdge, 3> triangle_edges = {{{0, 1}, {1, 2}, {2, 0}}};
constexpr std::array<CellFace, 3> triangle_faces = {{{1, 2, -1, -1}, {2, 0, -1, -1}, {0, 1, -1, -1}}};
constexpr std::array<CellChild, 4> triangle_children = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

constexpr std::array<CellEdge, 6> tetrahedron_edges = {{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}}};
constexpr std::array<CellFace, 4> tetrahedron_faces = {{{1, 2, 3, -1}, {0, 3, 2, -1}, {0, 1, 3, -1}, {0, 2, 1, -1}}};
constexpr std::array<CellFace, 4> tetrahedron_interior = {{{0, 2, 1, -1}, {0, 1, 3, -1}, {0, 3, 2, -1}, {3, 1, 2, -1}}};
constexpr std::array<CellEdge, 6> tetrahedron_bisected = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
constexpr std::array<CellChild, 4> tetrahedron_children = {{{0, 4, 5, 6}, {4, 1, 7, 8}, {5, 7, 2, 9}, {6, 8, 9, 3}}};
constexpr std::array<CellOctahedron, 3> tetrahedron_octahedra = {
    {{4, 9, 5, 6, 8, 7}, {5, 8, 4, 7, 9, 6}, {6, 7, 4, 5, 9, 8}}};

// Edges, and refinement into four around the centre, vertex 8.
constexpr std::array<MultiIndex, 4> quadrilateral_corners = {{{1, 0, 1, 0}, {0, 1, 1, 0}, {0, 1, 0, 1}, {1, 0, 0, 1}}};
constexpr std::array<CellEdge, 4> quadrilateral_edges = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}};
constexpr std::array<CellFace, 4> quadrilateral_faces = {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1},
                                                          {3, 0, -1, -1}}};
constexpr std::array<CellChild, 4> quadrilateral_children = {{{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}}};

constexpr std::array<MultiIndex, 8> hexahedron_corners = {
    {{1, 0, 1, 0, 1, 0}, {0, 1, 1, 0, 1, 0}, {0, 1, 0, 1, 1, 0}, {1, 0, 0, 1, 1, 0},
     {1, 0, 1, 0, 0, 1}, {0, 1, 1, 0, 0, 1}, {0, 1, 0, 1, 0, 1}, {1, 0, 0, 1, 0, 1}}};
constexpr std::array<CellEdge, 12> hexahedron_edges = {
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};
constexpr std::array<CellFace, 6> hexahedron_faces = {
    {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}}};
constexpr std::array<CellChild, 8> hexahedron_children = {
    {{0, 8, 20, 9, 10, 21, 26, 22}, {8, 1, 11, 20, 21, 12, 23, 26}, {20, 11, 2, 13, 26, 23, 14, 24},
     {9, 20, 13, 3, 22, 26, 24, 15}, {10, 21, 26, 22, 4, 16, 25, 17}, {21, 12, 23, 26, 16, 5, 18, 25},
     {26, 23, 14, 24, 25, 18, 6, 19}, {22, 26, 24, 15, 17, 25, 19, 7}}};

constexpr std::array<MultiIndex, 6> prism_corners = {
    {{1, 0, 0, 1, 0}, {0, 1, 0, 1, 0}, {0, 0, 1, 1, 0}, {1, 0, 0, 0, 1}, {0, 1, 0, 0, 1}, {0, 0, 1, 0, 1}}};
constexpr std::array<CellEdge, 9> prism_edges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}}};
constexpr std::array<CellFace, 5> prism_faces = {
    {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}}};
constexpr std::array<CellChild, 8> prism_children = {
    {{0, 6, 7, 8, 15, 16}, {6, 1, 9, 15, 10, 17}, {7, 9, 2, 16, 17, 11}, {6, 9, 7, 15, 17, 16},
     {8, 15, 16, 3, 12, 13}, {15, 10, 17, 12, 4, 14}, {16, 17, 11, 13, 14, 5}, {15, 17, 16, 12, 14, 13}}};

constexpr std::array<MultiIndex, 5> pyramid_corners = {
    {{1, 0, 1, 0, 0}, {0, 1, 1, 0, 0}, {0, 1, 0, 1, 0}, {1, 0, 0, 1, 0}, {0, 0, 0, 0, 1}}};
constexpr std::array<CellEdge, 8> pyramid_edges = {{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}};
constexpr std::array<CellFace, 5> pyramid_faces = {
    {{0, 1, 4, -1}, {3, 0, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {0, 3, 2, 1}}};
// Six pyramids, and a tetrahedron at each edge of the base.
constexpr std::array<CellChild, 10> pyramid_children = {
    {{0, 5, 13, 6, 7, -1, -1, -1}, {5, 1, 8, 13, 9, -1, -1, -1}, {13, 8, 2, 10, 11, -1, -1, -1},
     {6, 13, 10, 3, 12, -1, -1, -1}, {7, 9, 11, 12, 4, -1, -1, -1}, {7, 12, 11, 9, 13, -1, -1, -1},
     {5, 13, 7, 9, -1, -1, -1, -1}, {8, 13, 9, 11, -1, -1, -1, -1}, {10, 13, 11, 12, -1, -1, -1, -1},
     {6, 13, 12, 7, -1, -1, -1, -1}}};

constexpr std::span<const MultiIndex> corners_of_simplex(int dim) { return std::span(simplex_corners).first(dim + 1); }

constexpr CellType cells[] = {
    {"point", "points", 0, 1, {0}, false, 1, corners_of_simplex(0), {}, {}, {}, {}, {}, {}, {15}, {1, 1, 1}},
    {"line", "lines", 1, 2, {1}, false, 1, corners_of_simplex(1), line_edges, line_faces, {}, line_edges,
     line_children, {}, {1, 8, 26, 27, 28, 62, 63}, {3, 21, 68}},
    {"triangle", "triangles", 2, 3, {2}, false, 2, corners_of_simplex(2), triangle_edges, triangle_faces, {},
     triangle_edges, triangle_children, {}, {2, 9, 21, 23, 25, 42, 43}, {5, 22, 69}},
    {"tetrahedron", "tetrahedra", 3, 4, {3}, false, 6, corners_of_simplex(3), tetrahedron_edges, tetrahedron_faces,
     tetrahedron_interior, tetrahedron_bisected, tetrahedron_children, tetrahedron_octahedra,
     {4, 11, 29, 30, 31, 71, 72}, {10, 24, 71}},
    {"quadrilateral", "quadrilaterals", 2, 4, {1, 1}, false, 1, quadrilateral_corners, quadrilateral_edges,
     quadrilateral_faces, {}, quadrilateral_edges, quadrilateral_children, {}, {3, 10, 36, 37, 38, 47, 48},
     {9, 28, 70}},
    {"hexahedron", "hexahedra", 3, 8, {1, 1, 1}, false, 1, hexahedron_corners, hexahedron_edges, hexahedron_faces,
     hexahedron_faces, hexahedron_edges, hexahedron_children, {}, {5, 12, 92, 93, 94, 95, 96}, {12, 29, 72}},
    {"prism", "prisms", 3, 6, {2, 1}, false, 2, prism_corners, prism_edges, prism_faces, prism_faces, prism_edges,
     prism_children, {}, {6, 13, 90, 91, 106, 107, 108}, {13, 32, 73}},
    {"pyramid", "pyramids", 3, 5, {1, 1, 1}, true, 3, pyramid_corners, pyramid_edges, pyramid_faces, pyramid_faces,
     pyramid_edges, pyramid_children, {}, {7, 14, 118, 119, 120, 121, 122}, {14, 27, 0}}};

// a + (u (b - a) + v (c - a)) / degree
MultiIndex affine(const MultiIndex& a, const MultiIndex& b, const MultiIndex& c, int u, int v, int degree) {
    MultiIndex result = a;
    for (std::size_t k = 0; k < a.size(); ++k) result[k] += (u * (b[k] - a[k]) + v * (c[k] - a[k])) / degree;
    return result;
}

// The nodes inside a cell, as indices of a lower degree with one missing in each entry.
std::vector<MultiIndex> interior_nodes(const CellType& cell, int degree, std::span<const CellEdge> edges,
                                       std::span<const CellFace> interior_faces) {
    if (cell.factors[0] == 2 && cell.factors[1] == 1) {  // triangle by triangle node, along the line
        std::vector<MultiIndex> nodes;
        if (degree < 3) return nodes;
        for (const MultiIndex& a : gmsh_node_order(2, degree - 3))
            for (const MultiIndex& b : gmsh_node_order(1, degree - 2)) nodes.push_back({a[0], a[1], a[2], b[0], b[1]});
        return nodes;
    }
    const int lower = degree - (cell.is_collapsed ? 3 : cell.factors[0] + 1);
    return lower < 0 ? std::vector<MultiIndex>{} : lattice_nodes(cell, lower, edges, interior_faces);
}

}  // namespace

const CellType& simplex(int dim) { return cells[dim]; }

const CellType& quadrilateral() { return cells[4]; }

const CellType& hexahedron() { return cells[5]; }

const CellType& prism() { return cells[6]; }

const CellType& pyramid() { return cells[7]; }

std::span<const CellType> cell_types() { return cells; }

int CellType::node_count(int degree) const {
    if (is_collapsed) return (degree + 1) * (degree + 2) * (2 * degree + 3) / 6;
    int count = 1;
    for (const int of_factor : factors) count *= simplex_node_count(of_factor, degree);
    return count;
}

int CellType::entries() const {
    if (is_collapsed) return 5;
    int sum = 1 + factors[0];
    for (int k = 1; k < 3; ++k) sum += factors[k] > 0 ? factors[k] + 1 : 0;
    return sum;
}

Coordinate CellType::coordinate(int number) const {
    Coordinate at{0, 0, number + 1};
    for (; at.to - at.from > factors[at.factor]; ++at.to) at.from += factors[at.factor++] + 1;
    return at;
}

const CellType& CellType::child_type(const CellChild& child) const {
    return is_collapsed && child[4] < 0 ? simplex(3) : *this;
}

const CellType& CellType::face_type(int k) const {
    return dim == 3 && faces[k][3] >= 0 ? quadrilateral() : simplex(dim - 1);
}

const CellType* cell_of_vtk_type(int type) {
    const auto is_it = [type](const CellType& cell) { return cell.vtk_types[0] == type; };
    const auto cell = std::find_if(std::begin(cells), std::end(cells), is_it);
    return cell == std::end(cells) ? nullptr : cell;
}

// A product over the factors; in the layers of a pyramid the base has degree - k in each of two.
std::array<int, 8> vertex_weights(const CellType& cell, const MultiIndex& a) {
    std::array<int, 8> weight{};
    for (int v = 0; v < cell.vertices; ++v) {
        weight[v] = 1;
        for (std::size_t k = 0; k < a.size(); ++k)
            if (cell.corners[v][k]) weight[v] *= a[k];
    }
    if (cell.is_collapsed) weight[4] *= std::max(a[0] + a[1], 1);
    return weight;
}

std::vector<MultiIndex> lattice_nodes(const CellType& cell, int degree, std::span<const CellEdge> edges,
                                      std::span<const CellFace> interior_faces) {
    if (degree == 0) return {MultiIndex{}};
    std::vector<MultiIndex> nodes(cell.corners.begin(), cell.corners.end());
    for (MultiIndex& vertex : nodes)
        for (int& entry : vertex) entry *= degree;
    const std::vector<MultiIndex> vertex = nodes;
    for (const auto& [from, to] : edges)
        for (int s = 1; s < degree; ++s)
            nodes.push_back(affine(vertex[from], vertex[to], vertex[to], s, 0, degree));
    for (const CellFace& face : interior_faces) {
        const bool is_quadrilateral = face[3] >= 0;
        const CellType& type = is_quadrilateral ? quadrilateral() : simplex(2);
        for (const MultiIndex& inner : interior_nodes(type, degree, type.edges, {}))
            nodes.push_back(affine(vertex[face[0]], vertex[face[1]], vertex[face[is_quadrilateral ? 3 : 2]],
                                   inner[1] + 1, inner[is_quadrilateral ? 3 : 2] + 1, degree));
    }
    if (cell.dim < 2) return nodes;  // all nodes of a line are on its edge
    for (const MultiIndex& inner : interior_nodes(cell, degree, edges, interior_faces)) {
        nodes.push_back(inner);
        for (int e = 0; e < cell.entries(); ++e) ++nodes.back()[e];
    }
    return nodes;
}

std::vector<MultiIndex> gmsh_node_order(const CellType& cell, int degree) {
    return lattice_nodes(cell, degree, cell.edges, cell.interior_faces);
}

std::vector<MultiIndex> gmsh_node_order(int dim, int degree) { return gmsh_node_order(simplex(dim), degree); }

}  // namespace almesh
