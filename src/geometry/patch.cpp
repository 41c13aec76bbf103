#include "geometry/patch.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {

PatchBasis::PatchBasis(int m, int degree)
    : bernstein(m, degree), to_bezier(bezier_of_lagrange(LagrangeBasis(m, degree))) {}

Patch make_patch(const PatchBasis& basis, const double* nodes, int dim) {
    const int count = basis.bernstein.count;
    Patch patch{std::vector<double>(3 * static_cast<std::size_t>(count))};
    for (int b = 0; b < count; ++b)
        for (int i = 0; i < count; ++i) {
            const double weight = basis.to_bezier[static_cast<std::size_t>(b) * count + i];
            for (int a = 0; a < dim; ++a)  // relative to node 0: stretched faces may lie far from the origin
                patch.component(a)[b] += weight * (nodes[i * dim + a] - nodes[a]);
        }
    for (int b = 0; b < count; ++b)
        for (int a = 0; a < dim; ++a)
            patch.component(a)[b] = b <= basis.bernstein.dim ? nodes[b * dim + a] : patch.component(a)[b] + nodes[a];
    return patch;
}

Box box_of(const Patch& patch) {
    Box box;
    for (int a = 0; a < 3; ++a) {
        const auto [low, high] = std::minmax_element(patch.component(a), patch.component(a) + patch.count());
        box.low[a] = *low;
        box.high[a] = *high;
    }
    return box;
}

std::array<int, 2> longest_side(const Patch& patch, int m) {
    std::array<int, 2> longest = {0, 1};
    double best = -1;
    for (int a = 0; a <= m; ++a)
        for (int b = a + 1; b <= m; ++b) {
            const Point d = patch.point(b) - patch.point(a);
            if (dot(d, d) > best) {
                best = dot(d, d);
                longest = {a, b};
            }
        }
    return longest;
}

double size_of(const Patch& patch, int m) {
    const auto [a, b] = longest_side(patch, m);
    const Point d = patch.point(b) - patch.point(a);
    return std::sqrt(dot(d, d));
}

Point side_tangent(const Bernstein& basis, const Patch& patch, int i, int j) {
    MultiIndex next{};
    next[i] = basis.degree - 1;
    ++next[j];
    return patch.point(basis.find(next)) - patch.point(i);
}

std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b) {
    std::pair<Patch, Patch> halves{patch, patch};
    for (int k = 0; k < 3; ++k)
        basis.bisect(a, b, patch.component(k), halves.first.component(k), halves.second.component(k));
    return halves;
}

double deviation(const Bernstein& basis, const Patch& patch) {
    double largest = 0;
    for (int i = basis.dim + 1; i < basis.count; ++i) {
        Point d = patch.point(i);
        for (int v = 0; v <= basis.dim; ++v)
            for (int a = 0; a < 3; ++a) d[a] -= patch.component(a)[v] * basis.index[i][v] / basis.degree;
        largest = std::max(largest, dot(d, d));
    }
    return std::sqrt(largest);
}

}  // namespace almesh
