// The quadrature of one element that has folded between the points of its rule.
//
// The integral of the distortion is infinite for a folded element, its sum over points is not: nothing keeps a
// minimiser of the sum from folding the element between them. So where a step would (valid_step.hpp), the element is
// cut into pieces that get smaller towards that place, with the element's rule on each. The points of the rule at the
// nodes of a piece make the energy infinite where the element folds there.
//
// In 3D a barrier takes more: where det F falls to zero like the distance r from a place, eta^2 grows like r^(-4/3),
// whose integral over the element is finite. Where small elements weigh little, minimisers do touch such places, and
// Newton's method creeps towards them without end. So a piece of size s weighs s^(4/3), not its volume s^3: what it
// adds where det F is about s does not vanish with s. In 2D, r^(-2) is not integrable, and a piece weighs its area.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "energy/point_lanes.hpp"
#include "geometry/bezier.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

class RefinedRule {
public:
    explicit RefinedRule(int dim);  // one piece: the whole element

    // Halves the size of the smallest piece around `at` until it is at most `size`, that of the element being 1, or
    // once for size = 0. False where nothing changes: it is small enough, or there are `most_pieces` already.
    bool refine(const Barycentric& at, double size);

    // The points, with the weights of the barrier. rule: of the whole element.
    ReferenceElement element(int degree, const Quadrature& rule) const;
    std::vector<double> volumes(const Quadrature& rule) const;  // per point: its weight in an integral

private:
    static constexpr int most_pieces = 128;

    struct Piece {
        std::array<Barycentric, 4> corner;
        double volume;  // of the whole
    };
    int dim_;
    std::vector<Piece> pieces_;

    Piece* smallest_around(const Barycentric& at);
};

// What elements with such a rule are integrated with, the same for an energy and its parts.
struct RefinedQuadrature {
    RefinedRule rule;
    ReferenceElement reference;
    std::vector<double> volume;  // per point: RefinedRule::volumes()
    PointLanes lanes;            // the points of `reference`

    RefinedQuadrature(RefinedRule refined, int degree, const Quadrature& of_element)
        : rule(std::move(refined)),
          reference(rule.element(degree, of_element)),
          volume(rule.volumes(of_element)),
          lanes(reference) {}
};

}  // namespace almesh
