// The faces are Bezier patches, in the initial mesh and in the target.
//   folded, collapsed   n . m / |m|^2 <= 0 somewhere, m the mean of n, from the Bezier coefficients of n (patch.hpp)
//   mirrored, flattened the sum of the cones from one apex to the faces of a closed part, (1 / dim) int (x - apex) . n
//   crossing            pairs of faces whose boxes overlap, by patch_contact()
//   folded neighbours   the angle between the directions in which they leave what they share is zero
// Tolerances are relative to the size of a face or a closed part.
#include "check/target_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch_contact.hpp"

namespace almesh {
namespace {

constexpr double smallest_normal = 1e-6;  // n . m / |m|^2 at or below which a face is folded
constexpr double degenerate = 1e-12;      // measure of a face or a closed part over its size^(n - 1) or size^n
constexpr double flat_fold = 1e-6;        // radians between two neighbours folded onto each other
constexpr double same_place = 1e-9;       // distance of two nodes over the size of their smallest face
constexpr double face_work = 1000;        // simple operations that a check of one face takes

double length(const Vec<3>& v) { return std::sqrt(dot(v, v)); }

double largest_side(const Box& box) {
    return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

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
        std::copy_n(&target[k * mesh.dim], mesh.dim, point(x, mesh.faces[k], mesh.dim));
    return x;
}

std::string face_name(const Mesh& mesh, int f) {
    const Vec<3> centre = centroid(mesh, mesh.x, mesh.face(f), mesh.dim);
    std::ostringstream out;
    out << "face " << (mesh.file.face_id.empty() ? f : mesh.file.face_id[f]) << " of "
        << mesh.boundaries[mesh.face_boundary[f]] << " at (" << centre[0] << ", " << centre[1];
    if (mesh.dim == 3) out << ", " << centre[2];
    out << ')';
    return out.str();
}

// Faces that are connected by shared vertices.
struct ClosedPart {
    int first_face;
    std::vector<int> boundaries;  // in the order of their first faces
};

struct FacePair {
    int f, g;
    const char* fault;

    auto operator<=>(const FacePair&) const = default;
};

// Pairs (place in f, place in g) of the corners that two faces share.
using SharedCorners = std::vector<std::array<int, 2>>;

// Direction in which the face leaves what it shares with its neighbour: its corner i (2D), or the middle of its side
// from corner i to corner j (3D), then perpendicular to the side.
Vec<3> leaving(const Bernstein& basis, const Patch& patch, int i, int j) {
    if (basis.dim == 1) return side_tangent(basis, patch, i, 1 - i);
    const int a = std::min(i, j), b = std::max(i, j);
    const Patch half = bisect(basis, patch, a, b).first;  // the middle is its corner b
    const Vec<3> side = side_tangent(basis, half, b, a), inward = side_tangent(basis, half, b, 3 - a - b);
    return inward - (dot(inward, side) / dot(side, side)) * side;
}

bool folded_flat(const Bernstein& basis, const Patch& f, const Patch& g, const SharedCorners& shared) {
    for (std::size_t k = 0; k + basis.dim <= shared.size(); ++k) {
        const auto &i = shared[k], &j = shared[k + basis.dim - 1];
        const Vec<3> u = leaving(basis, f, i[0], j[0]), v = leaving(basis, g, i[1], j[1]);
        if (std::atan2(length(cross(u, v)), dot(u, v)) < flat_fold) return true;
    }
    return false;
}

// What the checks below share.
struct Check {
    const Mesh& mesh;
    PatchBasis basis;
    PatchNormal normal;
    Surface initial, target;
    std::vector<const char*> bad;   // per face: what is wrong with it alone; later checks pass over such faces
    std::vector<ClosedPart> parts;
    std::vector<int> part;          // per face
    TargetReport report;

    void add_fault(int f, const std::string& what) { report.faults.push_back({f, face_name(mesh, f) + ": " + what}); }
    std::string id_of_node(int i) const { return std::to_string(mesh.file.node_id.empty() ? i : mesh.file.node_id[i]); }
    std::string boundaries_of(int k) const;  // their names
};

std::string Check::boundaries_of(int k) const {
    std::string names;
    for (int boundary : parts[k].boundaries) names += (names.empty() ? "" : ", ") + mesh.boundaries[boundary];
    return names;
}

// By union-find over the vertices.
void find_closed_parts(Check& check) {
    const Mesh& mesh = check.mesh;
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
    std::map<int, int> number;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const auto [at, is_new] = number.insert({root(mesh.face(f)[0]), static_cast<int>(check.parts.size())});
        if (is_new) check.parts.push_back({f, {}});
        check.part.push_back(at->second);
        std::vector<int>& boundaries = check.parts[at->second].boundaries;
        const int boundary = mesh.face_boundary[f];
        if (std::find(boundaries.begin(), boundaries.end(), boundary) == boundaries.end())
            boundaries.push_back(boundary);
    }
}

const char* fault_of_face(const Check& check, const Patch& patch) {
    const std::vector<Vec<3>> n = check.normal.coefficients(patch);
    Vec<3> mean{};  // the mean of a polynomial is that of its Bezier coefficients
    for (const Vec<3>& v : n) mean = mean + (1.0 / n.size()) * v;
    if (!(length(mean) > degenerate * std::pow(largest_side(box_of(patch)), check.mesh.dim - 1)))
        return "the target collapses the face to nothing";
    std::vector<double> along;
    for (const Vec<3>& v : n) along.push_back(dot(v, mean) / dot(mean, mean));
    const double least = polynomial_minimum(check.normal.basis(), along.data(), 0.01, 500).upper;
    return least <= smallest_normal ? "the target folds the face back on itself" : nullptr;
}

void check_faces(Check& check) {
    const int count = check.mesh.face_count();
    parallel_for(count, [&](int f) { check.bad[f] = fault_of_face(check, check.target.patches[f]); }, face_work);
    for (int f = 0; f < count; ++f)
        if (check.bad[f]) check.add_fault(f, check.bad[f]);
}

// Area or volume enclosed by each closed part, positive where the domain is inside it. Relative to the part's first
// node, so that small parts far from the origin keep their digits.
std::vector<double> enclosed(const Check& check, const Surface& surface) {
    std::vector<double> cone(check.mesh.face_count()), sum(check.parts.size(), 0.0);
    parallel_for(check.mesh.face_count(), [&](int f) {
        cone[f] = check.normal.cone(surface.patches[f], surface.patches[check.parts[check.part[f]].first_face][0]);
    }, face_work);
    for (int f = 0; f < check.mesh.face_count(); ++f) sum[check.part[f]] += cone[f];
    return sum;
}

void check_closed_parts(Check& check) {
    const int dim = check.mesh.dim;
    const std::vector<Patch>& patches = check.target.patches;
    const std::vector<double> before = enclosed(check, check.initial), after = enclosed(check, check.target);
    std::vector<double> size(check.parts.size(), 0.0);
    for (int f = 0; f < check.mesh.face_count(); ++f) {
        const int k = check.part[f];
        size[k] = std::max(size[k], length(patches[f][0] - patches[check.parts[k].first_face][0]));
    }
    for (int k = 0; k < static_cast<int>(check.parts.size()); ++k) {
        const bool flat = std::abs(after[k]) <= degenerate * std::pow(size[k], dim);
        if (!flat && (before[k] > 0) == (after[k] > 0)) continue;
        std::ostringstream what;
        what << "the target " << (flat ? "flattens" : "mirrors or turns inside out") << " the closed boundary made of "
             << check.boundaries_of(k) << " (signed " << (dim == 2 ? "area " : "volume ") << before[k] << " becomes "
             << after[k] << ')';
        check.add_fault(check.parts[k].first_face, what.str());
    }
}

SharedCorners shared_corners(const Mesh& mesh, int f, int g) {
    SharedCorners shared;
    for (int i = 0; i < mesh.dim; ++i)
        for (int j = 0; j < mesh.dim; ++j)
            if (mesh.face(f)[i] == mesh.face(g)[j]) shared.push_back({i, j});
    return shared;
}

// Of two faces that come close in the target and are not bad themselves; null for none. In 3D, neighbours are not
// tested for crossing: they touch along a curve, which no bisection decides. Faces that cross in the initial mesh
// already are not a fault, within one closed part.
const char* fault_of_pair(const Check& check, int f, int g) {
    const Bernstein& basis = check.basis.bernstein;
    const std::vector<Patch>&before = check.initial.patches, &after = check.target.patches;
    const SharedCorners shared = shared_corners(check.mesh, f, g);
    const bool neighbours = static_cast<int>(shared.size()) >= check.mesh.dim - 1;
    if (neighbours && folded_flat(basis, after[f], after[g], shared) &&
        !folded_flat(basis, before[f], before[g], shared))
        return "the target folds it flat onto ";
    if (neighbours && check.mesh.dim == 3) return nullptr;
    if (patch_contact(basis, after[f], after[g]) != Contact::crossing) return nullptr;
    const bool same_part = check.part[f] == check.part[g];
    if (same_part && patch_contact(basis, before[f], before[g]) == Contact::crossing) return nullptr;
    return "in the target it crosses ";
}

// Closed parts that cross each other give one note per pair of them.
void check_pairs(Check& check) {
    const Mesh& mesh = check.mesh;
    std::vector<Box> boxes;
    for (const Patch& patch : check.target.patches) boxes.push_back(box_of(patch));
    const BoxTree tree(boxes);
    std::vector<std::vector<FacePair>> found(mesh.face_count());  // by place in the tree, with faces behind it
    parallel_for_uneven(mesh.face_count(), [&](int place) {
        const int face = tree.items[place];
        if (check.bad[face]) return;
        tree.visit_overlapping(boxes[face], [&](int other) {
            if (check.bad[other]) return;
            const auto [f, g] = std::minmax(face, other);
            if (const char* const fault = fault_of_pair(check, f, g)) found[place].push_back({f, g, fault});
        }, place + 1);
    }, face_work);
    std::vector<FacePair> faults;
    for (const std::vector<FacePair>& pairs : found) faults.insert(faults.end(), pairs.begin(), pairs.end());
    std::sort(faults.begin(), faults.end());
    std::set<std::pair<int, int>> noted;
    for (const auto& [f, g, fault] : faults) {
        const int k = check.part[f], l = check.part[g];
        if (k == l) check.add_fault(f, fault + face_name(mesh, g));
        else if (noted.insert(std::minmax(k, l)).second)
            check.report.notes.push_back("in the target, the closed boundary made of " + check.boundaries_of(k) +
                                         " crosses the one made of " + check.boundaries_of(l) + ": " +
                                         face_name(mesh, f) + " and " + face_name(mesh, g));
    }
}

// Distinct nodes of one closed part that the target puts in one place.
void check_nodes(Check& check) {
    const Mesh& mesh = check.mesh;
    std::vector<int> nodes, first_face(mesh.nodes(), -1);
    std::vector<double> size(mesh.nodes(), std::numeric_limits<double>::max());  // of its smallest face in the target
    for (int f = 0; f < mesh.face_count(); ++f) {
        const double face_size = largest_side(box_of(check.target.patches[f]));
        for (int k = 0; k < mesh.face_nodes(); ++k) {
            const int i = mesh.face(f)[k];
            size[i] = std::min(size[i], face_size);
            if (first_face[i] >= 0) continue;
            first_face[i] = f;
            nodes.push_back(i);
        }
    }
    std::vector<Box> boxes, before;
    for (int i : nodes) {
        boxes.push_back(box_of_points(point(check.target.x, i, mesh.dim), 1, mesh.dim));
        before.push_back(box_of_points(point(check.initial.x, i, mesh.dim), 1, mesh.dim));
    }
    const BoxTree tree(boxes);
    const auto distance = [](const Box& a, const Box& b) { return std::sqrt(squared_distance(a, b.low.data(), 3)); };
    for (int k = 0; k < static_cast<int>(nodes.size()); ++k) {
        const int i = nodes[k], f = first_face[i];
        const double tolerance = same_place * size[i];
        Box around = boxes[k];
        for (int a = 0; a < mesh.dim; ++a) {
            around.low[a] -= tolerance;
            around.high[a] += tolerance;
        }
        tree.visit_overlapping(around, [&](int l) {
            const int j = nodes[l], g = first_face[j];
            if (l <= k || check.part[f] != check.part[g] || (check.bad[f] && check.bad[g])) return;
            if (distance(boxes[k], boxes[l]) > tolerance || distance(before[k], before[l]) <= tolerance) return;
            check.add_fault(g, "the target puts its node " + check.id_of_node(j) + " where node " +
                                   check.id_of_node(i) + " is");
        });
    }
}

}  // namespace

TargetReport check_target(const Mesh& mesh, const std::vector<double>& target) {
    const PatchBasis basis(mesh.dim - 1, mesh.degree);
    Check check{mesh,
                basis,
                PatchNormal(mesh.dim, mesh.degree),
                make_surface(mesh, basis, mesh.x),
                make_surface(mesh, basis, node_targets(mesh, target)),
                std::vector<const char*>(mesh.face_count(), nullptr),
                {},
                {},
                {}};
    find_closed_parts(check);
    check_faces(check);
    check_closed_parts(check);
    check_pairs(check);
    check_nodes(check);
    return check.report;
}

}  // namespace almesh
