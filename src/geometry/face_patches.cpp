#include "geometry/face_patches.hpp"

#include <map>

#include "mesh/node_key.hpp"

namespace almesh {

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
    for (int k = 0; k < cut(f).count(); ++k) patches.push_back(make_patch(basis, cut(f).nodes_of(k, nodes)));
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
                const NodeKey key = key_of(basis.bernstein.index[i], corner, mesh.dim - 1);
                const auto [at, is_new] = known.try_emplace(key, next);
                next += is_new;
                nodes.push_back(at->second);
            }
        }
    return all;
}

}  // namespace almesh
