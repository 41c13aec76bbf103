// The boundary by check_target(), with the positions that were reached as target; the angles of elements between the
// tangents of their edges, which are the differences of Bezier points at the vertex.
#include "check/injectivity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/element_patches.hpp"
#include "check/overlap.hpp"
#include "check/target_check.hpp"
#include "geometry/patch.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

constexpr double corner_work = 200;  // simple operations for the angles of an element, at least

// Sum of the angles of all elements at each vertex, in units of a full one.
std::vector<double> angle_sums(const Mesh& mesh, const std::vector<double>& x) {
    const int n = mesh.dim, corners = n + 1;
    std::vector<double> sum(mesh.nodes(), 0.0);
    for (const ElementGroup& group : mesh.element_groups()) {
        const ElementPatches patches(mesh, group);
        const Bernstein& bernstein = patches.basis.bernstein;
        int next[4][4] = {};
        for (int i = 0; i < corners; ++i)
            for (int j = 0; j < corners; ++j)
                if (j != i) next[i][j] = next_to_corner(bernstein, i, j);
        const int of_element = patches.count() * corners;
        std::vector<double> at_corner(offset(group.count, of_element));
        parallel_for(
            group.count,
            [&](int e) {
                for (int part = 0; part < patches.count(); ++part) {
                    const Patch patch = patches.of(x, group.first + e, part);
                    for (int i = 0; i < corners; ++i) {
                        Vec<3> tangent[3];
                        for (int j = 0, k = 0; j < corners; ++j)
                            if (j != i) tangent[k++] = patch[next[i][j]] - patch[i];
                        const Vec<3>&u = tangent[0], &v = tangent[1];
                        const double turns = 1 / (2 * std::numbers::pi);
                        at_corner[offset(e, of_element, part * corners + i)] =
                            n == 2 ? turns * std::atan2(length(cross(u, v)), dot(u, v))
                                   : 0.5 * turns * std::abs(solid_angle(u, v, tangent[2]));
                    }
                }
            },
            corner_work);
        for (int e = 0; e < group.count; ++e)
            for (int k = 0; k < of_element; ++k)
                sum[mesh.element(group.first + e)[patches.cut.vertices[k / corners][k % corners]]] +=
                    at_corner[offset(e, of_element, k)];
    }
    return sum;
}

// The first vertex whose elements go around it more than once, or -1.
int overlapped_vertex(const Mesh& mesh, const std::vector<double>& x) {
    const std::vector<double> sum = angle_sums(mesh, x);
    constexpr double rounding = 1e-6;
    const auto found = std::find_if(sum.begin(), sum.end(), [](double turns) { return turns > 1 + rounding; });
    return found == sum.end() ? -1 : static_cast<int>(found - sum.begin());
}

std::string fold_text(const Mesh& mesh, const std::vector<double>& x) {
    const auto [a, b] = mesh.folded[0];
    const std::array<double, 3> position = element_centre(mesh, x, a);
    const std::vector<long long>& id = mesh.file.element_id;
    return concat("elements ", id_in_file(id, a), " and ", id_in_file(id, b),
                  " lie on the same side of their common face at ", position_text(position.data(), mesh.dim),
                  ", the first of ", counted(mesh.folded.size(), "such pair"));
}

}  // namespace

std::string overlap_text(const Mesh& mesh, const Injectivity& found, const Frame& frame) {
    if (found.node < 0 && found.face < 0) return found.reason;
    return found.reason + " at " + position_text(frame.to_file(found.position).data(), mesh.dim);
}

Injectivity certify_injective(const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate) {
    if (!certificate.valid) return {.reason = "elements are not certified valid"};
    if (!mesh.folded.empty()) return {.reason = fold_text(mesh, x)};
    if (const int i = overlapped_vertex(mesh, x); i >= 0)
        return {.reason = concat("the elements around node ", id_in_file(mesh.file.node_id, i), " overlap"),
                .node = i,
                .position = centroid(mesh, x, &i, 1)};
    const TargetReport report = check_target(mesh, x, {}, FaceBend::any);
    const auto at_face = [&](const std::string& what, int f) {
        return Injectivity{.reason = concat(what, " at face ", id_in_file(mesh.file.face_id, f), " of ",
                                            mesh.boundaries[mesh.face_boundary[f]]),
                           .face = f,
                           .position = centroid(mesh, x, mesh.face(f), mesh.face_cell(f).vertices)};
    };
    if (!report.faults.empty()) return at_face("the boundary overlaps itself", report.faults.front().face);
    if (const auto [e, other] = overlapping_elements(mesh, x); e >= 0) {
        const std::vector<long long>& id = mesh.file.element_id;
        const bool is_exact = mesh.degree == 1 && mesh.is_simplicial();
        return {.reason = concat("elements ", id_in_file(id, e), " and ", id_in_file(id, other),
                                 " lie over each other", is_exact ? "" : ", or are too close to tell"),
                .node = mesh.element(e)[0],
                .position = element_centre(mesh, x, e)};
    }
    if (report.crossed_before >= 0)
        return at_face("the boundary of the initial mesh crosses itself", report.crossed_before);
    return {.certified = true, .reason = ""};
}

}  // namespace almesh
