#include "mesh/sides.hpp"

namespace almesh {

SideNodes::SideNodes(int dim, int degree) {
    for (const CellType& cell : cell_types()) {
        if (cell.dim != dim) continue;
        if (static_cast<int>(nodes_.size()) <= cell.vertices) nodes_.resize(cell.vertices + 1);
        nodes_[cell.vertices] = LagrangeBasis(cell, degree).face_nodes();
    }
}

int side_number(const Mesh& mesh, int e, const int* vertex) {
    const int* const node = mesh.element(e);
    const CellType& cell = mesh.cell(e);
    const auto has = [&](int v) { return std::find(vertex, vertex + mesh.dim, node[v]) != vertex + mesh.dim; };
    for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k)
        if (std::all_of(cell.faces[k].begin(), cell.faces[k].begin() + mesh.dim, has)) return k;
    return -1;
}

}  // namespace almesh
