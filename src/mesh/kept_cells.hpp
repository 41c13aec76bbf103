// Cells of the file that are carried along with a mesh (KeptCells): finding them in its elements, and in those of a
// mesh that is made from it.
#pragma once
#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// The faces, edges and vertices of elements by their vertices.
class Subcells {
public:
    explicit Subcells(const Mesh& mesh);  // which must outlive this

    // Whether element e has the cell with these vertices, all distinct.
    bool has(int e, const int* vertex, const CellType& cell) const;

    // All nodes of the face or edge of element e, in Gmsh's order from these vertices on, which the element has.
    // Cost: O(nodes of the element) each.
    std::vector<int> nodes(int e, const int* vertex, const CellType& cell) const;

private:
    const Mesh& mesh_;
    std::vector<std::vector<MultiIndex>> order_;  // of each cell type
    std::vector<LagrangeBasis> of_cell_;            // by group of elements

    int local(int e, int node) const;  // its number among the vertices of e, or beyond them
};

// A kept cell of the dimension of faces.
struct KeptFace {
    const CellType* cell;
    const int* nodes;
    int place;  // in the KeptCells of its type
    int element, physical, entity;
    long long id;

    std::span<const int> vertices() const { return {nodes, static_cast<std::size_t>(cell->vertices)}; }
};

// All of them, those of one type together.
std::vector<KeptFace> kept_faces(const Mesh& mesh);

// Per node: whether it is on a point or, in 3D, a curve in a physical group.
std::vector<char> nodes_of_features(const Mesh& mesh);

// Adds cell c of others, but for its nodes.
void append_tags(const KeptCells& from, int c, KeptCells& to);

// Gives kept cells of degree 1 the degree of their mesh, whose elements have it already.
void raise_kept_cells(Mesh& mesh);

// Those of linear_part(mesh): index[node] is the node there, -1: none. Points on nodes that are not there are left out.
void restrict_kept_cells(const Mesh& mesh, const std::vector<int>& index, Mesh& linear);

}  // namespace almesh
