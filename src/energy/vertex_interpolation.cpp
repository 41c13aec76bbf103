// Node a of the lattice of degree p has the barycentric coordinates a / p.
#include "energy/vertex_interpolation.hpp"

#include <vector>

namespace almesh {

Interpolation vertex_interpolation(const Mesh& mesh) {
    Interpolation P;
    if (mesh.degree == 1) return P;
    const int m = mesh.element_nodes(), vertices = mesh.dim + 1;
    std::vector<int> place(mesh.nodes());  // element m + node of it
    std::vector<int> column(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int a = 0; a < m; ++a) {
            place[mesh.element(e)[a]] = e * m + a;
            if (a < vertices) column[mesh.element(e)[a]] = 0;
        }
    for (int& c : column)
        if (c == 0) c = P.columns++;
    const std::vector<MultiIndex> lattice = gmsh_node_order(mesh.dim, mesh.degree);
    for (int i = 0; i < mesh.nodes(); ++i) {
        const MultiIndex& a = lattice[place[i] % m];
        for (int v = 0; v < vertices; ++v) {
            if (a[v] == 0) continue;
            P.col.push_back(column[mesh.element(place[i] / m)[v]]);
            P.weight.push_back(static_cast<double>(a[v]) / mesh.degree);
        }
        P.row.push_back(static_cast<int>(P.col.size()));
    }
    return P;
}

}  // namespace almesh
