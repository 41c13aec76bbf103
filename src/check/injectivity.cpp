// The boundary by check_target(), with the positions that were reached as target; the angles of elements between the
// tangents of their edges, which are the differences of Bezier points at the vertex and depend on the edges' nodes
// alone. They span the cone of a valid element there: at the apex of a pyramid the layer of its map next to the apex is
// bilinear, so that the sides of the cone are flat; its four edges have the angles of two tetrahedra.
#include "check/injectivity.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "check/target_check.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

constexpr double element_work = 200;  // simple operations for an element, at least
constexpr double most_overlap = 0.25;  // of boundaries in contact, over the longest edge of the faces there

// The edges of a cell of degree p, by their vertices.
class VertexEdges {
public:
    VertexEdges(const CellType& cell, int degree) : cell_(cell), degree_(degree), line_(1, degree), at_(cell.vertices) {
        for (const int end : {0, 1}) next_[end] = next_to_corner(line_.bernstein, end, 1 - end);
        for (std::size_t k = 0; k < cell.edges.size(); ++k)
            for (const int v : cell.edges[k]) at_[v].push_back(static_cast<int>(k));
    }

    // The angle of an element at vertex v in units of a full one, and the least length of a tangent there. node: those
    // of the element.
    std::pair<double, double> angle(const int* node, int v, const std::vector<double>& x, int n) const {
        Vec<3> tangent[4];
        const std::vector<int>& edges = at_[v];
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < edges.size(); ++k) {
            tangent[k] = tangent_of(node, edges[k], v, x, n);
            least = std::min(least, length(tangent[k]));
        }
        const double turns = 1 / (2 * std::numbers::pi);
        const Vec<3>&u = tangent[0], &w = tangent[1];
        if (n == 2) return {turns * std::atan2(length(cross(u, w)), dot(u, w)), least};
        double sum = 0;
        for (std::size_t k = 2; k < edges.size(); ++k) sum += solid_angle(u, tangent[k - 1], tangent[k]);
        return {0.5 * turns * std::abs(sum), least};
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

// The first vertex at which the angles of the elements exceed a full turn, or -1. place: of each node; nodes with the
// same place count as one.
int overlapped_vertex(const Mesh& mesh, const std::vector<double>& x, const std::vector<int>& place) {
    constexpr double of_positions = 16 * std::numeric_limits<double>::epsilon();
    std::vector<double> turns(mesh.nodes(), -1e-8);  // but for what may be rounding
    for (const ElementGroup& group : mesh.element_groups()) {
        const VertexEdges edges(*group.cell, mesh.degree);
        const int corners = group.cell->vertices;
        std::vector<double> angle(offset(group.count, corners));
        parallel_for(group.count, [&](int e) {
            const int* const node = mesh.element(group.first + e);
            for (int v = 0; v < corners; ++v) {
                const auto [of_vertex, tangent] = edges.angle(node, v, x, mesh.dim);
                const double rounding = of_positions * length(positions(mesh, x, node + v, 1)[0]) + mesh.rounding;
                angle[offset(e, corners, v)] = of_vertex - rounding / tangent;
            }
        }, element_work);
        for (int e = 0; e < group.count; ++e)
            for (int v = 0; v < corners; ++v)
                turns[place[mesh.element(group.first + e)[v]]] += angle[offset(e, corners, v)];
    }
    const auto found = std::find_if(turns.begin(), turns.end(), [](double sum) { return sum > 1; });
    return found == turns.end() ? -1 : static_cast<int>(found - turns.begin());
}

std::vector<Vec<3>> centres_of_faces(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<Vec<3>> centres(mesh.face_count(), Vec<3>{});
    for (const ElementGroup& group : mesh.face_groups()) {
        const LagrangeBasis basis(*group.cell, mesh.degree);
        std::array<double, 3> middle{};
        for (int v = 0; v < group.cell->vertices; ++v)
            for (int a = 0; a < basis.dim; ++a) middle[a] += basis.point(v)[a] / group.cell->vertices;
        std::vector<double> N(basis.count);
        basis.values(middle.data(), N.data());
        parallel_for(group.count, [&](int k) {
            const std::vector<Vec<3>> node = positions(mesh, x, mesh.face(group.first + k), basis.count);
            for (int i = 0; i < basis.count; ++i)
                centres[group.first + k] = centres[group.first + k] + N[i] * node[i];
        }, element_work);
    }
    return centres;
}

std::string fold_text(const Mesh& mesh, const std::vector<double>& x) {
    const auto [a, b] = mesh.folded[0];
    const std::array<double, 3> position = element_centre(mesh, x, a);
    const std::vector<long long>& id = mesh.file.element_id;
    return concat("elements ", id_in_file(id, a), " and ", id_in_file(id, b),
                  " lie on the same side of their common face at ", position_text(position.data(), mesh.dim),
                  ", the first of ", counted(mesh.folded.size(), "such pair"));
}

// Pairs (k, e) of a point and an element that holds it, for which wanted(k, e).
template <class Wanted>
std::vector<std::array<int, 2>> holders(const Mesh& mesh, const std::vector<double>& x,
                                        const std::vector<Vec<3>>& points, const Wanted& wanted) {
    constexpr int at_once = 512;  // elements
    std::vector<Box> of_points;
    for (const Vec<3>& point : points) of_points.push_back({point, point});
    const BoxTree tree(std::move(of_points));
    std::vector<std::array<int, 2>> all;
    for (const ElementGroup& group : mesh.element_groups()) {
        const PatchBasis of(*group.cell, mesh.degree);
        std::vector<std::vector<std::array<int, 2>>> found((group.count + at_once - 1) / at_once);
        parallel_for_uneven(static_cast<int>(found.size()), [&](int b) {
            const int first = group.first + b * at_once, end = std::min(first + at_once, group.first + group.count);
            std::vector<Patch> patches;
            std::vector<Box> boxes;
            for (int e = first; e < end; ++e) {
                patches.push_back(make_patch(of, positions(mesh, x, mesh.element(e), of.nodes)));
                boxes.push_back(box_of(patches.back()));
            }
            tree.visit_overlapping(boxes, [&](int q, int item) {
                const int k = tree.items[item];
                if (wanted(k, first + q) && holds(of.bernstein, patches[q], points[k]))
                    found[b].push_back({k, first + q});
            });
        }, at_once * element_work);
        for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

// Vertices of the element at the places of these nodes.
int shared_places(const Mesh& mesh, int e, std::span<const int> nodes, const std::vector<int>& place) {
    const int* const of_element = mesh.element(e);
    return static_cast<int>(std::count_if(of_element, of_element + mesh.cell(e).vertices, [&](int i) {
        return std::any_of(nodes.begin(), nodes.end(), [&](int j) { return place[i] == place[j]; });
    }));
}

// Measures how far boundaries that are in contact overlap: the largest distance from the others in it of points of
// their faces, the corners of equal pieces, that are in an element away from the face.
void measure_contacts(const Mesh& mesh, const std::vector<double>& x, const std::vector<int>& place,
                      Injectivity& found) {
    if (mesh.contact.empty()) return;
    const FacePatches faces(mesh);
    std::vector<Vec<3>> points;
    std::vector<int> face;  // of each point
    const auto add = [&](const Patch& piece, int f) {
        points.insert(points.end(), piece.begin(), piece.begin() + mesh.dim);
        face.insert(face.end(), mesh.dim, f);
    };
    std::vector<Patch> patches;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const Patch& patch : faces.of(f, x)) {
            patches.push_back(patch);
            if (!contact_of(mesh, f)) continue;
            for_pieces(faces.basis.bernstein, patch, 2 * mesh.dim, [&](const Patch& piece) { add(piece, f); });
        }
    const ClosestPoint boundary(faces.basis, patches);
    const auto is_away = [&](int k, int e) {
        return mesh.file.zone(mesh.face_element[face[k]]) == mesh.file.zone(e) &&
               shared_places(mesh, e, mesh.face_vertices(face[k]), place) == 0;
    };
    for (const auto& [k, e] : holders(mesh, x, points, is_away)) {
        const int f = face[k], contact = contact_of(mesh, f);
        const ClosestPoint::Place at = boundary.find(points[k], [&](int patch) {
            const int g = faces.face[patch];
            return contact_of(mesh, g) == contact && (contact < 0 || mesh.face_boundary[g] != mesh.face_boundary[f]);
        });
        if (at.patch < 0) continue;
        const double edge =
            std::max(size_of(patches[faces.first[f]], mesh.dim - 1), size_of(patches[at.patch], mesh.dim - 1));
        found.overlap = std::max(found.overlap, at.distance);
        found.relative_overlap = std::max(found.relative_overlap, at.distance / edge);
    }
}

// Pairs (f, e) of a boundary face and an element that may lie over the one behind it: it holds the centre of f, or has
// a vertex of another face that touches f, and no side in common with the one behind.
std::vector<std::array<int, 2>> suspects(const Mesh& mesh, const std::vector<double>& x, const TargetReport& report) {
    std::vector<std::array<int, 2>> found =
        holders(mesh, x, centres_of_faces(mesh, x),
                [&](int f, int e) { return e != mesh.face_element[f] && !mesh.is_inner(f); });
    std::map<int, std::vector<int>> at;  // elements at the places of vertices of faces that touch others
    for (const auto& pair : report.touching)
        for (const int f : pair)
            for (const int i : mesh.face_vertices(f)) at[report.place[i]];
    for (int e = 0; e < mesh.element_count() && !at.empty(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v)
            if (const auto here = at.find(report.place[mesh.element(e)[v]]); here != at.end())
                here->second.push_back(e);
    for (const auto& [f, g] : report.touching)
        for (const auto& [face, other] : {std::pair(f, g), std::pair(g, f)}) {
            if (mesh.is_inner(f) || mesh.is_inner(g)) continue;  // no part of the boundary of the whole
            const int behind = mesh.face_element[face];
            const std::span<const int> of_behind(mesh.element(behind), mesh.cell(behind).vertices);
            for (const int i : mesh.face_vertices(other))
                for (const int e : at[report.place[i]])
                    if (shared_places(mesh, e, of_behind, report.place) < mesh.dim) found.push_back({face, e});
        }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace

std::array<int, 2> overlapping_elements(const Mesh& mesh, const std::vector<double>& x, const TargetReport& report) {
    const Overlaps overlaps(mesh);
    std::vector<PatchBasis> bases;
    for (const ElementGroup& group : mesh.element_groups()) bases.emplace_back(*group.cell, mesh.degree);
    const auto solid = [&](int e) {
        const PatchBasis& basis = bases[mesh.group_number(e)];
        return Solid{mesh.cell(e), basis, make_patch(basis, positions(mesh, x, mesh.element(e), basis.nodes))};
    };
    const std::vector<std::array<int, 2>> pairs = suspects(mesh, x, report);
    const int count = static_cast<int>(pairs.size());
    std::atomic<int> first = count;
    parallel_for_uneven(count, [&](int k) {
        const auto [f, e] = pairs[k];
        const int behind = mesh.face_element[f], vertices = mesh.face_cell(f).vertices;
        if (k > first || report.glued[f] || overlaps.elements(behind, e)) return;
        const Solid a = solid(behind), b = solid(e);
        const Vec<3> normal = flat_normal(positions(mesh, x, mesh.face(f), vertices), mesh.dim - 1, vertices);
        const double tolerance = contact_tolerance(a.patch, b.patch, mesh.rounding);
        if (solid_contact(a, b, normal, tolerance) == Contact::apart) return;
        for (int other = first; k < other && !first.compare_exchange_weak(other, k);) {}
    }, 100 * element_work);
    if (first == count) return {-1, -1};
    return {mesh.face_element[pairs[first][0]], pairs[first][1]};
}

std::string overlap_text(const Mesh& mesh, const Injectivity& found, const Frame& frame) {
    if (found.node < 0 && found.face < 0) return found.reason;
    return found.reason + " at " + position_text(frame.to_file(found.position).data(), mesh.dim);
}

Injectivity certify_injective(const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate) {
    if (!certificate.valid) return {.reason = "elements are not certified valid"};
    if (!mesh.folded.empty()) return {.reason = fold_text(mesh, x)};
    const TargetReport report = check_target(mesh, x, {}, FaceBend::of_valid);
    if (const int i = overlapped_vertex(mesh, x, report.place); i >= 0)
        return {.reason = concat("the elements around node ", id_in_file(mesh.file.node_id, i), " overlap"),
                .node = i,
                .position = centroid(mesh, x, &i, 1)};
    const auto at_face = [&](const std::string& what, int f, int other) {
        return Injectivity{.reason = what,
                           .face = f,
                           .other_face = other,
                           .position = centroid(mesh, x, mesh.face(f), mesh.face_cell(f).vertices)};
    };
    if (!report.faults.empty()) {
        const int f = report.faults.front().face;
        return at_face("the boundary overlaps itself at " + face_name(mesh, f), f, -1);
    }
    if (const auto [f, other] = report.crossed_before; f >= 0)
        return at_face(concat(face_name(mesh, f), " crosses ", face_name(mesh, other), ", in the initial mesh too,"), f,
                       other);
    if (const auto [e, other] = overlapping_elements(mesh, x, report); e >= 0) {
        const std::vector<long long>& id = mesh.file.element_id;
        const bool is_exact = mesh.degree == 1 && mesh.is_simplicial();
        return {.reason = concat("elements ", id_in_file(id, e), " and ", id_in_file(id, other),
                                 " lie over each other", is_exact ? "" : ", or are too close to tell"),
                .node = mesh.element(e)[0],
                .position = element_centre(mesh, x, e)};
    }
    Injectivity found;
    measure_contacts(mesh, x, report.place, found);
    if (found.relative_overlap > most_overlap)
        found.reason = concat("boundaries in contact overlap by ", found.relative_overlap, " of an edge");
    found.certified = found.reason.empty();
    return found;
}

}  // namespace almesh
