#include "check/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

constexpr double depth = 1e-4;        // of a point beside a face, over the distance of the face from the centre
constexpr double element_work = 200;  // simple operations for an element, at least

// A point for each boundary face: depth of the way from the centre of the face to that of the element.
std::vector<Vec<3>> points_behind_faces(const Mesh& mesh, const std::vector<double>& x) {
    const int n = mesh.dim, m = mesh.element_nodes();
    const LagrangeBasis basis(n, mesh.degree);
    std::vector<std::vector<double>> values(n + 1, std::vector<double>(m));  // behind the face opposite vertex k
    for (int k = 0; k <= n; ++k) {
        std::vector<double> lambda(n + 1, (1 - depth / (n + 1)) / n);
        lambda[k] = depth / (n + 1);
        basis.values(&lambda[1], values[k].data());
    }
    std::vector<Vec<3>> points(mesh.face_count(), Vec<3>{});
    parallel_for(
        mesh.face_count(),
        [&](int f) {
            const int* const element = mesh.element(mesh.face_element[f]);
            const int k = side_number(mesh, mesh.face_element[f], mesh.face(f));
            for (int i = 0; i < m; ++i)
                for (int a = 0; a < n; ++a) points[f][a] += values[k][i] * point(x, element[i], n)[a];
        },
        element_work);
    return points;
}

}  // namespace

std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x) {
    constexpr int at_once = 512;  // elements
    const int m = mesh.element_nodes(), blocks = (mesh.element_count() + at_once - 1) / at_once;
    const std::vector<Vec<3>> points = points_behind_faces(mesh, x);
    std::vector<Box> of_points;
    for (const Vec<3>& point : points) of_points.push_back({point, point});
    const BoxTree tree(std::move(of_points));
    const PatchBasis basis(mesh.dim, mesh.degree);
    std::vector<int> other(mesh.element_count(), -1);
    parallel_for_uneven(
        blocks,
        [&](int b) {
            const int first = b * at_once, end = std::min(first + at_once, mesh.element_count());
            std::vector<Patch> patches;
            std::vector<Box> boxes;
            for (int e = first; e < end; ++e) {
                patches.push_back(make_patch(basis, positions(mesh, x, mesh.element(e), m)));
                boxes.push_back(box_of(patches.back()));
            }
            tree.visit_overlapping(boxes, [&](int q, int k) {
                const int f = tree.items[k], behind = mesh.face_element[f], e = first + q;
                if (behind == e || mesh.file.zone(behind) != mesh.file.zone(e)) return;
                if (other[e] < 0 && holds(basis.bernstein, patches[q], points[f])) other[e] = behind;
            });
        },
        at_once * element_work);
    const auto found = std::find_if(other.begin(), other.end(), [](int e) { return e >= 0; });
    return found == other.end() ? std::array{-1, -1} : std::array{*found, static_cast<int>(found - other.begin())};
}

}  // namespace almesh
