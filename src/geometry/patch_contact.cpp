// Separating axes (Gottschalk, Lin, Manocha, SIGGRAPH 1996) of the flat patches with the same corners are tried on all
// Bezier points, whose hulls enclose the patches: a gap along one of them proves the patches apart. Where the flat
// patches penetrate each other by more than the curved ones deviate from them, the curved ones cross. Pairs with
// neither proof are bisected.
#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>

#include "geometry/patch.hpp"

namespace almesh {
namespace {

constexpr int max_pairs = 4000;
constexpr double rounding = 1e-9;  // of the smaller patch: less penetration than this is touching

Vec<3> centre(const Patch& patch, int m) {
    Vec<3> sum{};
    for (int v = 0; v <= m; ++v) sum = sum + (1.0 / (m + 1)) * patch[v];
    return sum;
}

// At most as many directions as candidate_axes() has.
struct Axes {
    std::array<Vec<3>, 18> axis;
    int count = 0;

    void add(std::initializer_list<Vec<3>> more) {
        for (const Vec<3>& direction : more) axis[count++] = direction;
    }
    const Vec<3>* begin() const { return axis.data(); }
    const Vec<3>* end() const { return axis.data() + count; }
};

// Directions among which there is a separating one if the flat patches do not cross.
Axes candidate_axes(const Patch& a, const Patch& b, int m) {
    Axes axes;
    axes.add({centre(b, m) - centre(a, m)});
    if (m == 1) {
        for (const Vec<3>& side : {a[1] - a[0], b[1] - b[0]}) axes.add({side, {side[1], -side[0], 0}});
        return axes;
    }
    const Vec<3> sides_a[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]}, normal_a = cross(sides_a[0], sides_a[1]);
    const Vec<3> sides_b[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]}, normal_b = cross(sides_b[0], sides_b[1]);
    axes.add({normal_a, normal_b});
    for (int k = 0; k < 3; ++k) {
        axes.add({cross(normal_a, sides_a[k]), cross(normal_b, sides_b[k])});
        for (const Vec<3>& side : sides_b) axes.add({cross(sides_a[k], side)});
    }
    return axes;
}

// Distance between the first `points` Bezier points of the patches along the axis, negative for their overlap.
// Positions are relative to a corner, so that shared corners stay exactly equal.
double gap_along(const Vec<3>& axis, const Patch& s, const Patch& t, int points) {
    const auto range = [&](const Patch& patch) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (int i = 0; i < points; ++i) {
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
double largest_gap(const Axes& axes, const Patch& s, const Patch& t, int points, double enough) {
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

// Whether the patches touch or cross, as far as they tell undivided. Where they are too curved for that, the answer is
// `undecided`, and the pairs with the halves of the more curved one are added to those to test.
Contact test_or_bisect(const Bernstein& basis, const Patch& s, const Patch& t, std::vector<Pair>& pairs) {
    const int m = basis.dim;
    const Axes axes = candidate_axes(s, t, m);
    const double gap = largest_gap(axes, s, t, basis.count, 0);
    if (gap >= 0) return Contact::apart;
    const double touching = rounding * std::min(size_of(s, m), size_of(t, m));
    if (gap >= -touching) return Contact::apart;
    const double deviation_s = deviation(basis, s), deviation_t = deviation(basis, t);
    const double enough = -(deviation_s + deviation_t) - touching;
    if (largest_gap(axes, s, t, m + 1, enough) < enough) return Contact::crossing;
    const bool bisect_s = deviation_s >= deviation_t;
    const auto [i, j] = longest_edge(bisect_s ? s : t, m);
    const auto [near, far] = bisect(basis, bisect_s ? s : t, i, j);
    for (const Patch* half : {&near, &far}) pairs.push_back(bisect_s ? Pair(*half, t) : Pair(s, *half));
    return Contact::undecided;
}

}  // namespace

Contact patch_contact(const Bernstein& basis, const Patch& a, const Patch& b) {
    std::vector<Pair> pairs;
    if (const Contact whole = test_or_bisect(basis, a, b, pairs); whole != Contact::undecided) return whole;
    for (int tested = 1; !pairs.empty(); ++tested) {
        if (tested == max_pairs) return Contact::undecided;
        const auto [s, t] = std::move(pairs.back());
        pairs.pop_back();
        if (test_or_bisect(basis, s, t, pairs) == Contact::crossing) return Contact::crossing;
    }
    return Contact::apart;
}

}  // namespace almesh
