// The sides of cells by their vertices: the edges of cells in the plane, the faces of those in space. Two cells are
// neighbours where they have sides with the same vertices; a side whose vertices no other one has is on the boundary.
// Cells of both kinds may be the elements of a mesh or its boundary faces, whose sides are edges (3D) or vertices (2D).
#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct Side {
    std::array<int, 4> vertex;  // ascending; those that it does not have are beyond all others
    int number;                 // chosen by the caller: for sides of all cells, cell * (sides of a cell) + local number
    bool even = true;           // whether they go around as these: cells on opposite sides of a face differ
    signed char opposite = 0;   // which of them is across the lowest one in a quadrilateral; 0: it is none

    Side(std::span<const int> vertices, int of) : number(of) {
        vertex.fill(std::numeric_limits<int>::max());
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            vertex[k] = vertices[k];
            for (std::size_t i = k; i > 0 && vertex[i - 1] > vertex[i]; --i) {
                std::swap(vertex[i - 1], vertex[i]);
                even = !even;
            }
        }
        if (vertices.size() < 4) return;
        const auto around = [&](int k) {
            const auto lowest = std::find(vertices.begin(), vertices.end(), vertex[0]) - vertices.begin();
            return vertices[(lowest + k) % 4];
        };
        even = around(1) < around(3);
        opposite = static_cast<signed char>(std::find(vertex.begin(), vertex.end(), around(2)) - vertex.begin());
    }
    bool operator<(const Side& other) const {  // by vertices, then by number
        return vertex != other.vertex ? vertex < other.vertex : number < other.number;
    }
};

// Local nodes of the sides of cells of one dimension and degree.
class SideNodes {
public:
    SideNodes(int dim, int degree);
    // In Gmsh's order, oriented outward (LagrangeBasis::face_nodes()).
    const std::vector<int>& of(const CellType& cell, int side) const { return nodes_[cell.vertices][side]; }

private:
    std::vector<std::vector<std::vector<int>>> nodes_;  // by the number of vertices of the cell, and side
};

// Side k of the cell with these vertices.
inline Side side_of_cell(const CellType& cell, const int* vertices, int k, int number) {
    std::array<int, 4> vertex{};
    const int count = cell.face_type(k).vertices;
    for (int i = 0; i < count; ++i) vertex[i] = vertices[cell.faces[k][i]];
    return {std::span(vertex).first(count), number};
}

inline Side side_of_element(const Mesh& mesh, int e, int k, int number) {
    return side_of_cell(mesh.cell(e), mesh.element(e), k, number);
}

// The sides of boundary face f, with the given number each.
inline void append_sides_of_face(const Mesh& mesh, int f, int number, std::vector<Side>& sides) {
    const CellType& cell = mesh.face_cell(f);
    for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k)
        sides.push_back(side_of_cell(cell, mesh.face(f), k, number));
}

// Calls body(e, k, number) for the sides k of all elements e, ascending: number = e * Mesh::most_sides() + k.
template <class Body>
void for_sides(const Mesh& mesh, const Body& body) {
    const int most = mesh.most_sides();
    for (const ElementGroup& group : mesh.element_groups())
        for (int e = group.first; e < group.first + group.count; ++e)
            for (int k = 0; k < static_cast<int>(group.cell->faces.size()); ++k) body(e, k, e * most + k);
}

// Sorts the sides and calls body(std::span<const Side>) for each set of equal vertices, ascending.
template <class Body>
void for_equal_sides(std::vector<Side>& sides, const Body& body) {
    std::sort(sides.begin(), sides.end());
    const auto last = sides.end();
    for (auto begin = sides.begin(), end = begin; begin != last; begin = end) {
        end = std::find_if(begin, last, [&](const Side& side) { return side.vertex != begin->vertex; });
        body(std::span<const Side>(&*begin, end - begin));
    }
}

// Which of `count` cells to turn over so that neighbours go around their common sides in opposite directions and what
// hangs together has a positive sum of value(cell); parts that cannot be oriented stay. sides: those of cell c have
// numbers from c * most on. Sorts them.
std::vector<char> turned_by_neighbours(int count, std::vector<Side>& sides, int most,
                                       const std::function<double(int)>& value);

// Local number of the side of element e that has the given vertices, in this order around it or the other way round,
// from any of them on; -1: none.
int side_number(const Mesh& mesh, int e, std::span<const int> vertices);

}  // namespace almesh
