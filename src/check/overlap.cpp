#include "check/overlap.hpp"

#include <algorithm>
#include <numeric>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

constexpr double depth = 1e-4;        // of a point beside a face, over the distance of the face from the centre
constexpr double element_work = 200;  // simple operations for an element, at least

// Mean of the vertices with these numbers in the reference cell, -1: none. In a pyramid of the places, not of their
// collapsed coordinates.
template <class Vertices>
std::array<double, 3> mean_vertex(const LagrangeBasis& basis, const Vertices& vertices) {
    std::array<double, 3> mean{};
    const double count = std::count_if(vertices.begin(), vertices.end(), [](int v) { return v >= 0; });
    for (const int v : vertices) {
        if (v < 0) continue;
        const std::array<double, 3> xi = basis.point(v);
        for (int a = 0; a < basis.dim; ++a)
            mean[a] += (basis.cell.is_collapsed && a < 2 ? 1 - xi[2] : 1) * xi[a] / count;
    }
    for (int a = 0; a < 2 && basis.cell.is_collapsed; ++a) mean[a] /= 1 - mean[2];
    return mean;
}

// Reference coordinates of the point behind side k.
std::array<double, 3> point_behind(const LagrangeBasis& basis, int k) {
    const int n = basis.dim;
    std::array<double, 3> xi{};
    if (basis.cell.is_simplex()) {  // opposite vertex k
        std::array<double, 4> lambda;
        lambda.fill((1 - depth / (n + 1)) / n);
        lambda[k] = depth / (n + 1);
        std::copy_n(&lambda[1], n, xi.begin());
        return xi;
    }
    std::vector<int> all(basis.cell.vertices);
    std::iota(all.begin(), all.end(), 0);
    const std::array<double, 3> of_face = mean_vertex(basis, basis.cell.faces[k]), of_cell = mean_vertex(basis, all);
    for (int a = 0; a < n; ++a) xi[a] = (1 - depth) * of_face[a] + depth * of_cell[a];
    return xi;
}

// A point for each boundary face: depth of the way from the centre of the face to that of the element.
std::vector<Vec<3>> points_behind_faces(const Mesh& mesh, const std::vector<double>& x) {
    const int n = mesh.dim;
    std::vector<Vec<3>> points(mesh.face_count(), Vec<3>{});
    const std::vector<LagrangeBasis> bases = bases_of(mesh);
    std::vector<std::vector<std::vector<double>>> values(bases.size());  // by group, behind side k
    for (std::size_t g = 0; g < bases.size(); ++g)
        for (int k = 0; k < static_cast<int>(bases[g].cell.faces.size()); ++k) {
            values[g].emplace_back(bases[g].count);
            bases[g].values(point_behind(bases[g], k).data(), values[g][k].data());
        }
    parallel_for(
        mesh.face_count(),
        [&](int f) {
            const int e = mesh.face_element[f], g = mesh.group_number(e);
            const int* const element = mesh.element(e);
            const std::vector<double>& N = values[g][side_number(mesh, e, mesh.face_vertices(f))];
            for (int i = 0; i < bases[g].count; ++i)
                for (int a = 0; a < n; ++a) points[f][a] += N[i] * point(x, element[i], n)[a];
        },
        element_work);
    return points;
}

}  // namespace

std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x) {
    constexpr int at_once = 512;  // elements
    const std::vector<Vec<3>> points = points_behind_faces(mesh, x);
    std::vector<Box> of_points;
    for (const Vec<3>& point : points) of_points.push_back({point, point});
    const BoxTree tree(std::move(of_points));
    std::vector<int> other(mesh.element_count(), -1);
    for (const ElementGroup& group : mesh.element_groups()) {
        const PatchBasis of(*group.cell, mesh.degree);
        parallel_for_uneven(
            (group.count + at_once - 1) / at_once,
            [&](int b) {
                const int first = group.first + b * at_once, end = std::min(first + at_once, group.first + group.count);
                std::vector<Patch> patches;
                std::vector<Box> boxes;
                for (int e = first; e < end; ++e) {
                    patches.push_back(make_patch(of, positions(mesh, x, mesh.element(e), of.nodes)));
                    boxes.push_back(box_of(patches.back()));
                }
                tree.visit_overlapping(boxes, [&](int q, int k) {
                    const int f = tree.items[k], behind = mesh.face_element[f], e = first + q;
                    if (behind == e || mesh.file.zone(behind) != mesh.file.zone(e)) return;
                    if (other[e] < 0 && holds(of.bernstein, patches[q], points[f])) other[e] = behind;
                });
            },
            at_once * element_work);
    }
    const auto found = std::find_if(other.begin(), other.end(), [](int e) { return e >= 0; });
    return found == other.end() ? std::array{-1, -1} : std::array{*found, static_cast<int>(found - other.begin())};
}

}  // namespace almesh
