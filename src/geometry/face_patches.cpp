#include "geometry/face_patches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "base/disjoint_sets.hpp"
#include "mesh/node_key.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// Pairs (index in f, index in g) of the corners that two patches share.
std::vector<std::array<int, 2>> shared_corners(const FacePatches& faces, int f, int g, const std::vector<int>& place) {
    const auto at = [&](int node) { return place.empty() ? node : place[node]; };
    std::vector<std::array<int, 2>> shared;
    for (int i = 0; i < faces.mesh.dim; ++i)
        for (int j = 0; j < faces.mesh.dim; ++j)
            if (at(faces.corner(f, i)) == at(faces.corner(g, j))) shared.push_back({i, j});
    return shared;
}

// Direction in which the face leaves what it shares with its neighbour: its corner i (2D), or the middle of its side
// from corner i to corner j (3D), then perpendicular to the side.
Vec<3> leaving(const Bernstein& basis, const Patch& patch, int i, int j) {
    if (basis.dim == 1) return edge_tangent(basis, patch, i, 1 - i);
    const int a = std::min(i, j), b = std::max(i, j);
    const Patch half = bisect(basis, patch, a, b).first;  // the middle is its corner b
    const Vec<3> side = edge_tangent(basis, half, b, a), inward = edge_tangent(basis, half, b, 3 - a - b);
    return inward - (dot(inward, side) / dot(side, side)) * side;
}

}  // namespace

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

Fold fold_of(const FacePatches& faces, const std::vector<Patch>& patches, int f, int g, const std::vector<int>& place) {
    const Bernstein& basis = faces.basis.bernstein;
    const std::vector<std::array<int, 2>> shared = shared_corners(faces, f, g, place);
    Fold fold;
    for (int k = 0; k + basis.dim <= static_cast<int>(shared.size()); ++k) {
        const auto &i = shared[k], &j = shared[k + basis.dim - 1];
        const Vec<3> u = leaving(basis, patches[f], i[0], j[0]), v = leaving(basis, patches[g], i[1], j[1]);
        const double angle = std::atan2(length(cross(u, v)), dot(u, v));
        const Vec<3> normal = flat_normal(patches[f], basis.dim);
        if (angle < fold.angle) fold = {angle, dot(v, normal) > 1e-6 * length(v) * length(normal)};
    }
    return fold;
}

// The flat faces with the same corners
// tell it of points outside the box of every face, as no such point is between these and the curved ones; of others,
// flat pieces of the faces.
std::vector<double> windings(const Bernstein& basis, const std::vector<Patch>& patches,
                             const std::vector<Vec<3>>& points) {
    const int m = basis.dim, depth = basis.degree == 1 ? 0 : 3 * m;
    const int count = static_cast<int>(points.size());
    std::vector<int> near, far;  // the points, by number
    Box whole = box_of(patches.front());
    std::vector<char> is_near(count, 0);
    for (const Patch& patch : patches) {
        const Box box = box_of(patch);
        whole.include(box);
        for (int i = 0; i < count; ++i) is_near[i] |= squared_distance(box, points[i]) == 0;
    }
    for (int i = 0; i < count; ++i)
        if (squared_distance(whole, points[i]) == 0) (is_near[i] ? near : far).push_back(i);
    std::vector<double> sum(count, 0.0);
    const auto add = [&](const Patch& patch, const std::vector<int>& seen) {
        for (const int i : seen) {
            const Vec<3> u = patch[0] - points[i], v = patch[1] - points[i];
            sum[i] += m == 1 ? std::atan2(cross(u, v)[2], dot(u, v)) : 0.5 * solid_angle(u, v, patch[2] - points[i]);
        }
    };
    for (const Patch& patch : patches) {
        add(patch, far);
        if (!near.empty()) for_pieces(basis, patch, depth, [&](const Patch& piece) { add(piece, near); });
    }
    for (double& turns : sum) turns /= 2 * std::numbers::pi;
    return sum;
}

Vec<3> unit_normal(const Mesh& mesh, const std::vector<double>& x, int f) {
    const int vertices = mesh.face_cell(f).vertices;
    return unit(flat_normal(positions(mesh, x, mesh.face(f), vertices), mesh.dim - 1, vertices));
}

std::vector<int> smooth_parts(const Mesh& mesh, double feature_angle) {
    std::vector<Vec<3>> normal(mesh.face_count());
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count(); ++f) {
        normal[f] = unit_normal(mesh, f);
        if (!mesh.is_inner(f)) append_sides_of_face(mesh, f, f, sides);
    }
    DisjointSets connected(mesh.face_count());
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        for (const Side& other : equal.subspan(1)) {
            const Vec<3>&a = normal[equal[0].number], &b = normal[other.number];
            const double angle = std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
            if (angle <= feature_angle) connected.join(equal[0].number, other.number);
        }
    });
    std::map<int, int> number;
    std::vector<int> part(mesh.face_count(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (!mesh.is_inner(f))
            part[f] = number.try_emplace(connected.find(f), static_cast<int>(number.size()) + 1).first->second;
    return part;
}

}  // namespace almesh
