#include "mesh/winding.hpp"

#include <algorithm>
#include <array>

#include "mesh/kept_cells.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// The identity first. Of two vertices the first two, of three those that leave the last one, then those of four.
constexpr std::array<int, 4> windings[] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {0, 2, 1, 3}, {1, 2, 0, 3}, {2, 0, 1, 3},
                                           {2, 1, 0, 3}, {1, 2, 3, 0}, {2, 3, 0, 1}, {3, 0, 1, 2}, {0, 3, 2, 1},
                                           {1, 0, 3, 2}, {3, 2, 1, 0}};

bool is_identity(const std::vector<std::uint8_t>& winding) {
    return std::all_of(winding.begin(), winding.end(), [](std::uint8_t w) { return w == 0; });
}

}  // namespace

std::uint8_t winding(const int* here, const int* in_file, int count) {
    std::uint8_t w = 0;
    while (!std::equal(in_file, in_file + count, windings[w].begin(),
                       [here](int node, int k) { return node == here[k]; }))
        ++w;
    return w;
}

void reverse(Mesh& mesh, const std::vector<int>& elements) {
    for (const ElementGroup& group : mesh.element_groups()) {
        const LagrangeBasis basis(*group.cell, mesh.degree);
        MultiIndex swap = {0, 1, 2, 3, 4, 5};
        const int first = group.cell->factors[0];
        if (first > 1) std::swap(swap[first - 1], swap[first]);
        else swap = {2, 3, 0, 1, 4, 5};
        std::vector<int> from(basis.count), before(basis.count);
        for (int i = 0; i < basis.count; ++i) from[i] = basis.permuted_node(i, swap);
        for (int e : elements) {
            if (e < group.first || e >= group.first + group.count) continue;
            int* const node = mesh.elements.data() + (mesh.element(e) - mesh.elements.data());
            std::copy_n(node, basis.count, before.begin());
            for (int i = 0; i < basis.count; ++i) node[i] = before[from[i]];
        }
    }
}

void set_winding(Mesh& mesh, const std::vector<int>& turned) {
    if (!turned.empty()) mesh.file.element_winding.assign(mesh.element_count(), 0);
    for (const int e : turned) mesh.file.element_winding[e] = 1;
    if (is_identity(mesh.file.face_winding)) mesh.file.face_winding.clear();
}

Mesh as_in_file(Mesh mesh) {
    const Subcells subcells(mesh);
    for (std::size_t f = 0; f < mesh.file.face_winding.size(); ++f) {
        if (mesh.file.face_winding[f] == 0) continue;
        std::array<int, 4> vertex{};
        const CellType& cell = mesh.face_cell(static_cast<int>(f));
        const std::size_t start = mesh.face_start(static_cast<int>(f));
        for (int k = 0; k < cell.vertices; ++k) vertex[k] = mesh.faces[start + windings[mesh.file.face_winding[f]][k]];
        const std::vector<int> nodes = subcells.nodes(mesh.face_element[f], vertex.data(), cell);
        std::copy(nodes.begin(), nodes.end(), mesh.faces.begin() + static_cast<std::ptrdiff_t>(start));
    }
    std::vector<int> turned;
    for (std::size_t e = 0; e < mesh.file.element_winding.size(); ++e)
        if (mesh.file.element_winding[e] != 0) turned.push_back(static_cast<int>(e));
    reverse(mesh, turned);
    return mesh;
}

}  // namespace almesh
