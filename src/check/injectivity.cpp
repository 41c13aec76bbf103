// The boundary by check_target(), with the positions that were reached as target; the angles of elements between the
// tangents of their edges, which are the differences of Bezier points at the vertex and depend on the edges' nodes
// alone. They span the cone of a valid element there: at the apex of a pyramid the layer of its map next to the apex is
// bilinear, so that the sides of the cone are flat; its four edges have the angles of two tetrahedra.
#include "check/injectivity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/target_check.hpp"
#include "geometry/patch.hpp"
#include "mesh/sides.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

constexpr double element_work = 200;  // simple operations for an element, at least
constexpr double depth = 1e-4;        // of a point beside a face, over the distance of the face from the centre

// The edges of a cell of degree p, by their vertices.
class VertexEdges {
public:
    VertexEdges(const CellType& cell, int degree) : cell_(cell), degree_(degree), line_(1, degree), at_(cell.vertices) {
        for (const int end : {0, 1}) next_[end] = next_to_corner(line_.bernstein, end, 1 - end);
        for (std::size_t k = 0; k < cell.edges.size(); ++k)
            for (const int v : cell.edges[k]) at_[v].push_back(static_cast<int>(k));
    }

    // The angle of an element at vertex v in units of a full one. node: those of the element.
    double angle(const int* node, int v, const std::vector<double>& x, int n) const {
        Vec<3> tangent[4];
        const std::vector<int>& edges = at_[v];
        for (std::size_t k = 0; k < edges.size(); ++k) tangent[k] = tangent_of(node, edges[k], v, x, n);
        const double turns = 1 / (2 * std::numbers::pi);
        const Vec<3>&u = tangent[0], &w = tangent[1];
        if (n == 2) return turns * std::atan2(length(cross(u, w)), dot(u, w));
        double sum = 0;
        for (std::size_t k = 2; k < edges.size(); ++k) sum += solid_angle(u, tangent[k - 1], tangent[k]);
        return 0.5 * turns * std::abs(sum);
    }

private:
    const CellType& cell_;
    int degree_;
    PatchBasis line_;
    std::array<int, 2> next_;           // of a line: the Bezier point beside each end
    std::vector<std::vector<int>> at_;  // of each vertex: its edges

    Vec<3> tangent_of(const int* node, int edge, int v, const std::vector<double>& x, int n) const {
        const std::array<int, 2>& ends = cell_.edges[edge];
        const int end = ends[1] == v;
        return line_.point<Vec<3>>(next_[end], [&](int i) {
            const int local = i < 2 ? ends[i] : cell_.vertices + edge * (degree_ - 1) + i - 2;
            Vec<3> from_vertex{};
            for (int a = 0; a < n; ++a) from_vertex[a] = point(x, node[local], n)[a] - point(x, node[v], n)[a];
            return from_vertex;
        });
    }
};

// Sum of the angles of all elements at each vertex, in units of a full one.
std::vector<double> angle_sums(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<double> sum(mesh.nodes(), 0.0);
    for (const ElementGroup& group : mesh.element_groups()) {
        const VertexEdges edges(*group.cell, mesh.degree);
        const int corners = group.cell->vertices;
        std::vector<double> angle(offset(group.count, corners));
        parallel_for(group.count, [&](int e) {
            for (int v = 0; v < corners; ++v)
                angle[offset(e, corners, v)] = edges.angle(mesh.element(group.first + e), v, x, mesh.dim);
        }, element_work);
        for (int e = 0; e < group.count; ++e)
            for (int v = 0; v < corners; ++v) sum[mesh.element(group.first + e)[v]] += angle[offset(e, corners, v)];
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
    parallel_for(mesh.face_count(), [&](int f) {
        const int e = mesh.face_element[f], g = mesh.group_number(e);
        const int* const element = mesh.element(e);
        const std::vector<double>& N = values[g][side_number(mesh, e, mesh.face_vertices(f))];
        for (int i = 0; i < bases[g].count; ++i)
            for (int a = 0; a < n; ++a) points[f][a] += N[i] * point(x, element[i], n)[a];
    }, element_work);
    return points;
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

std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x) {
    constexpr int at_once = 512;  // elements
    const std::vector<Vec<3>> points = points_behind_faces(mesh, x);
    std::vector<Box> of_points;
    for (const Vec<3>& point : points) of_points.push_back({point, point});
    const BoxTree tree(std::move(of_points));
    std::vector<int> other(mesh.element_count(), -1);
    for (const ElementGroup& group : mesh.element_groups()) {
        const PatchBasis of(*group.cell, mesh.degree);
        parallel_for_uneven((group.count + at_once - 1) / at_once, [&](int b) {
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
        }, at_once * element_work);
    }
    const auto found = std::find_if(other.begin(), other.end(), [](int e) { return e >= 0; });
    return found == other.end() ? std::array{-1, -1} : std::array{*found, static_cast<int>(found - other.begin())};
}

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
