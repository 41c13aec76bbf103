// What the kernels for batches of elements are given: the ideal elements, one in each lane; and of elements with rules
// of their own (refined_rule.hpp) the rule of one, with its points in lanes.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "base/small_matrix.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

// Of the elements of a batch.
template <int n>
struct IdealLanes {
    const Mat<n, Lanes>& inverse;       // A^{-1} of straight ones
    Lanes jacobian;                     // mean det A
    const std::vector<double>& curved;  // node positions (nodes x n) of curved ones, else empty
    bool has_one = false;               // those of one element with mean det A = 1, of which all are multiples
};

// In rows of most_lanes points, the last one filled up with copies of the last point that weigh nothing. Where there
// are fewer lanes, the first points of all rows come first, then the next ones: each is a part of the rule, and the
// sums over the lanes of one part after the other are those of most_lanes.
struct PointLanes {
    static constexpr int parts = batches_per_row;
    int degree, nodes, rows, points;  // points: per lane, those of all parts
    std::vector<Lanes> weight;     // points
    std::vector<Lanes> gradients;  // points x nodes x dim
    std::vector<Lanes> monomials;  // points x those of ReferenceElement
    std::vector<ProductPoints> products{};  // none: no lane has a line of points
    std::vector<int> product_node{};

    explicit PointLanes(const ReferenceElement& of)
        : degree(of.degree), nodes(of.nodes), rows((of.points + most_lanes - 1) / most_lanes), points(parts * rows) {
        const int stride = static_cast<int>(of.gradients.size()) / of.points;
        const int powers = static_cast<int>(of.monomials.size()) / of.points;
        weight.resize(points);
        gradients.resize(offset(points, stride));
        monomials.resize(offset(points, powers));
        for (int k = 0; k < rows * most_lanes; ++k) {
            const int q = std::min(k, of.points - 1);
            const auto [pack, lane] = place_of(k);
            weight[pack][lane] = k < of.points ? of.weight[q] : 0;
            for (int i = 0; i < stride; ++i)
                gradients[offset(pack, stride, i)][lane] = of.gradients[offset(q, stride, i)];
            for (int i = 0; i < powers; ++i)
                monomials[offset(pack, powers, i)][lane] = of.monomials[offset(q, powers, i)];
        }
    }

    // Where point q is: number of its lanes, and the lane.
    std::pair<int, int> place_of(int q) const {
        const int of_row = q % most_lanes;
        return {of_row / lanes * rows + q / most_lanes, of_row % lanes};
    }
};

}  // namespace almesh
