// Where surfaces meet: onto the plane of the first, then along it onto that of the second (Gram-Schmidt).
#include "constraint/sliding_nodes.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/index.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"

namespace almesh {
namespace {

constexpr int most_steps = 20;  // of Newton's method to a point of surfaces,
constexpr double rounding = 1e-16;  // which ends with a step below this times |x|
constexpr double tangent = 0.17;  // sine of the angle below which two surfaces count as tangent: common nodes stay
constexpr double in_wedge = 0.02;  // the same for planes whose normals point apart: thin bodies have such edges

double least_sine(const SurfacePoint& before, const SurfacePoint& at) {
    const auto is_zero = [](const Vec<3>& row) { return dot(row, row) == 0; };
    const auto is_flat = [&](const Mat<3>& S) { return std::all_of(S.begin(), S.end(), is_zero); };
    return is_flat(before.curvature) && is_flat(at.curvature) && dot(before.normal, at.normal) < 0 ? in_wedge : tangent;
}

// The part of n perpendicular to the unit vectors of `basis`.
Vec<3> perpendicular(Vec<3> n, const std::vector<Vec<3>>& basis) {
    for (const Vec<3>& u : basis) n = n - dot(n, u) * u;
    return n;
}

// Whether the surfaces fix a node at x, or are tangent there, so that they do not define their common curve.
bool stays(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x, int dim) {
    std::vector<Vec<3>> normals;  // orthonormal
    SurfacePoint before;
    for (const int part : parts) {
        const SurfacePoint projection = sliding.closest(part, x);
        const Vec<3> n = perpendicular(projection.normal, normals);
        const double least = normals.size() == 1 ? least_sine(before, projection) : tangent;
        before = projection;
        if (length(n) < least || static_cast<int>(normals.size()) + 1 == dim) return true;
        normals.push_back(1 / length(n) * n);
    }
    return false;
}

// size: of the longest face at the node.
void check_prescribed_on_surface(const Mesh& mesh, const SlidingSurfaces& sliding, int part, int node, const Vec<3>& x,
                                 double size) {
    constexpr double tolerance = 0.25;  // of a face: the rim of a refined body is as angular as the file's
    const double distance = length(sliding.closest(part, x).position - x);
    if (distance <= tolerance * size) return;
    const std::string& name = mesh.boundaries[sliding.boundary(part)];
    throw InputError("node ", mesh.file.node_id[node], " lies on the boundary ", name,
                     ", which slides, and on another one, whose motion takes it off that surface (",
                     sliding.surface(part).name(), ") by ", distance * sliding.frame().length,
                     ": let that motion stay on the surface, or prescribe one for ", name, " too");
}

}  // namespace

std::vector<int> held_directions(Constraint& constraint, const std::vector<double>& x, int dim) {
    constexpr double off_target = 1e-10;
    if (!(constraint.max_error(x) <= off_target)) return {};
    std::vector<int> held(x.size() / dim, 0);
    const std::vector<int>& nodes = constraint.nodes();
    for (int t = 0; t < static_cast<int>(nodes.size()); ++t) {
        const Mat<3> D = constraint.distance(t, at_node(x, nodes[t], dim)).slope;  // nearly a projector
        held[nodes[t]] = std::min(dim, static_cast<int>(std::lround(D[0][0] + D[1][1] + D[2][2])));
    }
    return held;
}

Vec<3> at_distances(const SlidingSurfaces& sliding, const std::vector<int>& parts, Vec<3> x,
                    const std::array<double, 3>& distances) {
    for (int step = 0; step < most_steps; ++step) {
        std::vector<Vec<3>> normals;
        Vec<3> move{};
        SurfacePoint before;
        for (std::size_t k = 0; k < parts.size(); ++k) {  // onto the first plane, then along it onto the second
            const SurfacePoint at = sliding.closest(parts[k], x);
            const Vec<3> n = perpendicular(at.normal, normals);
            const double distance = dot(at.position - x - move, at.normal) + distances[k], slope = dot(n, at.normal);
            const double least = k == 1 ? least_sine(before, at) : tangent;
            before = at;
            if (slope > least * least) {
                move = move + distance / slope * n;
                normals.push_back(1 / std::sqrt(dot(n, n)) * n);
            }
        }
        x = x + move;
        if (dot(move, move) <= rounding * rounding * dot(x, x)) break;
    }
    return x;
}

Vec<3> on_surfaces(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x) {
    return parts.size() == 1 ? sliding.closest(parts[0], x).position : at_distances(sliding, parts, x, {});
}

std::array<double, 3> distances(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x,
                                const Vec<3>& d) {
    std::array<double, 3> result{};
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const SurfacePoint projection = sliding.closest(parts[k], x);
        result[k] = dot(x - projection.position + times(projection.slope, d), projection.normal);
    }
    return result;
}

SurfaceDistance distance_to(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x) {
    SurfaceDistance sum;
    for (const int part : parts) {
        const SurfacePoint projection = sliding.closest(part, x);
        sum.r = sum.r + (x - projection.position);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) sum.slope[i][j] += projection.slope[i][j];
    }
    return sum;
}

Mat<3> second_derivative(const SlidingSurfaces& sliding, const std::vector<int>& parts, const Vec<3>& x,
                         const Vec<3>& force) {
    Mat<3> sum{};
    for (const int part : parts) {
        const SurfacePoint projection = sliding.closest(part, x);
        const Mat<3>& S = projection.curvature;
        const Vec<3> turned = times(S, force), &n = projection.normal;
        const double along = dot(n, force);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) sum[i][j] += along * S[i][j] + n[i] * turned[j] + turned[i] * n[j];
    }
    return sum;
}

std::vector<std::vector<int>> sliding_parts(const Mesh& mesh, const BoundaryTarget& target,
                                            const SlidingSurfaces* sliding, const std::vector<int>& nodes,
                                            const std::vector<int>& faces, std::vector<double>& g,
                                            std::vector<char>& fixed) {
    const int dim = mesh.dim;
    std::vector<std::vector<int>> parts(nodes.size());
    std::vector<char> prescribed(nodes.size(), 0);
    std::vector<double> size(nodes.size(), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const double longest = face_size(mesh, mesh.x, f);
        const int part = target.slides(mesh, f) ? sliding->part(mesh, f) : -1;
        const std::size_t start = mesh.face_start(f);
        for (std::size_t k = start; k < start + mesh.face_nodes(f); ++k) {
            const int t = faces[k];
            size[t] = std::max(size[t], longest);
            if (is_prescribed(target.kind[k])) prescribed[t] = 1;
            if (target.kind[k] != NodeKind::slides) continue;
            if (std::find(parts[t].begin(), parts[t].end(), part) == parts[t].end()) parts[t].push_back(part);
        }
    }
    fixed.assign(nodes.size(), 0);
    for (std::size_t t = 0; t < nodes.size(); ++t) {
        Vec<3> x = at_node(g, static_cast<int>(t), dim);
        const bool of_other = std::any_of(parts[t].begin(), parts[t].end(),
                                          [&](int part) { return sliding->is_of_other_mesh(part); });
        if (of_other && !prescribed[t]) {
            x = on_surfaces(*sliding, parts[t], x);
            set_node(g, static_cast<int>(t), dim, x);
        }
        for (const int part : parts[t])
            if (prescribed[t]) check_prescribed_on_surface(mesh, *sliding, part, nodes[t], x, size[t]);
        if (!prescribed[t] && (parts[t].empty() || !stays(*sliding, parts[t], x, dim))) continue;
        parts[t].clear();
        fixed[t] = 1;
    }
    return parts;
}

}  // namespace almesh
