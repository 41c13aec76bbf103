// The boundary by check_target(), with the positions that were reached as target; the angles of curved elements between
// the tangents of their edges, which are the differences of Bezier points at the vertex.
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

namespace almesh {
namespace {

constexpr double corner_work = 200;  // simple operations for the angles of an element, at least

// Sum of the angles of all elements at each vertex, in units of a full one.
std::vector<double> angle_sums(const Mesh& mesh, const std::vector<double>& x) {
    const int n = mesh.dim, corners = n + 1, m = mesh.element_nodes();
    const PatchBasis basis(n, mesh.degree);
    std::vector<double> at_corner(offset(mesh.element_count(), corners));
    parallel_for(
        mesh.element_count(),
        [&](int e) {
            Vec<3> corner[4]{};
            Patch patch;
            if (mesh.degree > 1) patch = make_patch(basis, positions(mesh, x, mesh.element(e), m));
            for (int i = 0; i < corners; ++i) std::copy_n(point(x, mesh.element(e)[i], n), n, corner[i].begin());
            for (int i = 0; i < corners; ++i) {
                Vec<3> tangent[3];
                for (int j = 0, k = 0; j < corners; ++j) {
                    if (j == i) continue;
                    tangent[k++] = mesh.degree > 1 ? edge_tangent(basis.bernstein, patch, i, j) : corner[j] - corner[i];
                }
                const Vec<3>&u = tangent[0], &v = tangent[1];
                const double turns = 1 / (2 * std::numbers::pi);
                at_corner[offset(e, corners, i)] = n == 2 ? turns * std::atan2(length(cross(u, v)), dot(u, v))
                                                          : 0.5 * turns * std::abs(solid_angle(u, v, tangent[2]));
            }
        },
        corner_work);
    std::vector<double> sum(mesh.nodes(), 0.0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < corners; ++i) sum[mesh.element(e)[i]] += at_corner[offset(e, corners, i)];
    return sum;
}

// The first vertex whose elements go around it more than once, or -1.
int overlapped_vertex(const Mesh& mesh, const std::vector<double>& x) {
    const std::vector<double> sum = angle_sums(mesh, x);
    constexpr double rounding = 1e-6;
    const auto found = std::find_if(sum.begin(), sum.end(), [](double turns) { return turns > 1 + rounding; });
    return found == sum.end() ? -1 : static_cast<int>(found - sum.begin());
}

// Per vertex a number that is the same for all vertices of a connected part.
std::vector<int> part_of_vertices(const Mesh& mesh) {
    std::vector<int> part(mesh.nodes());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&part](int i) {
        while (part[i] != i) i = part[i] = part[part[i]];
        return i;
    };
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 1; k <= mesh.dim; ++k) part[root(mesh.element(e)[k])] = root(mesh.element(e)[0]);
    for (int& i : part) i = root(i);
    return part;
}

// Whether the point is inside the element, not on its boundary; of a curved element whether it may be: it is in the box
// of its Bezier points.
bool may_hold(const PatchBasis& basis, const std::vector<Vec<3>>& nodes, const Vec<3>& p, int n) {
    constexpr double rounding = 1e-9;
    const Patch patch = make_patch(basis, nodes);
    Vec<3> low = patch[0], high = patch[0];
    for (const Vec<3>& b : patch)
        for (int a = 0; a < n; ++a) low[a] = std::min(low[a], b[a]), high[a] = std::max(high[a], b[a]);
    for (int a = 0; a < n; ++a)
        if (const double margin = rounding * (high[a] - low[a]); p[a] <= low[a] + margin || p[a] >= high[a] - margin)
            return false;
    if (static_cast<int>(nodes.size()) > n + 1) return true;
    const auto volume = [&](std::vector<Vec<3>> c) {
        for (int k = n; k > 0; --k) c[k] = c[k] - c[0];
        return n == 2 ? cross(c[1], c[2])[2] : dot(cross(c[1], c[2]), c[3]);
    };
    for (int k = 0; k <= n; ++k) {
        std::vector<Vec<3>> with = nodes;
        with[k] = p;
        if (volume(with) <= rounding * volume(nodes)) return false;
    }
    return true;
}

// An element of one part that a place of another lies in, or may: a place on each of its boundary faces, and the middle
// of the element behind it, as a face can lie along faces. -1: none, as where there is only one part.
// Cost: O(elements) for one part, else O(elements x boundary faces).
int overlapped_by_part(const Mesh& mesh, const std::vector<double>& x) {
    const int n = mesh.dim, corners = n + 1, m = mesh.element_nodes();
    const std::vector<int> part = part_of_vertices(mesh);
    const auto part_of = [&](int e) { return part[mesh.element(e)[0]]; };
    struct Place {
        Vec<3> x;
        int part;
    };
    std::vector<Place> places;
    const auto mean = [&](const int* nodes, int vertices) {
        Vec<3> sum{};
        for (const Vec<3>& at : positions(mesh, x, nodes, vertices)) sum = sum + 1.0 / vertices * at;
        return sum;
    };
    bool are_several = false;
    for (int e = 0; e < mesh.element_count(); ++e) are_several = are_several || part_of(e) != part_of(0);
    if (!are_several) return -1;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f], last = mesh.face(f)[mesh.face_nodes() - 1];
        places.push_back({mesh.degree == 1 ? mean(mesh.face(f), n) : positions(mesh, x, &last, 1)[0], part_of(e)});
        places.push_back({mean(mesh.element(e), corners), part_of(e)});
    }
    const PatchBasis basis(n, mesh.degree);
    std::vector<char> holds(mesh.element_count(), 0);
    parallel_for(
        mesh.element_count(),
        [&](int e) {
            const std::vector<Vec<3>> nodes = positions(mesh, x, mesh.element(e), m);
            holds[e] = std::any_of(places.begin(), places.end(), [&](const Place& place) {
                return place.part != part_of(e) && may_hold(basis, nodes, place.x, n);
            });
        },
        1e6);
    const auto found = std::find(holds.begin(), holds.end(), 1);
    return found == holds.end() ? -1 : static_cast<int>(found - holds.begin());
}

std::string fold_text(const Mesh& mesh, const std::vector<double>& x) {
    const auto [a, b] = mesh.folded[0];
    const auto id = [&mesh](int e) { return mesh.file.element_id.empty() ? e : mesh.file.element_id[e]; };
    const std::array<double, 3> place = centroid(mesh, x, mesh.element(a), mesh.dim + 1);
    return concat("elements ", id(a), " and ", id(b), " lie on the same side of their common face at ",
                  place_text(place.data(), mesh.dim), ", the first of ", counted(mesh.folded.size(), "such pair"));
}

}  // namespace

std::string overlap_text(const Mesh& mesh, const Injectivity& found, const Frame& frame) {
    if (found.node < 0 && found.face < 0) return found.obstacle;
    return found.obstacle + " at " + place_text(frame.to_file(found.place).data(), mesh.dim);
}

Injectivity certify_injective(const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate) {
    if (!certificate.valid) return {.obstacle = "elements are not certified valid"};
    if (!mesh.folded.empty()) return {.obstacle = fold_text(mesh, x)};
    if (const int i = overlapped_vertex(mesh, x); i >= 0)
        return {.obstacle = concat("the elements around node ", mesh.file.node_id.empty() ? i : mesh.file.node_id[i],
                                   " overlap"),
                .node = i,
                .place = centroid(mesh, x, &i, 1)};
    std::vector<double> boundary;
    for (const int i : mesh.faces)
        boundary.insert(boundary.end(), point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim);
    const TargetReport report = check_target(mesh, boundary);
    if (!report.faults.empty()) {
        const int f = report.faults.front().face;
        return {.obstacle = concat("the boundary overlaps itself at face ",
                                   mesh.file.face_id.empty() ? f : mesh.file.face_id[f], " of ",
                                   mesh.boundaries[mesh.face_boundary[f]]),
                .face = f,
                .place = centroid(mesh, x, mesh.face(f), mesh.dim)};
    }
    if (const int e = overlapped_by_part(mesh, x); e >= 0)
        return {.obstacle = concat("a part of the mesh that is not connected with it ",
                                   mesh.degree == 1 ? "overlaps" : "overlaps, or may overlap,", " element ",
                                   mesh.file.element_id.empty() ? e : mesh.file.element_id[e]),
                .node = mesh.element(e)[0],
                .place = centroid(mesh, x, mesh.element(e), mesh.dim + 1)};
    if (report.crossed_before) return {.obstacle = "the boundary of the initial mesh crosses itself"};
    return {.certified = true, .obstacle = ""};
}

}  // namespace almesh
