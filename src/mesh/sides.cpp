#include "mesh/sides.hpp"

namespace almesh {

SideNodes::SideNodes(int dim, int degree) {
    for (const CellType& cell : cell_types()) {
        if (cell.dim != dim) continue;
        if (static_cast<int>(nodes_.size()) <= cell.vertices) nodes_.resize(cell.vertices + 1);
        const LagrangeBasis basis(cell, degree);
        for (std::size_t k = 0; k < cell.faces.size(); ++k)
            nodes_[cell.vertices].push_back(basis.face_nodes(static_cast<int>(k)));
    }
}

int side_number(const Mesh& mesh, int e, std::span<const int> vertices) {
    const Side wanted(vertices, 0);
    for (int k = 0; k < static_cast<int>(mesh.cell(e).faces.size()); ++k) {
        const Side side = side_of_element(mesh, e, k, 0);
        if (side.vertex == wanted.vertex && side.opposite == wanted.opposite) return k;
    }
    return -1;
}

}  // namespace almesh
