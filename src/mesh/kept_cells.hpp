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

    // Whether element e has the simplex with these vertices: dim + 1 of them, all distinct.
    bool has(int e, const int* vertex, int dim) const;

    // All nodes of the face or edge of element e, in Gmsh's order from these vertices on, which the element has.
    // Cost: O(nodes of the element) each.
    std::vector<int> nodes(int e, const int* vertex, int dim) const;

private:
    const Mesh& mesh_;
    std::array<std::vector<MultiIndex>, 4> order_;  // by dimension
    std::vector<LagrangeBasis> of_cell_;            // by group of elements

    int local(int e, int node) const;  // its number among the vertices of e, or beyond them
};

// Gives kept cells of degree 1 the degree of their mesh, whose elements have it already.
void raise_kept_cells(Mesh& mesh);

// Those of linear_part(mesh): index[node] is the node there, -1: none. Points on nodes that are not there are left out.
void restrict_kept_cells(const Mesh& mesh, const std::vector<int>& index, Mesh& linear);

}  // namespace almesh
