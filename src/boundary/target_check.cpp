#include "boundary/target_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "certify/patch_contact.hpp"
#include "certify/patch_normal.hpp"

namespace almesh {
namespace {

constexpr double smallest_normal = 1e-6;  // n . mean / |mean|^2 at or below which a face is folded
constexpr double degenerate = 1e-12;      // measure of a face or a closed part over its size^(n - 1) or size^n
constexpr double flat_fold = 1e-6;        // radians between two neighbours folded onto each other
constexpr double same_place = 1e-9;       // distance of two nodes over the size of their smallest face

// The boundary in one place: that of the initial mesh or of the target.
struct Surface {
    std::vector<double> x;       // node_count x dim; only boundary nodes are meaningful
    std::vector<Patch> patches;  // per face
};

std::vector<double> face_positions(const Mesh& mesh, const std::vector<double>& x, int f) {
    std::vector<double> nodes;
    for (int i = 0; i < mesh.face_nodes(); ++i) {
        const double* const position = &x[static_cast<std::size_t>(mesh.face(f)[i]) * mesh.dim];
        nodes.insert(nodes.end(), position, position + mesh.dim);
    }
    return nodes;
}

Surface make_surface(const Mesh& mesh, const PatchBasis& basis, const std::vector<double>& x) {
    Surface surface{x, {}};
    for (int f = 0; f < mesh.face_count(); ++f)
        surface.patches.push_back(make_patch(basis, face_positions(mesh, x, f).data(), mesh.dim));
    return surface;
}

std::vector<double> node_targets(const Mesh& mesh, const std::vector<double>& target) {
    std::vector<double> x = mesh.x;
    for (std::size_t k = mesh.faces.size(); k-- > 0;)  // backwards: the first face has the last word
        std::copy_n(&target[k * mesh.dim], mesh.dim, &x[static_cast<std::size_t>(mesh.faces[k]) * mesh.dim]);
    return x;
}

std::string face_name(const Mesh& mesh, int f) {
    std::ostringstream out;
    out << "face " << (mesh.face_id.empty() ? f : mesh.face_id[f]) << " of " << mesh.boundaries[mesh.face_boundary[f]]
        << " at (";
    for (int a = 0; a < mesh.dim; ++a) {
        double centre = 0;
        for (int v = 0; v < mesh.dim; ++v) centre += mesh.x[static_cast<std::size_t>(mesh.face(f)[v]) * mesh.dim + a];
        out << (a > 0 ? ", " : "") << centre / mesh.dim;
    }
    out << ')';
    return out.str();
}

double largest_side(const Box& box) {
    return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

// Faces that are degenerate or folded; returns a flag per face.
std::vector<char> check_faces(const Mesh& mesh, const Surface& target, TargetReport& report) {
    const PatchNormal form(mesh.dim, mesh.degree);
    std::vector<char> bad(mesh.face_count(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::array<std::vector<double>, 3> n = form.coefficients(target.patches[f]);
        Point mean;  // the mean of a polynomial is that of its Bezier coefficients
        for (int c = 0; c < 3; ++c) mean[c] = std::accumulate(n[c].begin(), n[c].end(), 0.0) / form.basis().count;
        const double size = largest_side(box_of(target.patches[f])), squared = dot(mean, mean);
        if (!(std::sqrt(squared) > degenerate * std::pow(size, mesh.dim - 1))) {
            report.faults.push_back({f, face_name(mesh, f) + ": the target collapses the face to nothing"});
            bad[f] = 1;
            continue;
        }
        std::vector<double> along(form.basis().count);
        for (int a = 0; a < form.basis().count; ++a)
            along[a] = (n[0][a] * mean[0] + n[1][a] * mean[1] + n[2][a] * mean[2]) / squared;
        if (polynomial_minimum(form.basis(), along.data(), 0.01, 500).upper > smallest_normal) continue;
        report.faults.push_back({f, face_name(mesh, f) + ": the target folds the face back on itself"});
        bad[f] = 1;
    }
    return bad;
}

// Closed part of the boundary that each face belongs to: faces are joined by shared vertices.
std::vector<int> closed_parts(const Mesh& mesh) {
    std::vector<int> parent(mesh.nodes());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int v = 1; v < mesh.dim; ++v) {
            const int a = root(mesh.face(f)[0]), b = root(mesh.face(f)[v]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    std::vector<int> part(mesh.face_count());
    std::map<int, int> number;
    for (int f = 0; f < mesh.face_count(); ++f)
        part[f] = number.insert({root(mesh.face(f)[0]), static_cast<int>(number.size())}).first->second;
    return part;
}

struct ClosedPart {
    int first_face;
    std::string boundaries;  // their names
};

std::vector<ClosedPart> describe(const Mesh& mesh, const std::vector<int>& part) {
    std::vector<ClosedPart> parts;
    std::vector<std::set<int>> seen;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (part[f] == static_cast<int>(parts.size())) {
            parts.push_back({f, {}});
            seen.emplace_back();
        }
        if (!seen[part[f]].insert(mesh.face_boundary[f]).second) continue;
        std::string& names = parts[part[f]].boundaries;
        names += (names.empty() ? "" : ", ") + mesh.boundaries[mesh.face_boundary[f]];
    }
    return parts;
}

// Area or volume enclosed by each closed part, positive where the domain is inside it. Relative to the part's first
// node, so that small parts far from the origin keep their digits.
std::vector<double> enclosed(const Mesh& mesh, const Surface& surface, const std::vector<int>& part,
                             const std::vector<ClosedPart>& parts) {
    const PatchNormal form(mesh.dim, mesh.degree);
    std::vector<double> sum(parts.size(), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f)
        sum[part[f]] += form.cone(surface.patches[f], surface.patches[parts[part[f]].first_face].point(0));
    return sum;
}

void check_closed_parts(const Mesh& mesh, const Surface& initial, const Surface& target, const std::vector<int>& part,
                        const std::vector<ClosedPart>& parts, TargetReport& report) {
    const std::vector<double> before = enclosed(mesh, initial, part, parts), after = enclosed(mesh, target, part, parts);
    std::vector<double> size(parts.size(), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const Point d = target.patches[f].point(0) - target.patches[parts[part[f]].first_face].point(0);
        size[part[f]] = std::max(size[part[f]], std::sqrt(dot(d, d)));
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const bool flat = std::abs(after[k]) <= degenerate * std::pow(size[k], mesh.dim);
        if (!flat && (before[k] > 0) == (after[k] > 0)) continue;
        std::ostringstream why;
        why << face_name(mesh, parts[k].first_face) << ": the target "
            << (flat ? "flattens" : "mirrors or turns inside out") << " the closed boundary made of "
            << parts[k].boundaries << (mesh.dim == 2 ? " (signed area " : " (signed volume ") << before[k] << " becomes "
            << after[k] << ')';
        report.faults.push_back({parts[k].first_face, why.str()});
    }
}

// Pairs (place in f, place in g) of the corners that two faces share.
std::vector<std::array<int, 2>> shared_corners(const Mesh& mesh, int f, int g) {
    std::vector<std::array<int, 2>> shared;
    for (int i = 0; i < mesh.dim; ++i)
        for (int j = 0; j < mesh.dim; ++j)
            if (mesh.face(f)[i] == mesh.face(g)[j]) shared.push_back({i, j});
    return shared;
}

// Direction in which the face leaves what it shares with its neighbour: a corner (2D), or the middle of the edge from
// corner i to corner j, then perpendicular to it.
Point leaving_corner(const Bernstein& basis, const Patch& patch, int i) { return side_tangent(basis, patch, i, 1 - i); }

Point leaving_edge(const Bernstein& basis, const Patch& patch, int i, int j) {
    const int a = std::min(i, j), b = std::max(i, j);
    const Patch half = bisect(basis, patch, a, b).first;  // the middle is its corner b
    const Point edge = side_tangent(basis, half, b, a);
    Point leaving = side_tangent(basis, half, b, 3 - a - b);
    const double along = dot(leaving, edge) / dot(edge, edge);
    for (int c = 0; c < 3; ++c) leaving[c] -= along * edge[c];
    return leaving;
}

bool folded_flat(const Bernstein& basis, const Patch& f, const Patch& g,
                 const std::vector<std::array<int, 2>>& shared) {
    const auto closed = [](const Point& u, const Point& v) {
        const Point turn = cross(u, v);
        return std::atan2(std::sqrt(dot(turn, turn)), dot(u, v)) < flat_fold;
    };
    if (basis.dim == 1)
        return std::any_of(shared.begin(), shared.end(), [&](const std::array<int, 2>& corner) {
            return closed(leaving_corner(basis, f, corner[0]), leaving_corner(basis, g, corner[1]));
        });
    return closed(leaving_edge(basis, f, shared[0][0], shared[1][0]), leaving_edge(basis, g, shared[0][1], shared[1][1]));
}

// Neighbours folded onto each other, faces of one closed part that cross; a note for each two parts that do.
void check_pairs(const Mesh& mesh, const PatchBasis& basis, const Surface& initial, const Surface& target,
                 const std::vector<char>& bad, const std::vector<int>& part, const std::vector<ClosedPart>& parts,
                 TargetReport& report) {
    std::vector<Box> boxes;
    for (const Patch& patch : target.patches) boxes.push_back(box_of(patch));
    const BoxTree tree(boxes);
    std::set<std::pair<int, int>> noted;
    const auto check = [&](int f, int g) {
        const Patch &patch_f = target.patches[f], &patch_g = target.patches[g];
        const std::vector<std::array<int, 2>> shared = shared_corners(mesh, f, g);
        const bool neighbours = static_cast<int>(shared.size()) >= mesh.dim - 1;
        if (neighbours && folded_flat(basis.bernstein, patch_f, patch_g, shared) &&
            !folded_flat(basis.bernstein, initial.patches[f], initial.patches[g], shared)) {
            report.faults.push_back({f, face_name(mesh, f) + ": the target folds it flat onto " + face_name(mesh, g)});
            return;
        }
        if (neighbours && mesh.dim == 3) return;  // they meet along a curve: no test for crossing can be strict there
        const std::pair<int, int> two_parts = std::minmax(part[f], part[g]);
        if (part[f] != part[g] && noted.contains(two_parts)) return;
        if (patch_contact(basis.bernstein, patch_f, patch_g) != Contact::crossing) return;
        if (part[f] == part[g]) {
            if (patch_contact(basis.bernstein, initial.patches[f], initial.patches[g]) != Contact::crossing)
                report.faults.push_back({f, face_name(mesh, f) + ": in the target it crosses " + face_name(mesh, g)});
            return;
        }
        noted.insert(two_parts);
        report.notes.push_back("in the target, the closed boundary made of " + parts[part[f]].boundaries +
                               " crosses the one made of " + parts[part[g]].boundaries + ": " + face_name(mesh, f) +
                               " and " + face_name(mesh, g));
    };
    for (int f = 0; f < mesh.face_count(); ++f) {
        std::vector<int> later;
        tree.visit_overlapping(boxes[f], [&](int g) {
            if (g > f && !bad[f] && !bad[g]) later.push_back(g);
        });
        std::sort(later.begin(), later.end());
        for (int g : later) check(f, g);
    }
}

// Distinct nodes of one closed part that the target puts in one place.
void check_nodes(const Mesh& mesh, const Surface& initial, const Surface& target, const std::vector<char>& bad,
                 const std::vector<int>& part, TargetReport& report) {
    struct BoundaryNode {
        int node, face;
        double size;  // of its smallest face in the target
    };
    std::vector<BoundaryNode> nodes;
    std::vector<int> place(mesh.nodes(), -1);
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.face_nodes(); ++i) {
            int& at = place[mesh.face(f)[i]];
            const double size = largest_side(box_of(target.patches[f]));
            if (at < 0) {
                at = static_cast<int>(nodes.size());
                nodes.push_back({mesh.face(f)[i], f, size});
            }
            nodes[at].size = std::min(nodes[at].size, size);
        }
    std::vector<Box> boxes;
    for (const BoundaryNode& b : nodes) boxes.push_back(box_of_points(&target.x[static_cast<std::size_t>(b.node) * mesh.dim], 1, mesh.dim));
    const BoxTree tree(boxes);
    const auto apart = [&](const std::vector<double>& x, int a, int b) {
        double squared = 0;
        for (int c = 0; c < mesh.dim; ++c) {
            const double d = x[static_cast<std::size_t>(a) * mesh.dim + c] - x[static_cast<std::size_t>(b) * mesh.dim + c];
            squared += d * d;
        }
        return std::sqrt(squared);
    };
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const BoundaryNode& a = nodes[k];
        Box around = boxes[k];
        const double tolerance = same_place * a.size;
        for (int c = 0; c < mesh.dim; ++c) {
            around.low[c] -= tolerance;
            around.high[c] += tolerance;
        }
        tree.visit_overlapping(around, [&](int l) {
            const BoundaryNode& b = nodes[l];
            if (l <= static_cast<int>(k) || part[a.face] != part[b.face] || (bad[a.face] && bad[b.face])) return;
            if (apart(target.x, a.node, b.node) > tolerance || apart(initial.x, a.node, b.node) <= tolerance) return;
            report.faults.push_back({b.face, face_name(mesh, b.face) + ": the target puts its node " +
                                                 std::to_string(mesh.node_id.empty() ? b.node : mesh.node_id[b.node]) +
                                                 " where node " +
                                                 std::to_string(mesh.node_id.empty() ? a.node : mesh.node_id[a.node]) + " is"});
        });
    }
}

}  // namespace

TargetReport check_target(const Mesh& mesh, const std::vector<double>& target_nodes) {
    const PatchBasis basis(mesh.dim - 1, mesh.degree);
    const Surface initial = make_surface(mesh, basis, mesh.x);
    const Surface target = make_surface(mesh, basis, node_targets(mesh, target_nodes));
    TargetReport report;
    const std::vector<char> bad = check_faces(mesh, target, report);
    const std::vector<int> part = closed_parts(mesh);
    const std::vector<ClosedPart> parts = describe(mesh, part);
    check_closed_parts(mesh, initial, target, part, parts, report);
    check_pairs(mesh, basis, initial, target, bad, part, parts, report);
    check_nodes(mesh, initial, target, bad, part, report);
    return report;
}

}  // namespace almesh
