// The sides of cells by their vertices: the edges of triangles, the faces of tetrahedra. Two cells are neighbours where
// they have sides with the same vertices; a side whose vertices no other one has is on the boundary. Cells of both
// kinds may be the elements of a mesh or its boundary faces, whose sides are edges (3D) or vertices (2D).
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct Side {
    std::array<int, 4> vertex;  // ascending; those that it does not have are beyond all others
    int number;                 // chosen by the caller: for sides of all cells, cell * (sides of a cell) + local number
    bool even = true;           // whether sorting was an even permutation: cells on opposite sides of a face differ

    Side(std::span<const int> vertices, int of) : number(of) {
        vertex.fill(std::numeric_limits<int>::max());
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            vertex[k] = vertices[k];
            for (std::size_t i = k; i > 0 && vertex[i - 1] > vertex[i]; --i) {
                std::swap(vertex[i - 1], vertex[i]);
                even = !even;
            }
        }
    }
    bool operator<(const Side& other) const {  // by vertices, then by number
        return vertex != other.vertex ? vertex < other.vertex : number < other.number;
    }
};

// Side k of the simplex of the given dimension, opposite its vertex k, with these vertices.
inline Side side_of_simplex(int dim, const int* vertices, int k, int number) {
    std::array<int, 3> vertex{};
    const CellFace& local = simplex(dim).faces[k];
    for (int i = 0; i < dim; ++i) vertex[i] = vertices[local[i]];
    return {std::span(vertex).first(dim), number};
}

// Sorts the sides and calls body(std::span<const Side>) for each set of equal vertices, ascending.
template <class Body>
void for_equal_sides(std::vector<Side>& sides, const Body& body) {
    std::sort(sides.begin(), sides.end());
    const auto last = sides.end();
    for (auto begin = sides.begin(), end = begin; begin != last; begin = end) {
        end = std::find_if(begin, last, [&](const Side& side) { return side.vertex != begin->vertex; });
        body(std::span<const Side>(begin, end));
    }
}

// Local number of the side of element e that has the given vertices (dim of them), -1: none.
int side_number(const Mesh& mesh, int e, const int* vertex);

}  // namespace almesh
