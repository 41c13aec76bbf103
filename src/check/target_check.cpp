// The faces are Bezier patches, in the initial mesh and in the target; of a quadrilateral two.
//   folded, collapsed   n . m / |m|^2 <= 0 somewhere, m the mean of n, from the Bezier coefficients of n (patch.hpp)
//   mirrored, flattened the sum of the cones from one apex to the faces of a closed part, (1 / dim) int (x - apex) . n
//   crossing            pairs of faces whose boxes overlap, by patch_contact()
//   into or out of      the winding number of one closed part about a node of another, in turns
//   folded neighbours   the angle between the directions in which they leave what they share is zero
// Tolerances are relative to the size of a face or a closed part. Nodes at one place are one node where neighbours are
// looked for, and faces that are glued are passed over: they are inside the mesh.
#include "check/target_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "base/disjoint_sets.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"
#include "geometry/half_space.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

constexpr double smallest_normal = 1e-6;  // n . m / |m|^2 at or below which a face is folded
constexpr double degenerate = 1e-12;      // measure of a face or a closed part over its size^(n - 1) or size^n
constexpr double same_place = touching_distance;  // of two nodes, over the size of their smallest face
constexpr double face_work = 1000;        // simple operations that a check of one face takes

double size_of(const Box& box) { return (box.high - box.low)[box.longest_side()]; }

std::string name_of(const Mesh& mesh, int f) {
    const Vec<3> centre = centroid(mesh, mesh.x, mesh.face(f), mesh.face_cell(f).vertices);
    return concat(face_name(mesh, f), " at ", position_text(centre.data(), mesh.dim));
}

// Faces that are connected by shared vertices, outer ones or inner ones.
struct ClosedPart {
    int first_face;
    bool is_inner;  // not closed
    std::string boundaries;  // their names, in the order of their first faces
    bool is_in_contact = false;  // as Mesh::contact says
};

// Whether the flat patches with the same corners are ones.
bool have_corners_apart(std::span<const Patch> patches, int m) {
    return std::all_of(patches.begin(), patches.end(), [m](const Patch& patch) {
        return length(flat_normal(patch, m)) > degenerate * std::pow(size_of(box_of(patch)), m);
    });
}

constexpr char not_told[] = "";  // what is wrong with a face whose position is open
constexpr char crossed_before[] = "", touching[] = "";

struct FaultOfPair {
    int f, g;  // f < g
    const char* what;
};

class Check {
public:
    // open: per face.
    Check(const Mesh& mesh_, const std::vector<double>& target_, const std::vector<char>& open_, FaceBend bend_)
        : mesh(mesh_), target(target_), faces(mesh), overlaps(mesh), normal(mesh.dim - 1, basis.bernstein.degree),
          before(faces.count()), after(before), bad(mesh.face_count(), nullptr), open(open_), bend(bend_) {
        open.resize(mesh.face_count(), 0);
        parallel_for(mesh.face_count(), [&](int f) {
            std::vector<Patch> was = faces.of(f, mesh.x), becomes = faces.of(f, target);
            std::move(was.begin(), was.end(), before.begin() + faces.first[f]);
            std::move(becomes.begin(), becomes.end(), after.begin() + faces.first[f]);
        }, face_work);
        find_closed_parts();
    }

    TargetReport run() {
        check_faces();
        find_places();
        glue();
        check_closed_parts();
        check_pairs();
        if (bend == FaceBend::of_valid) return std::move(report);
        check_nesting();
        check_nodes();
        return std::move(report);
    }

private:
    const Mesh& mesh;
    const std::vector<double>& target;  // node_count x dim; only boundary nodes are meaningful
    FacePatches faces;
    const PatchBasis& basis = faces.basis;
    const Overlaps overlaps;
    PatchNormal normal;
    std::vector<Patch> before, after;   // of the faces: in the initial mesh and in the target
    std::vector<const char*> bad;       // per face: what is wrong with it alone; later checks pass over such faces
    std::vector<ClosedPart> parts;
    std::vector<int> part;              // per face
    std::set<std::pair<int, int>> crossing;  // parts, found by check_pairs()
    std::vector<char> open, open_part;  // per face, per part
    struct Together {
        int node, other, face, of_other;
        bool is_new;  // apart in the initial mesh
    };
    std::vector<Together> together;  // distinct nodes at the same place in the target
    const FaceBend bend;
    TargetReport report;

    bool may_overlap(int k, int l) const {  // parts
        return overlaps.faces(parts[k].first_face, parts[l].first_face) ||
               (parts[k].is_in_contact && parts[l].is_in_contact);
    }
    // Vertices of the two at the same places.
    int shared_vertices(int f, int g) const {
        const std::span<const int> a = mesh.face_vertices(f), b = mesh.face_vertices(g);
        return static_cast<int>(std::count_if(a.begin(), a.end(), [&](int i) {
            return std::any_of(b.begin(), b.end(), [&](int j) { return report.place[i] == report.place[j]; });
        }));
    }
    std::span<const Patch> patches_of(const std::vector<Patch>& patches, int f) const {
        return std::span(patches).subspan(faces.first[f], faces.cut(f).count());
    }
    Vec<3> corner(const std::vector<double>& x, int f, int i) const {
        Vec<3> at{};
        std::copy_n(point(x, mesh.face(f)[i], mesh.dim), mesh.dim, at.begin());
        return at;
    }
    void add_fault(int f, const std::string& what) {
        report.faults.push_back({f, name_of(mesh, f) + ": " + what, false});
    }

    void find_closed_parts() {
        const int of_inner = mesh.inner.empty() ? 0 : mesh.nodes();  // their vertices are numbered behind all others
        const auto vertex = [&](int f, int v) { return mesh.face(f)[v] + (mesh.is_inner(f) ? of_inner : 0); };
        DisjointSets connected(mesh.nodes() + of_inner);
        for (int f = 0; f < mesh.face_count(); ++f)
            for (int v = 1; v < mesh.face_cell(f).vertices; ++v) connected.join(vertex(f, 0), vertex(f, v));
        std::map<int, int> number;
        std::set<std::pair<int, int>> named;  // parts and their boundaries
        for (int f = 0; f < mesh.face_count(); ++f) {
            const auto [at, is_new] = number.insert({connected.find(vertex(f, 0)), static_cast<int>(parts.size())});
            if (is_new) parts.push_back({f, mesh.is_inner(f), ""});
            part.push_back(at->second);
            if (contact_of(mesh, f)) parts[part[f]].is_in_contact = true;
            open_part.resize(parts.size(), 0);
            if (open[f]) open_part[part[f]] = 1;
            if (named.insert({part[f], mesh.face_boundary[f]}).second)
                parts[part[f]].boundaries += (is_new ? "" : ", ") + mesh.boundaries[mesh.face_boundary[f]];
        }
    }

    const char* fault_of_face(std::span<const Patch> patches) const {
        std::vector<Vec<3>> n;
        Box box = box_of(patches[0]);
        for (const Patch& patch : patches) {
            const std::vector<Vec<3>> of_patch = normal.coefficients(patch);
            n.insert(n.end(), of_patch.begin(), of_patch.end());
            box.include(box_of(patch));
        }
        Vec<3> mean{};  // the mean of a polynomial is that of its Bezier coefficients
        for (const Vec<3>& v : n) mean = mean + (1.0 / n.size()) * v;
        if (!(length(mean) > degenerate * std::pow(size_of(box), normal.basis.dim)))
            return "the target collapses the face";
        std::vector<double> along;
        for (const Vec<3>& v : n) along.push_back(dot(v, mean) / dot(mean, mean));
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < along.size(); k += normal.basis.count)
            least = std::min(least, polynomial_minimum(normal.basis, &along[k], 0.01, 500).upper);
        for (Vec<3>& v : n) v = unit(v);
        const bool bends_far = bend != FaceBend::usual && are_in_half_space(n, smallest_normal);
        return least > smallest_normal || bends_far ? nullptr : "the target folds the face back on itself";
    }

    void check_faces() {
        parallel_for(mesh.face_count(), [&](int f) {
            bad[f] = open[f] ? not_told : fault_of_face(patches_of(after, f));
        }, face_work);
        for (int f = 0; f < mesh.face_count(); ++f)
            if (bad[f] && !open[f]) {
                add_fault(f, bad[f]);
                report.faults.back().by_curvature = have_corners_apart(patches_of(after, f), mesh.dim - 1);
            }
    }

    // Area or volume enclosed by each closed part, positive where the domain is inside it. Relative to the part's first
    // node, so that small parts far from the origin keep their digits.
    std::vector<double> enclosed(const std::vector<Patch>& patches) const {
        std::vector<double> cone(mesh.face_count()), sum(parts.size(), 0.0);
        parallel_for(mesh.face_count(), [&](int f) {
            for (const Patch& patch : patches_of(patches, f))
                cone[f] += normal.cone(patch, patches[faces.first[parts[part[f]].first_face]][0]);
        }, face_work);
        for (int f = 0; f < mesh.face_count(); ++f) sum[part[f]] += cone[f];
        return sum;
    }

    void check_closed_parts() {
        const std::vector<double> was = enclosed(before), becomes = enclosed(after);
        std::vector<double> size(parts.size(), 0.0);
        for (int f = 0; f < mesh.face_count(); ++f)
            size[part[f]] =
                std::max(size[part[f]], length(corner(target, f, 0) - corner(target, parts[part[f]].first_face, 0)));
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (open_part[k] || parts[k].is_inner) continue;
            const bool flat = std::abs(becomes[k]) <= degenerate * std::pow(size[k], mesh.dim);
            if (!flat && (was[k] > 0) == (becomes[k] > 0)) continue;
            std::string what = concat("the target ", flat ? "flattens" : "mirrors or turns inside out",
                                      " the closed boundary made of ", parts[k].boundaries, " (signed ",
                                      mesh.dim == 2 ? "area " : "volume ");
            append(what, was[k], 6);
            append(what += " becomes ", becomes[k], 6);
            add_fault(parts[k].first_face, what + ")");
        }
    }

    // Of patches of two faces that come close in the target and are not bad themselves; null for none, crossed_before
    // where they cross in the initial mesh already. In 3D, neighbours are not tested for crossing: they touch along a
    // curve, which no bisection decides.
    const char* fault_of_pair(int f, int g) const {
        const Bernstein& bernstein = basis.bernstein;
        const int shared = shared_vertices(faces.face[f], faces.face[g]);
        const bool neighbours = shared >= mesh.dim - 1;
        if (neighbours && fold_of(faces, after, f, g, report.place).is_flat()) {
            const Fold was = fold_of(faces, before, f, g, {});
            const bool closes = was.is_in_front || was.angle == Fold().angle;
            if (bend == FaceBend::of_valid || (closes && !was.is_flat())) return touching;
            return was.is_flat() ? crossed_before : "the target folds it flat onto ";
        }
        const auto contact = [&](const std::vector<Patch>& of) {
            return patch_contact(bernstein, of[f], of[g], contact_tolerance(of[f], of[g], mesh.rounding), shared > 0);
        };
        const Contact found = neighbours && mesh.dim == 3 ? Contact::apart : contact(after);
        if (found == Contact::crossing)
            return contact(before) == Contact::crossing ? crossed_before : "in the target it crosses ";
        return (shared > 0 ? have_opposite_normals(f, g) : found != Contact::apart) ? touching : nullptr;
    }

    // At a corner that two patches share.
    bool have_opposite_normals(int f, int g) const {
        const int m = basis.bernstein.dim;
        if (!(dot(flat_normal(after[f], m), flat_normal(after[g], m)) < 0)) return false;
        const std::vector<Vec<3>> of_f = normal.coefficients(after[f]), of_g = normal.coefficients(after[g]);
        for (int i = 0; i <= m; ++i)
            for (int j = 0; j <= m; ++j) {
                if (report.place[faces.corner(f, i)] != report.place[faces.corner(g, j)]) continue;
                const Vec<3> u = unit(of_f[of_f.size() == 1 ? 0 : i]), v = unit(of_g[of_g.size() == 1 ? 0 : j]);
                if (dot(u, v) < 0 && length(cross(u, v)) < flat_fold) return true;
            }
        return false;
    }

    // Closed parts that cross each other give one fault per pair of them.
    void check_pairs() {
        std::vector<Box> boxes;
        for (const Patch& patch : after) boxes.push_back(box_of(patch));
        const BoxTree tree(std::move(boxes));
        constexpr int at_once = 256;  // faces that are beside each other in the tree
        std::vector<std::vector<FaultOfPair>> found((faces.count() + at_once - 1) / at_once);
        parallel_for_uneven(static_cast<int>(found.size()), [&](int block) {
            const int first = block * at_once, end = std::min(first + at_once, faces.count());
            std::vector<Box> queries;
            for (int k = first; k < end; ++k) queries.push_back(tree.boxes[tree.items[k]]);
            tree.visit_overlapping(queries, [&](int q, int k) {
                const auto [a, b] = std::minmax(tree.items[first + q], tree.items[k]);
                const int f = faces.face[a], g = faces.face[b];
                if (k <= first + q || f == g || bad[f] || bad[g] || report.glued[f] || report.glued[g]) return;
                if (overlaps.faces(f, g)) return;
                if (const char* const what = fault_of_pair(a, b)) found[block].push_back({f, g, what});
            }, first);
        }, at_once * face_work);
        std::vector<FaultOfPair> faults;
        for (const std::vector<FaultOfPair>& some : found) faults.insert(faults.end(), some.begin(), some.end());
        const auto key = [](const FaultOfPair& of) { return std::tuple(of.f, of.g, of.what == touching); };
        std::stable_sort(faults.begin(), faults.end(),
                         [&](const FaultOfPair& a, const FaultOfPair& b) { return key(a) < key(b); });
        const auto same = [](const FaultOfPair& a, const FaultOfPair& b) { return a.f == b.f && a.g == b.g; };
        faults.erase(std::unique(faults.begin(), faults.end(), same), faults.end());  // of several patches
        std::set<std::pair<int, int>> named;
        for (const auto& [f, g, what] : faults) {
            if (what == touching) {
                report.touching.push_back({f, g});
                continue;
            }
            if (what == crossed_before) {
                if (report.crossed_before[0] < 0) report.crossed_before = {f, g};
                continue;
            }
            report.crossing.push_back({f, g});
            if (part[f] == part[g]) add_fault(f, what + name_of(mesh, g));
            else if (named.insert(std::minmax(part[f], part[g])).second)
                add_fault(f, concat(what, name_of(mesh, g), ": the ", parts[part[f]].is_inner ? "inner" : "closed",
                                    " boundary made of ", parts[part[f]].boundaries, " goes through the one made of ",
                                    parts[part[g]].boundaries));
        }
        crossing = std::move(named);
    }

    // Corners of its faces in which the closed part reaches farthest in the target, in each direction of each axis:
    // (face, corner).
    std::vector<std::array<int, 2>> farthest_corners(int of_part) const {
        const auto coordinate = [&](std::array<int, 2> at, int axis) { return corner(target, at[0], at[1])[axis]; };
        std::vector<std::array<int, 2>> farthest(2 * mesh.dim, {parts[of_part].first_face, 0});
        for (int f = 0; f < mesh.face_count(); ++f)
            for (int i = 0; i < mesh.face_cell(f).vertices && part[f] == of_part; ++i)
                for (int axis = 0; axis < mesh.dim; ++axis) {
                    std::array<int, 2>&least = farthest[2 * axis], &most = farthest[2 * axis + 1];
                    if (coordinate({f, i}, axis) < coordinate(least, axis)) least = {f, i};
                    if (coordinate({f, i}, axis) > coordinate(most, axis)) most = {f, i};
                }
        return farthest;
    }

    // For pairs of parts that are not known to cross: one that was inside the other must stay inside. A corner so near
    // to the other part that its winding number is no integer tells nothing.
    void check_nesting() {
        const int count = static_cast<int>(parts.size());
        const auto is_inside = [](double turns) { return std::abs(turns) > 0.5; };
        const auto is_clear = [](double turns) { return std::abs(turns - std::round(turns)) < 0.25; };
        struct Probe {
            int of_part, face, corner;
        };
        // Around each part: corners of others, in the initial mesh and in the target.
        std::vector<std::vector<Probe>> probes(count);
        for (int k = 0; k < count; ++k)
            for (const auto [f, i] : farthest_corners(k))
                for (int l = 0; l < count; ++l)
                    if (k != l && !open_part[k] && !open_part[l] && !parts[l].is_inner &&
                        !crossing.contains(std::minmax(k, l)) && !may_overlap(k, l))
                        probes[l].push_back({k, f, i});
        std::vector<std::vector<double>> turns(2 * count);
        const auto patches_around = [&](int l, const std::vector<Patch>& patches) {
            std::vector<Patch> around;
            for (int f = 0; f < mesh.face_count(); ++f)
                if (part[f] == l)
                    for (const Patch& patch : patches_of(patches, f)) around.push_back(patch);
            return around;
        };
        parallel_for_uneven(2 * count, [&](int task) {
            if (probes[task / 2].empty()) return;
            std::vector<Vec<3>> points;
            for (const Probe& probe : probes[task / 2])
                points.push_back(corner(task % 2 == 0 ? mesh.x : target, probe.face, probe.corner));
            turns[task] = windings(basis.bernstein, patches_around(task / 2, task % 2 == 0 ? before : after), points);
        }, face_work * mesh.face_count());
        // No corner that touches the part is in it or outside.
        const auto is_off = [&](int l, const Probe& probe, const std::vector<double>& x,
                                const std::vector<Patch>& patches) {
            const Vec<3> at = corner(x, probe.face, probe.corner);
            const double size = size_of(box_of(patches[faces.first[probe.face]]));
            const double distance = ClosestPoint(basis, patches_around(l, patches)).find(at).distance;
            return distance > same_place * size + mesh.rounding;
        };
        std::set<std::pair<int, int>> moved;
        for (int l = 0; l < count; ++l)
            for (std::size_t i = 0; i < probes[l].size(); ++i) {
                const double was = turns[2 * l][i], becomes = turns[2 * l + 1][i];
                const Probe& probe = probes[l][i];
                if (is_clear(was) && is_clear(becomes) && is_inside(was) != is_inside(becomes) &&
                    !moved.contains({probe.of_part, l}) && is_off(l, probe, mesh.x, before) &&
                    is_off(l, probe, target, after))
                    moved.insert({probe.of_part, l});
            }
        for (const auto& [k, l] : moved)
            add_fault(parts[k].first_face,
                      concat("the target takes the ", parts[k].is_inner ? "inner" : "closed", " boundary made of ",
                             parts[k].boundaries,
                             " through the one made of ", parts[l].boundaries));
    }

    // Distinct nodes that the target puts at one point.
    void find_places() {
        std::vector<int> nodes, first_face(mesh.nodes(), -1);
        // Of its smallest face in the target.
        std::vector<double> size(mesh.nodes(), std::numeric_limits<double>::max());
        for (int f = 0; f < mesh.face_count(); ++f) {
            Box box = box_of(after[faces.first[f]]);
            for (const Patch& patch : patches_of(after, f)) box.include(box_of(patch));
            const double face_size = size_of(box);
            for (int k = 0; k < mesh.face_nodes(f); ++k) {
                const int i = mesh.face(f)[k];
                size[i] = std::min(size[i], face_size);
                if (first_face[i] >= 0 || open[f]) continue;
                first_face[i] = f;
                nodes.push_back(i);
            }
        }
        const int count = static_cast<int>(nodes.size());
        const std::vector<Vec<3>> was = positions(mesh, mesh.x, nodes.data(), count);
        const std::vector<Vec<3>> becomes = positions(mesh, target, nodes.data(), count);
        const auto tolerance = [&](int k) { return same_place * size[nodes[k]] + mesh.rounding; };
        std::vector<Box> boxes, queries;
        for (int k = 0; k < count; ++k) {
            const Vec<3> reach = {tolerance(k), tolerance(k), tolerance(k)};
            boxes.push_back({becomes[k], becomes[k]});
            queries.push_back({becomes[k] - reach, becomes[k] + reach});
        }
        const BoxTree tree(std::move(boxes));
        tree.visit_overlapping(queries, [&](int k, int item) {
            const int l = tree.items[item];
            const int f = first_face[nodes[k]], g = first_face[nodes[l]];
            if (l <= k || overlaps.faces(f, g) || length(becomes[k] - becomes[l]) > tolerance(k)) return;
            together.push_back({nodes[k], nodes[l], f, g, length(was[k] - was[l]) > tolerance(k)});
        });
        std::stable_sort(together.begin(), together.end(),
                         [](const Together& a, const Together& b) { return a.node < b.node; });
        DisjointSets places(mesh.nodes());
        for (const Together& pair : together) places.join(pair.node, pair.other);
        report.place.resize(mesh.nodes());
        for (int i = 0; i < mesh.nodes(); ++i) report.place[i] = places.find(i);
    }

    // Faces with the same nodes' places and opposite normals.
    void glue() {
        report.glued.resize(mesh.face_count());
        std::vector<char> is_double(mesh.nodes());
        for (const Together& pair : together) is_double[pair.node] = is_double[pair.other] = 1;
        std::map<std::vector<int>, std::vector<int>> equal;
        for (int f = 0; f < mesh.face_count(); ++f) {
            const std::span nodes(mesh.face(f), mesh.face_nodes(f));
            const bool has_double = std::any_of(nodes.begin(), nodes.end(), [&](int i) { return is_double[i]; });
            if (bad[f] || mesh.is_inner(f) || !has_double) continue;
            std::vector<int> places;
            for (const int i : nodes) places.push_back(report.place[i]);
            std::sort(places.begin(), places.end());
            equal[places].push_back(f);
        }
        for (const auto& [places, two] : equal)
            if (two.size() == 2 && dot(unit_normal(mesh, target, two[0]), unit_normal(mesh, target, two[1])) < 0)
                report.glued[two[0]] = report.glued[two[1]] = 1;
    }

    // Nodes that come together are a fault where each was behind all faces at the other: what was between is inside.
    void check_nodes() {
        if (together.empty()) return;
        std::vector<std::vector<int>> faces_at(mesh.nodes());
        for_face_nodes(mesh, [&](int f, std::size_t k) { faces_at[mesh.faces[k]].push_back(f); });
        const auto is_behind = [&](int i, int j) {
            const Vec<3> way = unit(positions(mesh, mesh.x, &j, 1)[0] - positions(mesh, mesh.x, &i, 1)[0]);
            return std::all_of(faces_at[i].begin(), faces_at[i].end(),
                               [&](int f) { return dot(way, unit_normal(mesh, f)) < -1e-6; });
        };
        for (const auto& [i, j, f, g, is_new] : together) {
            if (!is_new || (bad[f] && bad[g]) || !is_behind(i, j) || !is_behind(j, i)) continue;
            add_fault(g, concat("the target puts its node ", id_in_file(mesh.file.node_id, j), " where node ",
                                id_in_file(mesh.file.node_id, i), " is, at ",
                                position_text(point(target, i, mesh.dim), mesh.dim)));
        }
    }
};

}  // namespace

Overlaps::Overlaps(const Mesh& mesh) : mesh_(mesh) {
    if (mesh.contact.empty()) return;
    of_node_.resize(mesh.nodes());
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (contact_of(mesh, f)) of_node_[mesh.faces[k]] = {contact_of(mesh, f), mesh.face_boundary[f]};
    });
}

bool Overlaps::may(int e, std::span<const int> vertices, int other, std::span<const int> of_other) const {
    if (mesh_.file.zone(e) != mesh_.file.zone(other)) return true;
    for (const int i : vertices)
        for (const int j : of_other) {
            if (of_node_.empty()) return false;
            const auto [contact, boundary] = of_node_[i];
            if (contact != 0 && contact == of_node_[j][0] && (contact < 0 || boundary != of_node_[j][1])) return true;
        }
    return false;
}

bool Overlaps::elements(int e, int other) const {
    return may(e, {mesh_.element(e), std::size_t(mesh_.cell(e).vertices)}, other,
               {mesh_.element(other), std::size_t(mesh_.cell(other).vertices)});
}

bool Overlaps::faces(int f, int g) const {
    return may(mesh_.face_element[f], mesh_.face_vertices(f), mesh_.face_element[g], mesh_.face_vertices(g));
}

TargetReport check_target(const Mesh& mesh, const std::vector<double>& target, const std::vector<char>& open,
                          FaceBend bend) {
    return Check(mesh, target, open, bend).run();
}

}  // namespace almesh
