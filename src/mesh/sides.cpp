#include "mesh/sides.hpp"

namespace almesh {

SideNodes::SideNodes(int dim, int degree) {
    for (const CellType& cell : cell_types()) {
        if (cell.dim != dim) continue;
        if (static_cast<int>(nodes_.size()) <= cell.vertices) nodes_.resize(cell.vertices + 1);
        nodes_[cell.vertices] = LagrangeBasis(cell, degree).face_nodes();
    }
}

int side_number(const Mesh& mesh, int e, std::span<const int> vertices) {
    const CellType& cell = mesh.cell(e);
    const int* const node = mesh.element(e);
    for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k) {
        const int count = cell.face_type(k).vertices;
        if (count == static_cast<int>(vertices.size()) &&
            std::all_of(cell.faces[k].begin(), cell.faces[k].begin() + count, [&](int v) {
                return std::find(vertices.begin(), vertices.end(), node[v]) != vertices.end();
            }))
            return k;
    }
    return -1;
}

}  // namespace almesh
