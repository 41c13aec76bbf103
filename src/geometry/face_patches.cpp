#include "geometry/face_patches.hpp"

#include <map>
#include <utility>

#include "base/index.hpp"
#include "mesh/node_key.hpp"

namespace almesh {

std::vector<Vec<3>> nodes_of_part(const SubSimplices& cut, const std::vector<Vec<3>>& nodes, int k) {
    if (cut.is_cell()) return nodes;
    std::vector<Vec<3>> of_part(cut.nodes);
    cut.place<3, double>(k, [&](int j) { return nodes[j]; }, of_part.data());
    for (Vec<3>& at : of_part) at = nodes[0] + at;
    for (int v = 0; v < cut.corners; ++v) of_part[v] = nodes[cut.vertices[k][v]];  // to the last bit
    return of_part;
}

Patch patch_of_part(const SubSimplices& cut, const PatchBasis& basis, const std::vector<Vec<3>>& nodes, int k) {
    return make_patch(basis, nodes_of_part(cut, nodes, k));
}

FacePatches::FacePatches(const Mesh& of, int degree) : mesh(of), basis(of.dim - 1, degree), first(1, 0) {
    for (const ElementGroup& group : mesh.face_groups()) {
        cuts.emplace_back(*group.cell, mesh.degree, degree);
        for (int f = group.first; f < group.first + group.count; ++f) {
            first.push_back(first.back() + cuts.back().count());
            face.insert(face.end(), cuts.back().count(), f);
        }
    }
}

std::vector<Patch> FacePatches::of(int f, const std::vector<Vec<3>>& nodes) const {
    std::vector<Patch> patches;
    for (int k = 0; k < cut(f).count(); ++k) patches.push_back(patch_of_part(cut(f), basis, nodes, k));
    return patches;
}

std::vector<Patch> FacePatches::of(int f, const std::vector<double>& x) const {
    return of(f, positions(mesh, x, mesh.face(f), mesh.face_nodes(f)));
}

std::vector<std::vector<int>> FacePatches::nodes_of(const std::vector<int>& faces) const {
    std::vector<std::vector<int>> all;
    std::map<NodeKey, int> known;
    int next = mesh.nodes();
    for (const int f : faces)
        for (int k = 0; k < cut(f).count(); ++k) {
            std::vector<int>& nodes = all.emplace_back();
            if (cut(f).is_cell()) {
                nodes.assign(mesh.face(f), mesh.face(f) + mesh.face_nodes(f));
                continue;
            }
            int corner[3] = {};
            for (int v = 0; v < mesh.dim; ++v) corner[v] = mesh.face(f)[cut(f).vertices[k][v]];
            for (int v = 0; v < mesh.dim; ++v) nodes.push_back(corner[v]);
            for (int i = mesh.dim; i < cut(f).nodes; ++i) {
                const auto [at, is_new] = known.try_emplace(key_of(basis.bernstein.index[i], corner, mesh.dim - 1), next);
                next += is_new;
                nodes.push_back(at->second);
            }
        }
    return all;
}

}  // namespace almesh
