#include "geometry/half_space.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {
namespace {

// With the same product with all of at most three, positive; zero where there is none.
Vec<3> axis_of(const std::vector<Vec<3>>& some) {
    if (some.size() == 1) return some[0];
    const Vec<3> third = some.size() == 3 ? some[2] : cross(some[0], some[1]);
    Vec<3> sum = cross(some[1], third) + cross(third, some[0]);
    if (some.size() == 3) sum = sum + cross(some[0], some[1]);
    return dot(some[0], cross(some[1], third)) > 0 ? sum : -1 * sum;
}

}  // namespace

HalfSpace half_space_of(const std::vector<Vec<3>>& vectors) {
    const unsigned count = static_cast<unsigned>(vectors.size());
    HalfSpace best;
    for (unsigned subset = 1; subset < 1u << count; ++subset) {
        std::vector<Vec<3>> some;
        for (unsigned k = 0; k < count; ++k)
            if (subset >> k & 1) some.push_back(vectors[k]);
        if (some.size() > 3) continue;
        const Vec<3> d = axis_of(some);
        const double length = std::sqrt(dot(d, d));
        if (!(length > 0)) continue;
        double least = dot(d, vectors[0]);
        for (const Vec<3>& v : vectors) least = std::min(least, dot(d, v));
        if (least / length > best.least) best = {1 / length * d, least / length, std::move(some)};
    }
    return best;
}

const Vec<3>& lowest(const std::vector<Vec<3>>& vectors, const Vec<3>& d) {
    return *std::min_element(vectors.begin(), vectors.end(),
                             [&](const Vec<3>& v, const Vec<3>& w) { return dot(v, d) < dot(w, d); });
}

bool is_half_space(const std::function<Vec<3>(const Vec<3>& d)>& least, double margin) {
    constexpr int most_steps = 60;
    HalfSpace found{least({}), 0, {}};
    for (int step = 0; step < most_steps; ++step) {
        const Vec<3> v = least(found.d);
        if (dot(v, found.d) > margin * std::sqrt(dot(found.d, found.d))) return true;
        found.support.push_back(v);
        found = half_space_of(found.support);
        if (!(found.least > margin)) return false;
    }
    return false;
}

bool are_in_half_space(const std::vector<Vec<3>>& vectors, double margin) {
    return is_half_space([&](const Vec<3>& d) { return lowest(vectors, d); }, margin);
}

}  // namespace almesh
