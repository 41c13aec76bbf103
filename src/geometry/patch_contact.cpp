#include "geometry/patch_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace almesh {
namespace {

constexpr int max_pairs = 4000;
constexpr double rounding = 1e-9;  // of the smaller patch: less penetration than this is touching

Point centre(const Patch& patch, int m) {
    Point sum{};
    for (int v = 0; v <= m; ++v)
        for (int a = 0; a < 3; ++a) sum[a] += patch.component(a)[v] / (m + 1);
    return sum;
}

struct Axes {
    std::array<Point, 18> axis;
    int count = 0;

    void add(const Point& direction) { axis[count++] = direction; }
};

// Directions among which there is a separating one if the flat patches do not cross.
Axes candidate_axes(const Patch& a, const Patch& b, int m) {
    Axes axes;
    axes.add(centre(b, m) - centre(a, m));
    if (m == 1) {
        for (const Patch* patch : {&a, &b}) {
            const Point side = patch->point(1) - patch->point(0);
            axes.add(side);
            axes.add({side[1], -side[0], 0});
        }
        return axes;
    }
    std::array<Point, 6> sides;
    for (int k = 0; k < 3; ++k) {
        sides[k] = a.point((k + 1) % 3) - a.point(k);
        sides[3 + k] = b.point((k + 1) % 3) - b.point(k);
    }
    const Point normal_a = cross(sides[0], sides[1]), normal_b = cross(sides[3], sides[4]);
    axes.add(normal_a);
    axes.add(normal_b);
    for (int k = 0; k < 3; ++k) {
        axes.add(cross(normal_a, sides[k]));
        axes.add(cross(normal_b, sides[3 + k]));
        for (int l = 3; l < 6; ++l) axes.add(cross(sides[k], sides[l]));
    }
    return axes;
}

// Distance between the two point sets along the axis, negative for their overlap. Positions relative to `origin`, which
// is a corner, so that shared corners stay exactly equal.
double gap_along(const Point& axis, const Point& origin, const Patch& a, const Patch& b, int points) {
    double low[2], high[2];
    for (int side = 0; side < 2; ++side) {
        const Patch& patch = side == 0 ? a : b;
        low[side] = std::numeric_limits<double>::infinity();
        high[side] = -low[side];
        for (int i = 0; i < points; ++i) {
            const double t = dot(axis, patch.point(i) - origin);
            low[side] = std::min(low[side], t);
            high[side] = std::max(high[side], t);
        }
    }
    return std::max(low[1] - high[0], low[0] - high[1]);
}

// Largest gap over the axes between the first `points` Bezier points of the patches; stops above `enough`.
double largest_gap(const Axes& axes, const Patch& a, const Patch& b, int points, double enough) {
    double largest = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < axes.count; ++k) {
        const Point& axis = axes.axis[k];
        const double length = std::sqrt(dot(axis, axis));
        if (length == 0) continue;
        largest = std::max(largest, gap_along(axis, a.point(0), a, b, points) / length);
        if (largest >= enough) break;
    }
    return largest;
}

struct Pair {
    Patch s, t;
};

// Tells of the patches as they are whether they touch or cross. Where they are too bent for that, the answer is
// `undecided`, and the pairs with the halves of the more bent one are added to the ones to test.
Contact test_or_halve(const Bernstein& basis, const Patch& s, const Patch& t, std::vector<Pair>& pairs) {
    const int m = basis.dim;
    const double touching = rounding * std::min(size_of(s, m), size_of(t, m));
    const Axes axes = candidate_axes(s, t, m);
    if (largest_gap(axes, s, t, basis.count, -touching) >= -touching) return Contact::apart;
    const double bent_s = deviation(basis, s), bent_t = deviation(basis, t), bent = bent_s + bent_t;
    if (largest_gap(axes, s, t, m + 1, -bent - touching) < -bent - touching) return Contact::crossing;
    const bool halves_s = bent_s >= bent_t;
    const auto [i, j] = longest_side(halves_s ? s : t, m);
    auto [near, far] = bisect(basis, halves_s ? s : t, i, j);
    for (Patch* half : {&near, &far}) {
        if (halves_s) pairs.push_back({std::move(*half), t});
        else pairs.push_back({s, std::move(*half)});
    }
    return Contact::undecided;
}

}  // namespace

Contact patch_contact(const Bernstein& basis, const Patch& a, const Patch& b) {
    std::vector<Pair> pairs;
    Contact contact = test_or_halve(basis, a, b, pairs);
    for (int tested = 1; contact != Contact::crossing && !pairs.empty(); ++tested) {
        if (tested == max_pairs) return Contact::undecided;
        const Pair pair = std::move(pairs.back());
        pairs.pop_back();
        contact = test_or_halve(basis, pair.s, pair.t, pairs);
    }
    return contact;
}

}  // namespace almesh
