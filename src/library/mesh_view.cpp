#include "library/mesh_view.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_set>

#include "base/index.hpp"
#include "library/mesh_arrays.hpp"

namespace almesh {

void CellList::add(const CellType& cell, const int* nodes, const std::vector<int>& place, int degree) {
    type.push_back(static_cast<int>(cell_of(cell)));
    for (int k = 0; k < cell.node_count(degree); ++k) node.push_back(place[nodes[k]]);
    offset.push_back(static_cast<int>(node.size()));
}

MeshView::MeshView(const Mesh& mesh, const RawMesh& raw, const Mesh& base, const std::vector<double>& first_x)
    : dim(mesh.dim), degree(mesh.degree), boundary_names(mesh.boundaries), volumes(volume_groups(mesh)) {
    const std::unordered_set<long long> old(base.file.node_id.begin(), base.file.node_id.end());
    std::vector<std::tuple<bool, long long, const double*, int>> nodes;  // new ones, id, position, number in the mesh
    for (const RawNode& each : raw.nodes)
        if (!old.contains(each.id)) nodes.emplace_back(false, each.id, each.x, -1);
    for (int i = 0; i < mesh.nodes(); ++i) {
        const long long id = mesh.file.node_id[i];
        nodes.emplace_back(!old.contains(id), id, point(first_x, i, dim), i);
    }
    std::sort(nodes.begin(), nodes.end());
    node.resize(mesh.nodes());
    for (const auto& [is_new, id, position, number] : nodes) {
        if (number >= 0) node[number] = static_cast<int>(node_id.size());
        node_id.push_back(id);
        first.insert(first.end(), position, position + dim);
    }
    x = first;

    std::vector<int> order(mesh.element_count());
    std::iota(order.begin(), order.end(), 0);
    const std::vector<long long>& ids = mesh.file.element_id;
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return ids[a] < ids[b]; });
    element.resize(order.size());
    for (const int e : order) {
        element[e] = static_cast<int>(element_id.size());
        element_id.push_back(ids[e]);
        elements.add(mesh.cell(e), mesh.element(e), node, degree);
    }
    boundaries.resize(mesh.boundaries.size());
    for (int f = 0; f < mesh.face_count(); ++f)
        boundaries[mesh.face_boundary[f]].add(mesh.face_cell(f), mesh.face(f), node, degree);
    for (GroupCells& volume : volumes) {
        for (int& e : volume.cells) e = element[e];
        std::sort(volume.cells.begin(), volume.cells.end());
    }
}

void MeshView::put(const std::vector<double>& values, int size, const std::vector<int>& place,
                   std::vector<double>& to) {
    for (std::size_t k = 0; k < place.size(); ++k) std::copy_n(&values[k * size], size, point(to, place[k], size));
}

std::vector<double> MeshView::to_mesh(const double* values) const {
    std::vector<double> result;
    for (const int i : node) result.insert(result.end(), values + offset(i, dim), values + offset(i, dim) + dim);
    return result;
}

}  // namespace almesh
