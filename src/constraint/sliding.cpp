// Faces of a boundary that share a side are joined unless their normals there differ by more than an angle
// (union-find).
#include "constraint/sliding.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "base/index.hpp"

namespace almesh {
namespace {

constexpr double surely_sharp = 60;  // degrees: no fair mesh resolves a round surface with faces at such angles

double angle(const Vec<3>& u, const Vec<3>& v) {
    return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

// The faces of one boundary, moved.
struct BoundaryFaces {
    const Mesh& mesh;
    std::vector<int> face;                      // numbers in the mesh
    std::vector<std::vector<Vec<3>>> position;  // of their nodes
    std::vector<Patch> patch;
    std::vector<std::vector<Vec<3>>> corner_normal;
    std::vector<std::pair<int, int>> side;  // of faces, as places in `face`
    std::vector<double> side_angle;

    BoundaryFaces(const Mesh& mesh_, const PatchBasis& basis, const std::vector<double>& node, int boundary)
        : mesh(mesh_) {
        const int m = mesh.face_nodes(), dim = mesh.dim;
        const PatchNormal normal(dim - 1, mesh.degree);
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (mesh.face_boundary[f] != boundary) continue;
            std::vector<Vec<3>> moved(m, Vec<3>{});
            for (int i = 0; i < m; ++i) std::copy_n(&node[offset(offset(f, m, i), dim)], dim, moved[i].begin());
            face.push_back(f);
            patch.push_back(make_patch(basis, moved));
            position.push_back(std::move(moved));
            const std::vector<Vec<3>> n = normal.coefficients(patch.back());  // corners first
            std::vector<Vec<3>> at_corner;
            for (int k = 0; k < dim; ++k) at_corner.push_back(n[n.size() == 1 ? 0 : k]);
            corner_normal.push_back(std::move(at_corner));
        }
        find_sides();
    }

    void find_sides() {
        std::map<std::vector<int>, std::vector<std::pair<int, int>>> at_side;  // nodes -> face, corner opposite
        for (std::size_t k = 0; k < face.size(); ++k)
            for (int opposite = 0; opposite < mesh.dim; ++opposite) {
                std::vector<int> nodes;
                for (int c = 0; c < mesh.dim; ++c)
                    if (c != opposite) nodes.push_back(mesh.face(face[k])[c]);
                std::sort(nodes.begin(), nodes.end());
                at_side[nodes].push_back({static_cast<int>(k), opposite});
            }
        for (const auto& [nodes, faces] : at_side)
            for (std::size_t k = 1; k < faces.size(); ++k) {
                const int f = faces[0].first, g = faces[k].first;
                double largest = 0;
                for (const int node : nodes) largest = std::max(largest, angle(normal_at(f, node), normal_at(g, node)));
                side.push_back({f, g});
                side_angle.push_back(largest);
            }
    }

    Vec<3> normal_at(int k, int node) const {
        const int* const corner = mesh.face(face[k]);
        return corner_normal[k][std::find(corner, corner + mesh.dim, node) - corner];
    }

    // `faces` joined across sides at angles up to `limit`.
    std::vector<std::vector<int>> cut(const std::vector<int>& faces, double limit) const {
        std::vector<int> parent(face.size());
        std::iota(parent.begin(), parent.end(), 0);
        std::vector<char> chosen(face.size(), 0);
        for (const int k : faces) chosen[k] = 1;
        const auto root = [&](int k) {
            while (parent[k] != k) k = parent[k] = parent[parent[k]];
            return k;
        };
        for (std::size_t s = 0; s < side.size(); ++s) {
            const auto [f, g] = side[s];
            if (!chosen[f] || !chosen[g] || side_angle[s] > limit) continue;
            const int a = root(f), b = root(g);
            parent[std::max(a, b)] = std::min(a, b);
        }
        std::map<int, std::vector<int>> groups;
        for (const int k : faces) groups[root(k)].push_back(k);
        std::vector<std::vector<int>> result;
        for (auto& [first, group] : groups) result.push_back(std::move(group));
        return result;
    }

    // Null where the faces are on none of the surfaces that it knows.
    std::unique_ptr<Surface> fitted(const std::vector<int>& faces) const {
        std::map<int, Vec<3>> of_node;
        Vec<3> normal{};
        for (const int k : faces) {
            for (int i = 0; i < mesh.face_nodes(); ++i) of_node[mesh.face(face[k])[i]] = position[k][i];
            for (const Vec<3>& n : corner_normal[k]) normal = normal + n;
        }
        std::vector<Vec<3>> points;
        for (const auto& [node, x] : of_node) points.push_back(x);
        return fit_surface(mesh.dim, points, normal);
    }

    std::unique_ptr<Surface> own(const PatchBasis& basis, const std::vector<int>& faces) const {
        std::vector<Patch> patches;
        std::vector<std::vector<int>> nodes;
        for (const int k : faces) {
            patches.push_back(patch[k]);
            nodes.emplace_back(mesh.face(face[k]), mesh.face(face[k]) + mesh.face_nodes());
        }
        return surface_of_faces(basis, patches, nodes);
    }
};

}  // namespace

SlidingSurfaces::SlidingSurfaces(const Mesh& base, const std::vector<double>& node, const std::vector<char>& slides,
                                 double feature_angle, double unit)
    : unit_(unit), of_boundary_(base.boundaries.size()), part_of_(base.boundaries.size()) {
    const PatchBasis basis(base.dim - 1, base.degree);
    for (int b = 0; b < static_cast<int>(base.boundaries.size()); ++b) {
        if (!slides[b]) continue;
        const BoundaryFaces faces(base, basis, node, b);
        part_of_[b].resize(faces.face.size());
        const auto add = [&](std::unique_ptr<Surface> surface, const std::vector<int>& of) {
            for (const int k : of) part_of_[b][k] = parts();
            surface_.push_back(std::move(surface));
            boundary_.push_back(b);
        };
        std::vector<int> all(faces.face.size());
        std::iota(all.begin(), all.end(), 0);
        for (const std::vector<int>& piece : faces.cut(all, std::max(surely_sharp, feature_angle))) {
            if (auto surface = faces.fitted(piece)) {
                add(std::move(surface), piece);
                continue;
            }
            for (const std::vector<int>& smooth : faces.cut(piece, feature_angle)) {
                auto surface = faces.fitted(smooth);
                if (!surface) surface = faces.own(basis, smooth);
                add(std::move(surface), smooth);
            }
        }
        std::vector<Patch> before;
        for (const int f : faces.face) before.push_back(face_patch(basis, base, base.x, f));
        of_boundary_[b] = std::make_unique<ClosestPoint>(basis, before);
    }
}

int SlidingSurfaces::part(int boundary, const Vec<3>& x) const {
    return part_of_[boundary][of_boundary_[boundary]->find(unit_ * x).patch];
}

SurfacePoint SlidingSurfaces::foot(int part, const Vec<3>& x) const {
    SurfacePoint place = surface_[part]->foot(unit_ * x);
    place.position = 1 / unit_ * place.position;
    for (auto& row : place.curvature)
        for (double& entry : row) entry *= unit_;
    return place;
}

}  // namespace almesh
