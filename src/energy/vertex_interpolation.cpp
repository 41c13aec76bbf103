#include "energy/vertex_interpolation.hpp"

#include <vector>

#include "mesh/lagrange.hpp"

namespace almesh {

Interpolation vertex_interpolation(const Mesh& mesh) {
    Interpolation P;
    if (mesh.degree == 1) return P;
    struct Place {
        int element, node;
    };
    std::vector<Place> place(mesh.nodes());
    std::vector<int> column(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int a = 0; a < mesh.element_nodes(e); ++a) {
            place[mesh.element(e)[a]] = {e, a};
            if (a < mesh.cell(e).vertices) column[mesh.element(e)[a]] = 0;
        }
    for (int& c : column)
        if (c == 0) c = P.columns++;
    std::vector<std::vector<std::vector<double>>> weights;  // per group and node of its cell: of the vertices
    for (const LagrangeBasis& basis : bases_of(mesh.element_groups(), mesh.degree)) {
        weights.emplace_back();
        for (int a = 0; a < basis.count; ++a) weights.back().push_back(basis.vertex_weights(a));
    }
    for (const auto& [e, a] : place) {
        const std::vector<double>& weight = weights[mesh.group_number(e)][a];
        for (std::size_t v = 0; v < weight.size(); ++v) {
            if (weight[v] == 0) continue;
            P.col.push_back(column[mesh.element(e)[v]]);
            P.weight.push_back(weight[v] / mesh.degree);
        }
        P.row.push_back(static_cast<int>(P.col.size()));
    }
    return P;
}

}  // namespace almesh
