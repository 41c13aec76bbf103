// Separating axes (Gottschalk, Lin, Manocha, SIGGRAPH 1996) of the flat patches with the same corners are tried on all
// Bezier points, whose hulls enclose the patches: a gap along one of them proves the patches apart. Where the flat
// patches penetrate each other by more than the curved ones deviate from them, the curved ones cross. Pairs with
// neither proof are bisected.
#include <algorithm>
#include <limits>

#include "geometry/patch.hpp"

namespace almesh {
namespace {

constexpr int pairs_of_faces = 4000, pairs_of_solids = 1000;  // that are tested at most

Vec<3> centre(const Patch& patch, int corners) {
    Vec<3> sum{};
    for (int v = 0; v < corners; ++v) sum = sum + (1.0 / corners) * patch[v];
    return sum;
}

using Axes = std::vector<Vec<3>>;

// Directions among which there is a separating one if the flat patches do not cross.
void face_axes(const Patch& a, const Patch& b, int m, Axes& axes) {
    axes.push_back(centre(b, m + 1) - centre(a, m + 1));
    if (m == 1) {
        for (const Vec<3>& side : {a[1] - a[0], b[1] - b[0]}) axes.insert(axes.end(), {side, {side[1], -side[0], 0}});
        return;
    }
    const Vec<3> sides_a[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]}, normal_a = cross(sides_a[0], sides_a[1]);
    const Vec<3> sides_b[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]}, normal_b = cross(sides_b[0], sides_b[1]);
    axes.insert(axes.end(), {normal_a, normal_b});
    for (int k = 0; k < 3; ++k) {
        axes.insert(axes.end(), {cross(normal_a, sides_a[k]), cross(normal_b, sides_b[k])});
        for (const Vec<3>& side : sides_b) axes.push_back(cross(sides_a[k], side));
    }
}

// The same of elements: normals of their sides, and of planes along an edge of each.
void solid_axes(const Solid& a, const Patch& s, const Solid& b, const Patch& t, Axes& axes) {
    std::vector<Vec<3>> edges;
    for (const auto& [of, patch] : {std::pair(&a, &s), std::pair(&b, &t)})
        for (const auto& [i, j] : of->cell.edges)
            edges.push_back((*patch)[of->basis.corner(j)] - (*patch)[of->basis.corner(i)]);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (a.cell.dim == 2) axes.push_back({edges[i][1], -edges[i][0], 0});
        for (std::size_t j = i + 1; j < edges.size() && a.cell.dim == 3; ++j) axes.push_back(cross(edges[i], edges[j]));
    }
}

// Distance between the first `points` Bezier points of the patches along the axis, negative for their overlap.
// Positions are relative to a corner, so that shared corners stay exactly equal.
double gap_along(const Vec<3>& axis, const Patch& s, const Patch& t, std::size_t points) {
    const auto range = [&](const Patch& patch) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t i = 0; i < std::min(points, patch.size()); ++i) {
            const double place = dot(axis, patch[i] - s[0]);
            low = std::min(low, place);
            high = std::max(high, place);
        }
        return std::pair(low, high);
    };
    const auto [low_s, high_s] = range(s);
    const auto [low_t, high_t] = range(t);
    return std::max(low_t - high_s, low_s - high_t);
}

// Largest gap over the axes; stops above `enough`.
double largest_gap(const Axes& axes, const Patch& s, const Patch& t, double enough,
                   std::size_t points = std::numeric_limits<std::size_t>::max()) {
    double largest = -std::numeric_limits<double>::infinity();
    for (const Vec<3>& axis : axes) {
        const double norm = length(axis);
        if (norm == 0) continue;
        largest = std::max(largest, gap_along(axis, s, t, points) / norm);
        if (largest >= enough) break;
    }
    return largest;
}

using Pair = std::pair<Patch, Patch>;

// a, b: patches in these forms. axes_of(s, t, axes): of pieces of theirs. apart: a gap that is enough.
template <class AxesOf>
Contact contact(const Bernstein& form_a, const Patch& a, const Bernstein& form_b, const Patch& b, double tolerance,
                double apart, int most, const AxesOf& axes_of) {
    const int corners = form_a.dim + 1;
    const bool are_simplices = form_a.factors[1] == 0 && form_b.factors[1] == 0;
    Axes axes;
    std::vector<Pair> pairs;
    const auto test_or_bisect = [&](const Patch& s, const Patch& t) {
        axes.clear();
        axes_of(s, t, axes);
        const double gap = largest_gap(axes, s, t, apart);
        if (gap >= apart) return Contact::apart;
        const CurvedEdge of_s = longest_curve(form_a, s), of_t = longest_curve(form_b, t);
        bool bisects_s = of_s.length >= of_t.length;
        if (are_simplices) {
            const double deviation_s = deviation(form_a, s), deviation_t = deviation(form_b, t);
            if (gap >= -tolerance && deviation_s + deviation_t <= tolerance) return Contact::touching;
            const double enough = -(deviation_s + deviation_t) - tolerance;
            if (largest_gap(axes, s, t, enough, corners) < enough) return Contact::crossing;
            bisects_s = deviation_s >= deviation_t;
        }
        const CurvedEdge& edge = bisects_s ? of_s : of_t;
        const auto [near, far] = bisect(bisects_s ? form_a : form_b, bisects_s ? s : t, edge.a, edge.b);
        for (const Patch* half : {&near, &far}) pairs.push_back(bisects_s ? Pair(*half, t) : Pair(s, *half));
        return Contact::apart;
    };
    Contact found = test_or_bisect(a, b);
    for (int tested = 1; !pairs.empty() && found != Contact::crossing; ++tested) {
        if (tested == most) return Contact::undecided;
        const auto [s, t] = std::move(pairs.back());
        pairs.pop_back();
        found = std::max(found, test_or_bisect(s, t));
    }
    return found;
}

}  // namespace

double contact_tolerance(const Patch& a, const Patch& b, double rounding) {
    constexpr double of_positions = 16 * std::numeric_limits<double>::epsilon();
    const Box box_a = box_of(a), box_b = box_of(b);
    const double edge = std::min(length(box_a.high - box_a.low), length(box_b.high - box_b.low));
    return touching_distance * edge + of_positions * std::max(length(a[0]), length(b[0])) + rounding;
}

Contact patch_contact(const Bernstein& basis, const Patch& a, const Patch& b, double tolerance, bool corners_meet) {
    return contact(basis, a, basis, b, tolerance, corners_meet ? -tolerance : tolerance, pairs_of_faces,
                   [m = basis.dim](const Patch& s, const Patch& t, Axes& axes) { face_axes(s, t, m, axes); });
}

std::pair<double, Vec<3>> widest_gap(const Patch& a, const Patch& b, int m) {
    Axes axes;
    face_axes(a, b, m, axes);
    std::pair<double, Vec<3>> widest{-std::numeric_limits<double>::infinity(), {}};
    for (const Vec<3>& axis : axes)
        if (length(axis) > 0) widest = std::max(widest, {gap_along(unit(axis), a, b, a.size()), unit(axis)});
    return widest;
}

Contact solid_contact(const Solid& a, const Solid& b, const Vec<3>& first, double tolerance) {
    return contact(a.basis.bernstein, a.patch, b.basis.bernstein, b.patch, tolerance, -tolerance, pairs_of_solids,
                   [&](const Patch& s, const Patch& t, Axes& axes) {
                       axes = {first};
                       if (largest_gap(axes, s, t, -tolerance) < -tolerance) solid_axes(a, s, b, t, axes);
                   });
}

}  // namespace almesh
