#include "mesh/sides.hpp"

#include "base/disjoint_sets.hpp"

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

// c + count stands for cell c turned.
std::vector<char> turned_by_neighbours(int count, std::vector<Side>& sides, int most,
                                       const std::function<double(int)>& value) {
    DisjointSets agree(2 * count);
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        for (const Side& side : equal) {
            const int c = equal[0].number / most, d = side.number / most;
            const int turn = side.even == equal[0].even && c != d ? count : 0;
            agree.join(c, d + turn);
            agree.join(c + count, d + count - turn);
        }
    });
    std::vector<double> sum(2 * count, 0.0);
    for (int c = 0; c < count; ++c) {
        const double v = value(c);
        sum[agree.find(c)] += v;
        sum[agree.find(c + count)] -= v;
    }
    std::vector<char> turned(count);
    for (int c = 0; c < count; ++c) turned[c] = sum[agree.find(c)] < 0;
    return turned;
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
