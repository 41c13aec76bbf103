#include "mesh/kept_cells.hpp"

#include <algorithm>

#include "mesh/sides.hpp"

namespace almesh {

Subcells::Subcells(const Mesh& mesh) : mesh_(mesh), of_cell_(bases_of(mesh)) {
    for (int dim = 1; dim <= mesh.dim; ++dim) order_[dim] = gmsh_node_order(dim, mesh.degree);
}

int Subcells::local(int e, int node) const {
    const int* const nodes = mesh_.element(e);
    return static_cast<int>(std::find(nodes, nodes + mesh_.cell(e).vertices, node) - nodes);
}

bool Subcells::has(int e, const int* vertex, int dim) const {
    const int* const end = vertex + dim + 1;
    const bool has_vertices = std::all_of(vertex, end, [&](const int& node) {
        return local(e, node) < mesh_.cell(e).vertices && std::find(&node + 1, end, node) == end;
    });
    return has_vertices && (mesh_.cell(e).is_simplex() || (dim == mesh_.dim - 1 && side_number(mesh_, e, vertex) >= 0));
}

std::vector<int> Subcells::nodes(int e, const int* vertex, int dim) const {
    const LagrangeBasis& of_element = of_cell_[mesh_.group_number(e)];
    std::vector<int> nodes;
    for (const MultiIndex& b : order_[dim]) {
        MultiIndex a{};  // the mean of the vertices with the weights b
        for (int k = 0; k <= dim; ++k)
            for (std::size_t i = 0; i < a.size(); ++i)
                a[i] += b[k] * of_element.nodes[local(e, vertex[k])][i] / mesh_.degree;
        nodes.push_back(mesh_.element(e)[of_element.find(a)]);
    }
    return nodes;
}

void raise_kept_cells(Mesh& mesh) {
    const Subcells subcells(mesh);
    for (int dim = 1; dim <= mesh.dim; ++dim) {
        KeptCells& kept = mesh.kept[dim];
        const std::vector<int> vertices = std::move(kept.nodes);
        kept.nodes.clear();
        for (int c = 0; c < kept.count(); ++c) {
            const std::vector<int> nodes = subcells.nodes(kept.element[c], &vertices[offset(c, dim + 1)], dim);
            kept.nodes.insert(kept.nodes.end(), nodes.begin(), nodes.end());
        }
    }
}

void restrict_kept_cells(const Mesh& mesh, const std::vector<int>& index, Mesh& linear) {
    for (int dim = 0; dim <= mesh.dim; ++dim) {
        const KeptCells& from = mesh.kept[dim];
        const int width = simplex_node_count(dim, dim == 0 ? 1 : mesh.degree);
        KeptCells& to = linear.kept[dim] = {};
        for (int c = 0; c < from.count(); ++c) {
            const int* const node = &from.nodes[offset(c, width)];
            if (dim == 0 && *node >= 0 && index[*node] < 0) continue;
            for (int v = 0; v <= dim; ++v) to.nodes.push_back(node[v] < 0 ? node[v] : index[node[v]]);
            to.element.push_back(from.element[c]);
            to.id.push_back(from.id[c]);
            to.physical.push_back(from.physical[c]);
            to.entity.push_back(from.entity[c]);
        }
    }
}

}  // namespace almesh
