// Elements of one type as Bezier patches: one for a simplex, several for other cells (SubSimplices).
#pragma once
#include <utility>
#include <vector>

#include "geometry/patch.hpp"
#include "mesh/sub_simplices.hpp"

namespace almesh {

struct ElementPatches {
    const Mesh& mesh;
    SubSimplices cut;
    PatchBasis basis;

    ElementPatches(const Mesh& of, const ElementGroup& group)
        : mesh(of), cut(*group.cell, of.degree), basis(of.dim, cut.degree) {}

    int count() const { return cut.count(); }

    // x: node_count x dim positions. part: number of the patch.
    Patch of(const std::vector<double>& x, int e, int part) const {
        std::vector<Vec<3>> nodes = positions(mesh, x, mesh.element(e), cut.cell_nodes);
        if (count() == 1) return make_patch(basis, std::move(nodes));
        std::vector<Vec<3>> of_part(cut.nodes);
        cut.place<3, double>(part, [&](int j) { return nodes[j]; }, of_part.data());
        for (Vec<3>& at : of_part) at = nodes[0] + at;
        for (int v = 0; v <= mesh.dim; ++v) of_part[v] = nodes[cut.vertices[part][v]];  // to the last bit
        return make_patch(basis, std::move(of_part));
    }
};

}  // namespace almesh
