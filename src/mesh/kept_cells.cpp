#include "mesh/kept_cells.hpp"

#include <algorithm>

#include "mesh/sides.hpp"

namespace almesh {

Subcells::Subcells(const Mesh& mesh) : mesh_(mesh), of_cell_(bases_of(mesh.element_groups(), mesh.degree)) {
    for (const CellType& cell : cell_types()) order_.push_back(gmsh_node_order(cell, mesh.degree));
}

int Subcells::local(int e, int node) const {
    const int* const nodes = mesh_.element(e);
    return static_cast<int>(std::find(nodes, nodes + mesh_.cell(e).vertices, node) - nodes);
}

bool Subcells::has(int e, const int* vertex, const CellType& cell) const {
    const int* const end = vertex + cell.vertices;
    const bool has_vertices = std::all_of(vertex, end, [&](const int& node) {
        return local(e, node) < mesh_.cell(e).vertices && std::find(&node + 1, end, node) == end;
    });
    if (!has_vertices || (mesh_.cell(e).is_simplex() && cell.is_simplex())) return has_vertices;
    if (cell.dim == mesh_.dim - 1) return side_number(mesh_, e, {vertex, end}) >= 0;
    const std::span<const CellEdge> edges = mesh_.cell(e).edges;
    return cell.dim == 1 && std::any_of(edges.begin(), edges.end(), [&](const CellEdge& edge) {
        return std::minmax(local(e, vertex[0]), local(e, vertex[1])) == std::minmax(edge[0], edge[1]);
    });
}

std::vector<int> Subcells::nodes(int e, const int* vertex, const CellType& cell) const {
    std::array<int, 4> vertices{};
    for (int k = 0; k < cell.vertices; ++k) vertices[k] = local(e, vertex[k]);
    std::vector<int> nodes =
        of_cell_[mesh_.group_number(e)].nodes_of(cell, order_[&cell - cell_types().data()], vertices.data());
    for (int& node : nodes) node = mesh_.element(e)[node];
    return nodes;
}

std::vector<KeptFace> kept_faces(const Mesh& mesh) {
    std::vector<KeptFace> faces;
    for (const KeptCells& kept : mesh.kept) {
        const CellType& cell = mesh.cell_of(kept);
        for (int c = 0; c < kept.count() && cell.dim == mesh.dim - 1; ++c)
            faces.push_back({&cell, &kept.nodes[offset(c, cell.node_count(mesh.degree))], c, kept.element[c],
                             kept.physical[c], kept.entity[c], kept.id[c]});
    }
    return faces;
}

void append_tags(const KeptCells& from, int c, KeptCells& to) {
    to.element.push_back(from.element[c]);
    to.id.push_back(from.id[c]);
    to.physical.push_back(from.physical[c]);
    to.entity.push_back(from.entity[c]);
}

void raise_kept_cells(Mesh& mesh) {
    const Subcells subcells(mesh);
    for (KeptCells& kept : mesh.kept) {
        const CellType& cell = mesh.cell_of(kept);
        if (cell.dim == 0) continue;
        const std::vector<int> vertices = std::move(kept.nodes);
        kept.nodes.clear();
        for (int c = 0; c < kept.count(); ++c) {
            const std::vector<int> nodes = subcells.nodes(kept.element[c], &vertices[offset(c, cell.vertices)], cell);
            kept.nodes.insert(kept.nodes.end(), nodes.begin(), nodes.end());
        }
    }
}

void restrict_kept_cells(const Mesh& mesh, const std::vector<int>& index, Mesh& linear) {
    for (std::size_t kind = 0; kind < mesh.kept.size(); ++kind) {
        const KeptCells& from = mesh.kept[kind];
        const CellType& cell = mesh.cell_of(from);
        const int width = cell.node_count(mesh.degree);
        KeptCells& to = linear.kept[kind] = {};
        for (int c = 0; c < from.count(); ++c) {
            const int* const node = &from.nodes[offset(c, width)];
            if (index[*node] < 0) continue;
            for (int v = 0; v < cell.vertices; ++v) to.nodes.push_back(index[node[v]]);
            append_tags(from, c, to);
        }
    }
}

std::vector<char> nodes_of_features(const Mesh& mesh) {
    std::vector<char> nodes(mesh.nodes(), 0);
    for (const KeptCells& some : mesh.kept) {
        const CellType& cell = mesh.cell_of(some);
        const int width = cell.node_count(mesh.degree);
        for (int c = 0; c < some.count() && cell.dim < mesh.dim - 1; ++c)
            for (int i = 0; i < width && some.physical[c] > 0; ++i) nodes[some.nodes[offset(c, width, i)]] = 1;
    }
    return nodes;
}

}  // namespace almesh
