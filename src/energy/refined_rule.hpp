// The quadrature of one element that came near inverting between the points of its rule.
//
// The integral of the distortion is infinite for an inverted element, its quadrature sum is not: nothing keeps a
// minimiser of the sum from inverting the element between the points. If a step would do so (valid_step.hpp), the
// element is cut into pieces that get smaller towards that position, with the element's rule on each. The points of the
// rule at the nodes of a piece make the energy infinite if the element inverts there. Pieces are products of simplices,
// as the cell is; those of a pyramid are boxes in its collapsed coordinates, with a hexahedron's rule and (1 - c)^2.
//
// In 3D this is no barrier yet: if det F falls to zero like the distance r from a point, eta^2 grows like r^(-4/3),
// whose integral over the element is finite. If small elements weigh little, minimisers do reach such points, and
// Newton's method creeps towards them without end. So a piece of size s weighs s^(4/3), not its volume s^3: what it
// adds if det F is about s does not vanish with s. In 2D, r^(-2) is not integrable, and a piece weighs its area.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "energy/element_rules.hpp"
#include "energy/point_lanes.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

class RefinedRule {
public:
    explicit RefinedRule(const CellType& cell);  // one piece: the whole element

    // The rule for its pieces, where that of the elements is the usual one of this degree and exactness.
    static Quadrature of_pieces(const CellType& cell, int degree, int exactness);

    // Halves the size of the smallest piece around `at` until it is at most `size`, that of the element being 1, or
    // once for size = 0. False where nothing changes: it is small enough, or there are `most_pieces` already.
    bool refine(const CellPoint& at, double size);

    // The points, with the weights of the barrier in E. rule: of a piece.
    ElementRule element(int degree, const Quadrature& rule) const;

private:
    static constexpr int most_pieces = 128;

    struct Piece {
        std::array<CellPoint, 6> corner;  // of each factor of the cell, one after the other
        double volume;                    // of the whole, in reference coordinates
    };
    const CellType* cell_;
    int dim_;
    std::vector<Piece> pieces_;

    Piece* smallest_around(const CellPoint& at);
    double inside(const Piece& piece, const CellPoint& at) const;
    double mean_measure(const Piece& piece) const;
};

// What elements with such a rule are integrated with, the same for an energy and its parts.
struct RefinedQuadrature : ElementRule {
    RefinedRule rule;
    PointLanes lanes;  // the points of `reference`

    RefinedQuadrature(RefinedRule refined, int degree, const Quadrature& of_piece)
        : ElementRule(refined.element(degree, of_piece)), rule(std::move(refined)), lanes(reference) {}
};

}  // namespace almesh
