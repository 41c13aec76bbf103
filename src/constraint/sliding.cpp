#include "constraint/sliding.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "constraint/boundary_faces.hpp"
#include "mesh/part.hpp"
#include "mesh/restriction.hpp"

namespace almesh {

SlidingSurfaces::SlidingSurfaces(const Mesh& base, const std::vector<double>& node, const std::vector<char>& slides,
                                 double feature_angle, const Frame& frame, const std::vector<OtherSurface>& other)
    : dim_(base.dim), place_(base.face_count(), -1), frame_(frame),
      basis_(base.dim - 1, base.groups_of_faces.empty() ? base.degree : 2 * base.degree),
      faces_(base.boundaries.size()) {
    for (int b = 0; b < static_cast<int>(base.boundaries.size()); ++b) {
        if (!slides[b]) continue;
        const auto add_parts = [&](const BoundaryFaces& faces) {
            faces_[b].part.resize(faces.face.size());
            for (auto& [surface, of, is_of_mesh] : surfaces_of(faces, feature_angle)) {
                for (const int k : of) faces_[b].part[k] = parts();
                surface_.push_back(std::move(surface));
                boundary_.push_back(b);
            }
        };
        std::vector<char> only(base.boundaries.size(), 0);
        only[b] = 1;
        const BoundaryFaces own(base, node, only);
        for (std::size_t k = 0; k < own.face.size(); ++k) place_[own.face[k]] = static_cast<int>(k);
        if (other.empty() || !other[b].mesh) {
            add_parts(own);
            continue;
        }
        Faces& faces = faces_[b];
        const auto first = std::find(other.begin(), other.begin() + b, other[b]) - other.begin();
        if (first < b && slides[first]) {  // their common nodes are on one surface
            faces = faces_[first];
            faces.after.clear(), faces.face.clear();
        } else {
            const Mesh& mesh = *other[b].mesh;
            const BoundaryFaces others(mesh, at_nodes(mesh.faces, mesh.x, mesh.dim), other[b].boundaries);
            add_parts(others);
            const std::vector<Patch> of_other = others.all_patches(faces.other_face);
            faces.other = std::make_shared<ClosestPoint>(others.patches.basis, of_other);
            for (const Patch& patch : of_other) faces.other_normal.push_back(flat_normal(patch, dim_ - 1));
        }
        std::vector<Patch> before;
        for (std::size_t k = 0; k < own.face.size(); ++k) {
            const SubSimplices& cut = own.patches.cut(own.face[k]);
            for (int part = 0; part < cut.count(); ++part) {
                faces.after.push_back(cut.nodes_of(part, own.position[k]));
                faces.face.push_back(static_cast<int>(k));
            }
            for (Patch& patch : own.patches.of(own.face[k], base.x)) before.push_back(std::move(patch));
        }
        faces.before = std::make_shared<ClosestPoint>(own.patches.basis, before);
    }
}

SlidingSurfaces::SlidingSurfaces(const SlidingSurfaces& whole, const MeshPart& part, const Frame& frame)
    : dim_(whole.dim_), place_(part.face_count(), -1), frame_(frame), basis_(whole.basis_),
      surface_(whole.surface_), boundary_(whole.boundary_), faces_(part.boundaries.size()) {
    for (int f = 0; f < part.face_count(); ++f)
        if (part.face_of[f] >= 0) place_[f] = whole.place_[part.face_of[f]];
    for (std::size_t b = 0; b < whole.faces_.size(); ++b) faces_[b].part = whole.faces_[b].part;
}

int SlidingSurfaces::part(const Mesh& mesh, int f) const {
    const Faces& faces = faces_[mesh.face_boundary[f]];
    const int of_base = place_[f / (mesh.face_count() / static_cast<int>(place_.size()))];
    if (!faces.other) return faces.part[of_base];
    const Vec<3> centre = frame_.to_file(centroid(mesh, mesh.x, mesh.face(f), mesh.face_cell(f).vertices));
    const ClosestPoint::Place place =
        faces.before->find(centre, [&](int patch) { return faces.face[patch] == of_base; });
    const std::vector<Vec<3>>& node = faces.after[place.patch];
    std::vector<double> N(basis_.count);
    basis_.values(&place.at[1], N.data());
    Vec<3> after{};
    for (int i = 0; i < basis_.count; ++i) after = after + N[i] * node[i];
    const Vec<3> normal = flat_normal(node, dim_ - 1);
    const int nearest = faces.other->find(after, [&](int k) {  // whichever side the other mesh is on
        const double between = angle(normal, faces.other_normal[k]);
        return between < surely_sharp || between > 180 - surely_sharp;
    }).patch;
    return faces.part[faces.other_face[nearest >= 0 ? nearest : faces.other->find(after).patch]];
}

SurfacePoint SlidingSurfaces::closest(int part, const Vec<3>& x) const {
    SurfacePoint closest = surface_[part]->closest(frame_.to_file(x));
    closest.position = frame_.to_run(closest.position);
    for (auto& row : closest.curvature)
        for (double& entry : row) entry *= frame_.length;
    return closest;
}

}  // namespace almesh
