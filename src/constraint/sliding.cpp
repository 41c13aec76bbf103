// Faces of a boundary that share a side are joined unless their normals there differ by more than an angle.
#include "constraint/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "constraint/height_patch.hpp"
#include "constraint/quadric.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

constexpr double surely_sharp = 60;  // degrees: no fair mesh resolves a round surface with faces at such angles

double angle(const Vec<3>& u, const Vec<3>& v) {
    return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

// The faces of some boundaries, moved.
struct BoundaryFaces {
    const Mesh& mesh;
    FacePatches patches;
    FacePatches of_surface;                     // bilinear faces are rounded like flat ones: as two triangles
    std::vector<int> face;                      // numbers in the mesh
    std::vector<std::vector<Vec<3>>> position;  // of their nodes
    std::vector<std::vector<Vec<3>>> corner_normal;
    std::vector<std::pair<int, int>> side;  // of faces, as places in `face`
    std::vector<double> side_angle;

    BoundaryFaces(const Mesh& mesh_, const std::vector<double>& node, const std::vector<char>& chosen)
        : mesh(mesh_), patches(mesh_), of_surface(mesh.degree == 1 ? FacePatches(mesh, 1) : patches) {
        const int dim = mesh.dim;
        const PatchNormal normal(dim - 1, patches.basis.bernstein.degree);
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (!chosen[mesh.face_boundary[f]]) continue;
            std::vector<Vec<3>> moved(mesh.face_nodes(f), Vec<3>{});
            for (int i = 0; i < mesh.face_nodes(f); ++i)
                std::copy_n(&node[(mesh.face_start(f) + i) * dim], dim, moved[i].begin());
            face.push_back(f);
            position.push_back(std::move(moved));
            const Vec<3> flat = flat_of(static_cast<int>(face.size()) - 1);
            std::vector<Vec<3>> at_corner(mesh.face_cell(f).vertices, Vec<3>{});
            const std::vector<Patch> of_face = patches.of(f, position.back());
            for (std::size_t part = 0; part < of_face.size(); ++part) {
                const std::vector<Vec<3>> n = normal.coefficients(of_face[part]);  // corners first
                for (int k = 0; k < dim; ++k) {
                    const Vec<3>& at = n[n.size() == 1 ? 0 : k];
                    at_corner[patches.cut(f).vertices[part][k]] =
                        dot(at, flat) > 0 ? at : flat;  // of a face that is folded there
                }
            }
            corner_normal.push_back(std::move(at_corner));
        }
        find_sides();
    }

    // The normal of the flat face with the same corners.
    Vec<3> flat_of(int k) const { return flat_normal(position[k], mesh.dim - 1, mesh.face_cell(face[k]).vertices); }

    // The patches of all faces, and of which each is one, as places in `face`.
    std::vector<Patch> all_patches(std::vector<int>& of_face) const {
        std::vector<Patch> all;
        for (std::size_t k = 0; k < face.size(); ++k)
            for (Patch& patch : patches.of(face[k], position[k])) {
                all.push_back(std::move(patch));
                of_face.push_back(static_cast<int>(k));
            }
        return all;
    }

    void find_sides() {
        std::vector<Side> sides;
        for (int k = 0; k < static_cast<int>(face.size()); ++k)
            append_sides_of_face(mesh, face[k], k, sides);
        for_equal_sides(sides, [&](std::span<const Side> equal) {
            const int f = equal[0].number;
            for (const Side& other : equal.subspan(1)) {
                const int g = other.number;
                double largest = 0;
                for (int i = 0; i < mesh.dim - 1; ++i)
                    largest = std::max(largest, angle(normal_at(f, other.vertex[i]), normal_at(g, other.vertex[i])));
                side.push_back({f, g});
                side_angle.push_back(largest);
            }
        });
    }

    Vec<3> normal_at(int k, int node) const {
        const std::span<const int> corner = mesh.face_vertices(face[k]);
        return corner_normal[k][std::find(corner.begin(), corner.end(), node) - corner.begin()];
    }

    // `faces` joined across sides at angles up to `limit`.
    std::vector<std::vector<int>> cut(const std::vector<int>& faces, double limit) const {
        DisjointSets sets(static_cast<int>(face.size()));
        std::vector<char> chosen(face.size(), 0);
        for (const int k : faces) chosen[k] = 1;
        for (std::size_t s = 0; s < side.size(); ++s) {
            const auto [f, g] = side[s];
            if (chosen[f] && chosen[g] && side_angle[s] <= limit) sets.join(f, g);
        }
        std::map<int, std::vector<int>> groups;
        for (const int k : faces) groups[sets.find(k)].push_back(k);
        std::vector<std::vector<int>> result;
        for (auto& [first, group] : groups) result.push_back(std::move(group));
        return result;
    }

    std::vector<Vec<3>> points(const std::vector<int>& faces) const {
        std::map<int, Vec<3>> of_node;
        for (const int k : faces)
            for (int i = 0; i < mesh.face_nodes(face[k]); ++i) of_node[mesh.face(face[k])[i]] = position[k][i];
        std::vector<Vec<3>> result;
        for (const auto& [node, x] : of_node) result.push_back(x);
        return result;
    }

    // Null where the faces are on none of the surfaces that it knows.
    std::unique_ptr<Surface> fitted(const std::vector<int>& faces) const {
        Vec<3> normal{};
        for (const int k : faces)
            for (const Vec<3>& n : corner_normal[k]) normal = normal + n;
        return fit_surface(mesh.dim, points(faces), normal);
    }

    // Whose normals are not across those of the faces, as those of the cylinder through the ends of a prism are.
    bool on_one_quadric(const std::vector<int>& faces) const {
        constexpr double tolerance = 1e-8, least_cosine = 0.1;
        const auto quadric = fit_quadric(mesh.dim, points(faces), tolerance);
        return quadric && std::all_of(faces.begin(), faces.end(), [&](int k) {
            Vec<3> n{};
            for (int c = 0; c < mesh.face_cell(face[k]).vertices; ++c)
                n = n + quadric->closest(position[k][c]).normal;
            const Vec<3> flat = flat_of(k);
            return std::abs(dot(n, flat)) > least_cosine * length(n) * length(flat);
        });
    }

    // By the elementary entity of the file: the faces of a CAD model.
    std::vector<std::vector<int>> cut_by_entity(const std::vector<int>& faces) const {
        std::map<int, std::vector<int>> groups;
        for (const int k : faces)
            groups[mesh.file.face_entity.empty() ? 0 : mesh.file.face_entity[face[k]]].push_back(k);
        std::vector<std::vector<int>> result;
        for (auto& [entity, group] : groups) result.push_back(std::move(group));
        return result;
    }

    std::unique_ptr<Surface> own(const std::vector<int>& faces) const {
        std::vector<int> numbers;
        std::vector<Patch> all;
        for (const int k : faces) {
            numbers.push_back(face[k]);
            for (Patch& patch : of_surface.of(face[k], position[k])) all.push_back(std::move(patch));
        }
        return surface_of_faces(of_surface.basis, all, of_surface.nodes_of(numbers));
    }
};

struct SurfaceOfFaces {
    std::unique_ptr<Surface> surface;
    std::vector<int> faces;
    bool of_mesh;  // the mesh's own faces
};

std::vector<SurfaceOfFaces> surfaces_of(const BoundaryFaces& faces, double feature_angle) {
    std::vector<SurfaceOfFaces> result;
    const auto add = [&result](std::unique_ptr<Surface> surface, const std::vector<int>& of, bool of_mesh = false) {
        if (!surface) return false;
        result.push_back({std::move(surface), of, of_mesh});
        return true;
    };
    std::vector<int> all(faces.face.size());
    std::iota(all.begin(), all.end(), 0);
    for (const std::vector<int>& connected : faces.cut(all, 180)) {
        if (faces.on_one_quadric(connected) && add(faces.fitted(connected), connected)) continue;
        for (const std::vector<int>& piece : faces.cut(connected, std::max(surely_sharp, feature_angle))) {
            if (add(faces.fitted(piece), piece)) continue;
            for (const std::vector<int>& smooth : faces.cut(piece, feature_angle)) {
                if (add(faces.fitted(smooth), smooth)) continue;
                std::vector<int> rest;
                const auto entities = faces.cut_by_entity(smooth);
                for (const std::vector<int>& entity : entities)
                    if (entities.size() == 1 || !add(faces.fitted(entity), entity))
                        rest.insert(rest.end(), entity.begin(), entity.end());
                if (!rest.empty()) add(faces.own(rest), rest, true);
            }
        }
    }
    return result;
}

// face x face node x dim, as the file has them.
std::vector<double> places_of_faces(const Mesh& mesh) {
    std::vector<double> positions;
    for (const int i : mesh.faces)
        positions.insert(positions.end(), point(mesh.x, i, mesh.dim), point(mesh.x, i, mesh.dim) + mesh.dim);
    return positions;
}

}  // namespace

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
                points_.emplace_back();
                if (is_of_mesh) points_.back().position = faces.points(of);
                for (const Vec<3>& x : points_.back().position)
                    points_.back().normal.push_back(surface->closest(x).normal);
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
        const Mesh& mesh = *other[b].mesh;
        const BoundaryFaces others(mesh, places_of_faces(mesh), other[b].boundaries);
        add_parts(others);
        Faces& faces = faces_[b];
        std::vector<Patch> before;
        for (std::size_t k = 0; k < own.face.size(); ++k) {
            const SubSimplices& cut = own.patches.cut(own.face[k]);
            for (int part = 0; part < cut.count(); ++part) {
                faces.after.push_back(cut.nodes_of(part, own.position[k]));
                faces.face.push_back(static_cast<int>(k));
            }
            for (Patch& patch : own.patches.of(own.face[k], base.x)) before.push_back(std::move(patch));
        }
        faces.before = std::make_unique<ClosestPoint>(own.patches.basis, before);
        const std::vector<Patch> of_other = others.all_patches(faces.other_face);
        faces.other = std::make_unique<ClosestPoint>(others.patches.basis, of_other);
        for (const Patch& patch : of_other) faces.other_normal.push_back(flat_normal(patch, dim_ - 1));
    }
}

SlidingSurfaces::SlidingSurfaces(const SlidingSurfaces& whole, const std::vector<int>& face, const Mesh& part,
                                 const Frame& frame)
    : dim_(whole.dim_), place_(part.face_count(), -1), frame_(frame), basis_(whole.basis_), points_(whole.points_),
      surface_(whole.surface_), boundary_(whole.boundary_), faces_(part.boundaries.size()) {
    for (std::size_t f = 0; f < face.size(); ++f)
        if (face[f] >= 0) place_[f] = whole.place_[face[f]];
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

void SlidingSurfaces::add_patch(int node, int part, const Vec<3>& x) {
    constexpr int most_points[] = {10, 30};
    constexpr double same_side = 0.3;  // cosine of the angle between normals
    const Points& all = points_[part];
    if (all.position.empty() || patch_.contains({node, part})) return;
    const SurfacePoint centre = surface_[part]->closest(x);
    std::vector<std::pair<double, int>> near;
    for (int i = 0; i < static_cast<int>(all.position.size()); ++i)
        if (dot(all.normal[i], centre.normal) > same_side)
            near.emplace_back(length(all.position[i] - centre.position), i);
    const auto count = std::min<std::size_t>(near.size(), most_points[dim_ - 2]);
    std::partial_sort(near.begin(), near.begin() + count, near.end());
    std::vector<Vec<3>> points;
    for (std::size_t k = 0; k < count; ++k) points.push_back(all.position[near[k].second]);
    auto patch = fit_height_patch(dim_, centre.position, centre.normal, points);
    if (!patch) return;
    patch_[{node, part}] = parts();
    boundary_.push_back(boundary_[part]);
    surface_.push_back(std::move(patch));
    points_.emplace_back();
}

int SlidingSurfaces::part_or_patch(int node, int part) const {
    const auto found = patch_.find({node, part});
    return found == patch_.end() ? part : found->second;
}

SurfacePoint SlidingSurfaces::closest(int part, const Vec<3>& x) const {
    SurfacePoint closest = surface_[part]->closest(frame_.to_file(x));
    closest.position = frame_.to_run(closest.position);
    for (auto& row : closest.curvature)
        for (double& entry : row) entry *= frame_.length;
    return closest;
}

}  // namespace almesh
