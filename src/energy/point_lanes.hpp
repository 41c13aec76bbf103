// The rule of one element with its points in lanes, for elements with rules of their own (refined_rule.hpp).
#pragma once
#include <algorithm>
#include <vector>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

// The last lanes are filled up with copies of the last point that weigh nothing.
struct PointLanes {
    int nodes, points;             // points: per lane
    std::vector<Lanes> weight;     // points
    std::vector<Lanes> gradients;  // points x nodes x dim

    explicit PointLanes(const ReferenceElement& of) : nodes(of.nodes), points((of.points + lanes - 1) / lanes) {
        const int stride = static_cast<int>(of.gradients.size()) / of.points;
        weight.resize(points);
        gradients.resize(offset(points, stride));
        for (int k = 0; k < points * lanes; ++k) {
            const int q = std::min(k, of.points - 1);
            weight[k / lanes][k % lanes] = k < of.points ? of.weight[q] : 0;
            for (int i = 0; i < stride; ++i)
                gradients[offset(k / lanes, stride, i)][k % lanes] = of.gradients[offset(q, stride, i)];
        }
    }
};

}  // namespace almesh
