#include "check/target_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "base/parallel.hpp"
#include "geometry/patch_contact.hpp"

namespace almesh {
namespace {

constexpr double smallest_normal = 1e-6;  // n . mean / |mean|^2 at or below which a face is folded
constexpr double degenerate = 1e-12;      // measure of a face or a closed part over its size^(n - 1) or size^n
constexpr double flat_fold = 1e-6;        // radians between two neighbours folded onto each other
constexpr double same_place = 1e-9;       // distance of two nodes over the size of their smallest face
constexpr double face_work = 1000;        // simple operations that a check of one face takes

// The boundary in one place: that of the initial mesh or of the target.
struct Surface {
    std::vector<double> x;       // node_count x dim; only boundary nodes are meaningful
    std::vector<Patch> patches;  // per face
};

Surface make_surface(const Mesh& mesh, const PatchBasis& basis, const std::vector<double>& x) {
    Surface surface{x, std::vector<Patch>(mesh.face_count())};
    parallel_for(mesh.face_count(), [&](int f) {
        surface.patches[f] = make_patch(basis, face_positions(mesh, x, f).data(), mesh.dim);
    }, face_work);
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

// What the checks below share.
struct Check {
    const Mesh& mesh;
    PatchBasis basis;
    Surface initial, target;
    std::vector<int> part;          // per face
    std::vector<ClosedPart> parts;
    std::vector<char> bad;          // per face: its FaceFault; those with one are passed over by the later checks
    TargetReport report;

    void add_fault(int f, const std::string& what) { report.faults.push_back({f, face_name(mesh, f) + ": " + what}); }
    long long id_of_node(int i) const { return mesh.node_id.empty() ? i : mesh.node_id[i]; }
};

enum FaceFault : char { fine, collapsed, folded_back };

FaceFault fault_of_face(const PatchNormal& form, const Patch& patch, int dim) {
    const std::vector<Vec<3>> n = form.coefficients(patch);
    Vec<3> mean{};  // the mean of a polynomial is that of its Bezier coefficients
    for (const Vec<3>& v : n) mean = mean + (1.0 / n.size()) * v;
    const double squared = dot(mean, mean);
    if (!(std::sqrt(squared) > degenerate * std::pow(largest_side(box_of(patch)), dim - 1))) return collapsed;
    std::vector<double> along;
    for (const Vec<3>& v : n) along.push_back(dot(v, mean) / squared);
    return polynomial_minimum(form.basis(), along.data(), 0.01, 500).upper <= smallest_normal ? folded_back : fine;
}

void check_faces(Check& check) {
    const PatchNormal form(check.mesh.dim, check.mesh.degree);
    parallel_for(check.mesh.face_count(), [&](int f) {
        check.bad[f] = fault_of_face(form, check.target.patches[f], check.mesh.dim);
    }, face_work);
    for (int f = 0; f < check.mesh.face_count(); ++f) {
        if (check.bad[f] == collapsed) check.add_fault(f, "the target collapses the face to nothing");
        if (check.bad[f] == folded_back) check.add_fault(f, "the target folds the face back on itself");
    }
}

// Area or volume enclosed by each closed part, positive where the domain is inside it. Relative to the part's first
// node, so that small parts far from the origin keep their digits.
std::vector<double> enclosed(const Check& check, const Surface& surface) {
    const PatchNormal form(check.mesh.dim, check.mesh.degree);
    std::vector<double> cone(check.mesh.face_count()), sum(check.parts.size(), 0.0);
    parallel_for(check.mesh.face_count(), [&](int f) {
        cone[f] = form.cone(surface.patches[f], surface.patches[check.parts[check.part[f]].first_face][0]);
    }, face_work);
    for (int f = 0; f < check.mesh.face_count(); ++f) sum[check.part[f]] += cone[f];
    return sum;
}

void check_closed_parts(Check& check) {
    const Mesh& mesh = check.mesh;
    const std::vector<double> before = enclosed(check, check.initial), after = enclosed(check, check.target);
    std::vector<double> size(check.parts.size(), 0.0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int k = check.part[f];
        const Vec<3> d = check.target.patches[f][0] - check.target.patches[check.parts[k].first_face][0];
        size[k] = std::max(size[k], std::sqrt(dot(d, d)));
    }
    for (std::size_t k = 0; k < check.parts.size(); ++k) {
        const bool flat = std::abs(after[k]) <= degenerate * std::pow(size[k], mesh.dim);
        if (!flat && (before[k] > 0) == (after[k] > 0)) continue;
        std::ostringstream what;
        what << "the target " << (flat ? "flattens" : "mirrors or turns inside out") << " the closed boundary made of "
             << check.parts[k].boundaries << " (signed " << (mesh.dim == 2 ? "area " : "volume ") << before[k]
             << " becomes " << after[k] << ')';
        check.add_fault(check.parts[k].first_face, what.str());
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
Vec<3> leaving_corner(const Bernstein& basis, const Patch& patch, int i) { return side_tangent(basis, patch, i, 1 - i); }

Vec<3> leaving_edge(const Bernstein& basis, const Patch& patch, int i, int j) {
    const int a = std::min(i, j), b = std::max(i, j);
    const Patch half = bisect(basis, patch, a, b).first;  // the middle is its corner b
    const Vec<3> edge = side_tangent(basis, half, b, a);
    Vec<3> leaving = side_tangent(basis, half, b, 3 - a - b);
    const double along = dot(leaving, edge) / dot(edge, edge);
    for (int c = 0; c < 3; ++c) leaving[c] -= along * edge[c];
    return leaving;
}

bool folded_flat(const Bernstein& basis, const Patch& f, const Patch& g,
                 const std::vector<std::array<int, 2>>& shared) {
    const auto closed = [](const Vec<3>& u, const Vec<3>& v) {
        const Vec<3> turn = cross(u, v);
        return std::atan2(std::sqrt(dot(turn, turn)), dot(u, v)) < flat_fold;
    };
    if (basis.dim == 1)
        return std::any_of(shared.begin(), shared.end(), [&](const std::array<int, 2>& corner) {
            return closed(leaving_corner(basis, f, corner[0]), leaving_corner(basis, g, corner[1]));
        });
    return closed(leaving_edge(basis, f, shared[0][0], shared[1][0]),
                  leaving_edge(basis, g, shared[0][1], shared[1][1]));
}

enum class PairFault { none, folded, crossing };

// Faces f and g whose boxes overlap. Neighbours are tested for being folded onto each other; in 3D they meet along a
// curve, where no test for crossing can be strict.
PairFault fault_of_pair(const Check& check, int f, int g) {
    const Bernstein& basis = check.basis.bernstein;
    const std::vector<Patch>&before = check.initial.patches, &after = check.target.patches;
    const std::vector<std::array<int, 2>> shared = shared_corners(check.mesh, f, g);
    const bool neighbours = static_cast<int>(shared.size()) >= check.mesh.dim - 1;
    if (neighbours && folded_flat(basis, after[f], after[g], shared) &&
        !folded_flat(basis, before[f], before[g], shared))
        return PairFault::folded;
    if (neighbours && check.mesh.dim == 3) return PairFault::none;
    if (patch_contact(basis, after[f], after[g]) != Contact::crossing) return PairFault::none;
    const bool crossed_before =
        check.part[f] == check.part[g] && patch_contact(basis, before[f], before[g]) == Contact::crossing;
    return crossed_before ? PairFault::none : PairFault::crossing;
}

struct FacePair {
    int f, g;
    PairFault fault;

    auto operator<=>(const FacePair&) const = default;
};

// Two closed parts that cross give one note.
void report_pair(Check& check, const FacePair& pair, std::set<std::pair<int, int>>& noted) {
    const auto [f, g, fault] = pair;
    if (fault == PairFault::folded)
        return check.add_fault(f, "the target folds it flat onto " + face_name(check.mesh, g));
    if (check.part[f] == check.part[g])
        return check.add_fault(f, "in the target it crosses " + face_name(check.mesh, g));
    if (!noted.insert(std::minmax(check.part[f], check.part[g])).second) return;
    check.report.notes.push_back("in the target, the closed boundary made of " + check.parts[check.part[f]].boundaries +
                                 " crosses the one made of " + check.parts[check.part[g]].boundaries + ": " +
                                 face_name(check.mesh, f) + " and " + face_name(check.mesh, g));
}

void check_pairs(Check& check) {
    const int faces = check.mesh.face_count();
    std::vector<Box> boxes;
    for (const Patch& patch : check.target.patches) boxes.push_back(box_of(patch));
    const BoxTree tree(boxes);
    std::vector<std::vector<FacePair>> found(faces);  // by place in the tree, with faces behind it
    parallel_for_uneven(faces, [&](int place) {
        const int face = tree.items[place];
        if (check.bad[face]) return;
        tree.visit_overlapping(boxes[face], [&](int other) {
            if (check.bad[other]) return;
            const auto [f, g] = std::minmax(face, other);
            if (const PairFault fault = fault_of_pair(check, f, g); fault != PairFault::none)
                found[place].push_back({f, g, fault});
        }, place + 1);
    }, face_work);
    std::vector<FacePair> faults;
    for (const std::vector<FacePair>& pairs : found) faults.insert(faults.end(), pairs.begin(), pairs.end());
    std::sort(faults.begin(), faults.end());
    std::set<std::pair<int, int>> noted;
    for (const FacePair& pair : faults) report_pair(check, pair, noted);
}

struct BoundaryNode {
    int node, face;
    double size;  // of the smallest face in the target that holds it
};

std::vector<BoundaryNode> boundary_nodes(const Check& check) {
    std::vector<BoundaryNode> nodes;
    std::vector<int> place(check.mesh.nodes(), -1);
    for (int f = 0; f < check.mesh.face_count(); ++f) {
        const double size = largest_side(box_of(check.target.patches[f]));
        for (int i = 0; i < check.mesh.face_nodes(); ++i) {
            int& at = place[check.mesh.face(f)[i]];
            if (at < 0) {
                at = static_cast<int>(nodes.size());
                nodes.push_back({check.mesh.face(f)[i], f, size});
            }
            nodes[at].size = std::min(nodes[at].size, size);
        }
    }
    return nodes;
}

// Distinct nodes of one closed part that the target puts in one place.
void check_nodes(Check& check) {
    const std::vector<BoundaryNode> nodes = boundary_nodes(check);
    std::vector<Box> boxes, before;
    for (const BoundaryNode& b : nodes) {
        const std::size_t at = static_cast<std::size_t>(b.node) * check.mesh.dim;
        boxes.push_back(box_of_points(&check.target.x[at], 1, check.mesh.dim));
        before.push_back(box_of_points(&check.initial.x[at], 1, check.mesh.dim));
    }
    const BoxTree tree(boxes);
    const auto distance = [](const std::vector<Box>& points, int k, int l) {
        return std::sqrt(squared_distance(points[k], points[l].low.data(), 3));
    };
    for (int k = 0; k < static_cast<int>(nodes.size()); ++k) {
        const BoundaryNode& a = nodes[k];
        const double tolerance = same_place * a.size;
        Box around = boxes[k];
        for (int c = 0; c < check.mesh.dim; ++c) {
            around.low[c] -= tolerance;
            around.high[c] += tolerance;
        }
        tree.visit_overlapping(around, [&](int l) {
            const BoundaryNode& b = nodes[l];
            if (l <= k || check.part[a.face] != check.part[b.face] || (check.bad[a.face] && check.bad[b.face])) return;
            if (distance(boxes, k, l) > tolerance || distance(before, k, l) <= tolerance) return;
            check.add_fault(b.face, "the target puts its node " + std::to_string(check.id_of_node(b.node)) +
                                        " where node " + std::to_string(check.id_of_node(a.node)) + " is");
        });
    }
}

}  // namespace

TargetReport check_target(const Mesh& mesh, const std::vector<double>& target) {
    const PatchBasis basis(mesh.dim - 1, mesh.degree);
    const std::vector<int> part = closed_parts(mesh);
    Check check{mesh,
                basis,
                make_surface(mesh, basis, mesh.x),
                make_surface(mesh, basis, node_targets(mesh, target)),
                part,
                describe(mesh, part),
                std::vector<char>(mesh.face_count(), 0),
                {}};
    check_faces(check);
    check_closed_parts(check);
    check_pairs(check);
    check_nodes(check);
    return check.report;
}

}  // namespace almesh
