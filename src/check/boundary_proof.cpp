// The boundary by its patches, whose corners are in the order of their names: the bisections after which the tests of
// the checker hold in floating-point arithmetic by more than its errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/proof.hpp"
#include "geometry/half_space.hpp"
#include "geometry/patch.hpp"
#include "mesh/mesh.hpp"
#include "mesh/sub_simplices.hpp"

namespace almesh {
namespace {

constexpr int most_cuts = 30, most_pieces = 2000;  // one after another, of a face or a pair
constexpr int uncut = -1;

struct NamedPatch {
    std::array<long long, 3> name{};  // of the corners
    Patch patch;
};

// What may be wrong with a difference of Bezier points.
double error_of(const Patch& patch) {
    double largest = 0;
    for (const Vec<3>& x : patch)
        for (const double a : x) largest = std::max(largest, std::abs(a));
    return 1e-14 * largest;
}

class Boundary {
public:
    Boundary(const Mesh& mesh, const std::vector<double>& x)
        : mesh_(mesh), x_(x), m_(mesh.dim - 1), name_(names_of_nodes()), faces_(outer_faces()),
          degree_(mesh.degree * (has_quadrilaterals() ? 2 : 1)), basis_(m_, degree_) {
        add_patches();
    }

    void prove(Proof& proof) const {
        const int count = static_cast<int>(patches_.size());
        std::vector<std::string> lines(count);
        std::vector<char> is_missing(count, 0);
        std::vector<Box> boxes;
        for (const NamedPatch& of : patches_) {
            const double e = error_of(of.patch);
            const Box box = box_of(of.patch);
            boxes.push_back({box.low - Vec<3>{e, e, e}, box.high + Vec<3>{e, e, e}});
        }
        const BoxTree tree(boxes);
        parallel_for_uneven(count, [&](int i) {
            const auto add = [&](const std::string& line, const std::optional<std::string>& cuts) {
                if (!cuts) {
                    if (!is_missing[i]++) lines[i] = line;
                } else if (*cuts != "." && !is_missing[i]) {
                    lines[i] += line + " " + *cuts + "\n";
                }
            };
            add("face" + names(patches_[i]), cuts_of(patches_[i], nullptr));
            std::vector<int> others;
            tree.visit_overlapping({boxes[i]}, [&](int, int k) { others.push_back(tree.items[k]); });
            std::sort(others.begin(), others.end());
            for (const int j : others) {
                const NamedPatch &f = patches_[i], &g = patches_[j];
                if (!(f.name < g.name)) continue;
                const std::string both = names(f) + names(g);
                const auto cuts = cuts_of(f, &g);
                const std::string touching = cuts ? "" : touching_axis(f, g);
                if (touching.empty()) add("pair" + both, cuts);
                else add("touch" + both, touching);
            }
        }, 1e5);
        for (int i = 0; i < count; ++i) {
            if (!is_missing[i]) proof.lines += lines[i];
            else if (proof.missing.empty()) proof.missing = lines[i];
        }
    }

private:
    const Mesh& mesh_;
    const std::vector<double>& x_;
    int m_;
    std::vector<long long> name_;  // of each node: the least id of those at its place
    std::vector<int> faces_;       // but for those that are glued: with the same corners as another one
    int degree_;
    PatchBasis basis_;
    std::vector<NamedPatch> patches_;

    bool has_quadrilaterals() const {
        return std::any_of(faces_.begin(), faces_.end(), [&](int f) { return mesh_.face_vertices(f).size() == 4; });
    }
    std::string names(const NamedPatch& of) const {
        std::string text;
        for (int k = 0; k <= m_; ++k) text += concat(" ", of.name[k]);
        return text;
    }

    std::vector<long long> names_of_nodes() const {
        std::map<Vec<3>, long long> least;
        std::vector<long long> name = mesh_.file.node_id;
        const auto place = [&](int i) { return positions(mesh_, x_, &i, 1)[0]; };
        for (const int i : mesh_.faces) {
            const auto [at, is_new] = least.try_emplace(place(i), name[i]);
            at->second = std::min(at->second, name[i]);
        }
        for (const int i : mesh_.faces) name[i] = least.at(place(i));
        return name;
    }

    std::vector<int> outer_faces() const {
        std::map<std::vector<long long>, std::vector<int>> of_corners;
        for (int f = 0; f < mesh_.face_count(); ++f) {
            if (mesh_.is_inner(f)) continue;
            std::vector<long long> names;
            for (const int i : mesh_.face_vertices(f)) names.push_back(name_[i]);
            std::sort(names.begin(), names.end());
            of_corners[names].push_back(f);
        }
        std::vector<int> faces;
        for (const auto& [corners, some] : of_corners)
            if (some.size() == 1) faces.push_back(some[0]);
        std::sort(faces.begin(), faces.end());
        return faces;
    }

    void add_patches() {
        std::map<std::pair<const CellType*, CellChild>, SubSimplices> cuts;
        for (const int f : faces_)
            for (const CellChild& corner : corners_of(f)) {
                const CellType& cell = mesh_.face_cell(f);
                const auto cut = cuts.try_emplace({&cell, corner}, cell, mesh_.degree, degree_, std::vector{corner});
                NamedPatch& of = patches_.emplace_back();
                for (int k = 0; k <= m_; ++k) of.name[k] = name_[mesh_.face(f)[corner[k]]];
                const std::vector<Vec<3>> x = positions(mesh_, x_, mesh_.face(f), mesh_.face_nodes(f));
                of.patch = make_patch(basis_, cut.first->second.nodes_of(0, x));
            }
    }

    // Ascending by name. A quadrilateral is cut at the diagonal from its corner with the least name.
    std::vector<CellChild> corners_of(int f) const {
        const std::span<const int> v = mesh_.face_vertices(f);
        const auto less = [&](int i, int j) { return name_[v[i]] < name_[v[j]]; };
        std::vector<CellChild> all = {{0, 1, 2, -1}};
        if (v.size() == 4) {
            int least = 0;
            for (int i = 1; i < 4; ++i) least = less(i, least) ? i : least;
            all = {{least, (least + 1) % 4, (least + 2) % 4, -1}, {least, (least + 2) % 4, (least + 3) % 4, -1}};
        }
        for (CellChild& corner : all) std::sort(corner.begin(), corner.begin() + m_ + 1, less);
        return all;
    }

    // The cuts after which the checker sees that the patch has no point twice, or that the two have nothing in common
    // but what their names say; nothing where there are none.
    std::optional<std::string> cuts_of(const NamedPatch& f, const NamedPatch* g) const {
        std::string tree;
        int pieces = 0;
        const bool is_done = g ? divide_pair(f, *g, tree, pieces, 0) : divide(f, tree, pieces, 0);
        return is_done ? std::optional(tree) : std::nullopt;
    }

    // The direction along which the two overlap by no more than faces that touch; "": by more.
    std::string touching_axis(const NamedPatch& f, const NamedPatch& g) const {
        if (shared(f, g) > 1) return "";
        const auto [gap, axis] = widest_gap(f.patch, g.patch, m_);
        const double size = std::min(edge_length(f, longest(f)), edge_length(g, longest(g)));
        if (gap < -0.5 * touching_distance * size) return "";
        std::string words;
        for (const double a : axis) words += concat(std::llround(std::ldexp(a, 52)), ",");
        return words + concat(touching_distance);
    }

    bool divide(const NamedPatch& f, std::string& tree, int& pieces, int depth) const {
        if (is_monotone(f, nullptr)) return tree += '.', true;
        if (depth == most_cuts || ++pieces == most_pieces) return false;
        const int cut = longest(f);
        tree += concat(cut);
        const std::vector<NamedPatch> half = halves(f, cut);
        return divide(half[0], tree, pieces, depth + 1) && divide(half[1], tree, pieces, depth + 1) &&
               divide_pair(half[0], half[1], tree, pieces, depth + 1);
    }

    bool divide_pair(const NamedPatch& f, const NamedPatch& g, std::string& tree, int& pieces, int depth) const {
        if (are_apart(f, g)) return tree += '.', true;
        if (depth == most_cuts || ++pieces == most_pieces) return false;
        int cut_f = longest(f), cut_g = longest(g);
        const double longest_f = edge_length(f, cut_f), longest_g = edge_length(g, cut_g);
        const bool have_edge = m_ == 2 && shared(f, g) == 2;
        if (have_edge && edge_length(f, other_corner(f, g)) > 0.5 * std::max(longest_f, longest_g)) {
            cut_f = other_corner(f, g), cut_g = other_corner(g, f);
            tree += 'b';
        } else {
            (longest_f >= longest_g ? cut_g : cut_f) = uncut;
            tree += concat(cut_f != uncut ? cut_f : 3 + cut_g);
        }
        for (const NamedPatch& a : halves(f, cut_f))
            for (const NamedPatch& b : halves(g, cut_g))
                if (!divide_pair(a, b, tree, pieces, depth + 1)) return false;
        return true;
    }

    // Edge k is opposite corner k; of a line, the line.
    std::array<int, 2> edge(int k) const {
        return m_ == 1 ? std::array{0, 1} : std::array{k == 0 ? 1 : 0, k == 2 ? 1 : 2};
    }
    double edge_length(const NamedPatch& of, int k) const {
        return length(of.patch[edge(k)[1]] - of.patch[edge(k)[0]]);
    }
    int longest(const NamedPatch& of) const {
        int best = 0;
        for (int k = 1; k <= m_ && m_ == 2; ++k) best = edge_length(of, k) > edge_length(of, best) ? k : best;
        return best;
    }
    std::vector<NamedPatch> halves(const NamedPatch& of, int k) const {
        if (k == uncut) return {of};
        const auto [a, b] = edge(k);
        auto [near_a, near_b] = bisect(basis_.bernstein, of.patch, a, b);
        std::vector<NamedPatch> both{{of.name, std::move(near_a)}, {of.name, std::move(near_b)}};
        // Of the middle: it follows from the names of the ends, below all names in the file.
        const auto [low, high] = std::minmax(of.name[a], of.name[b]);
        const unsigned long long mixed = (static_cast<unsigned long long>(low) * 0x9e3779b97f4a7c15u +
                                          static_cast<unsigned long long>(high)) * 0xc2b2ae3d27d4eb4fu;
        both[0].name[b] = both[1].name[a] = -1 - static_cast<long long>((mixed ^ (mixed >> 31)) >> 2);
        return both;
    }
    bool has(const NamedPatch& of, long long name) const {
        return std::find(of.name.begin(), of.name.begin() + m_ + 1, name) != of.name.begin() + m_ + 1;
    }
    int shared(const NamedPatch& f, const NamedPatch& g) const {
        int count = 0;
        for (int k = 0; k <= m_; ++k) count += has(g, f.name[k]);
        return count;
    }
    int other_corner(const NamedPatch& f, const NamedPatch& g) const {
        int k = 0;
        while (has(g, f.name[k])) ++k;
        return k;
    }

    bool are_apart(const NamedPatch& f, const NamedPatch& g) const;
    bool is_monotone(const NamedPatch& f, const NamedPatch* g) const;
};

bool Boundary::are_apart(const NamedPatch& f, const NamedPatch& g) const {
    const int common = shared(f, g);
    if (common > m_) return false;
    if (common == 2) return is_monotone(f, &g);
    const double error = error_of(f.patch) + error_of(g.patch);
    if (common == 0)
        return is_half_space([&](const Vec<3>& d) { return lowest(f.patch, d) - lowest(g.patch, -1 * d); }, error);
    std::vector<Vec<3>> away;
    for (const auto& [of, other, sign] : {std::tuple(&f, &g, 1.0), std::tuple(&g, &f, -1.0)}) {
        int corner = 0;
        while (!has(*other, of->name[corner])) ++corner;
        for (int i = 0; i < static_cast<int>(of->patch.size()); ++i)
            if (i != corner) away.push_back(sign * (of->patch[i] - of->patch[corner]));
    }
    return are_in_half_space(away, error);
}

bool Boundary::is_monotone(const NamedPatch& f, const NamedPatch* g) const {
    const Bernstein& form = basis_.bernstein;
    const std::array<int, 2> ends = g ? edge(other_corner(f, *g)) : std::array{0, 1};
    const Vec<3> u = f.patch[ends[1]] - f.patch[ends[0]];
    const double infinity = std::numeric_limits<double>::infinity(), error = error_of(f.patch);
    double least_u = infinity, least_q = infinity, most_u = 0, most_q = 0, scale = 0;
    std::vector<Vec<3>> along, away, inward;  // derivatives by the edge, and from its middle to the third corner
    for (const NamedPatch* of : {&f, g}) {
        if (!of) continue;
        const auto corner = [&](int k) {
            return static_cast<int>(std::find(of->name.begin(), of->name.end(), f.name[ends[k]]) - of->name.begin());
        };
        const int a = corner(0), b = corner(1), c = 3 - a - b;
        double factor = 0;
        if (m_ == 2) {
            const Vec<3> v = of->patch[c] - of->patch[a], normal_to_u = v - dot(u, v) / dot(u, u) * u;
            factor = (of == g ? -1 : 1) / length(normal_to_u);
            inward.push_back(factor * normal_to_u);
            scale = std::max(scale, std::abs(factor));
        }
        for (int i = 0; i < form.count; ++i) {
            MultiIndex at = form.index[i];
            if (at[a]-- == 0) continue;
            const auto next = [&](int k) {
                MultiIndex moved = at;
                ++moved[k];
                return of->patch[form.place(moved)];
            };
            along.push_back(next(b) - of->patch[i]);
            if (m_ == 2) away.push_back(factor * (2 * next(c) - of->patch[i] - next(b)));
        }
    }
    for (const Vec<3>& e : along) least_u = std::min(least_u, dot(u, e));
    const double of_u = 8 * error * length(u);
    if (m_ == 1) return least_u > of_u;
    const Vec<3> q = half_space_of(inward).d;
    for (const Vec<3>& e : along) most_q = std::max(most_q, std::abs(dot(q, e)));
    for (const Vec<3>& v : away) {
        least_q = std::min(least_q, dot(q, v));
        most_u = std::max(most_u, std::abs(dot(u, v)));
    }
    const double of_q = 8 * error * length(q);
    return least_u > of_u && least_q > scale * of_q &&
           (least_u - of_u) * (least_q - scale * of_q) > 1.0001 * (most_u + scale * of_u) * (most_q + of_q);
}

}  // namespace

void prove_boundary(const Mesh& mesh, const std::vector<double>& x, Proof& proof) {
    Boundary(mesh, x).prove(proof);
}

}  // namespace almesh
