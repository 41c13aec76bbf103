// How far along a straight step all elements stay valid.
//
// Every node moves from x to x' on a straight line. The determinant of an element's map is a polynomial in the place in
// the element and in the fraction s of the step, of degree n in s; its Bernstein coefficients in both bound it from
// below (element_jacobian.hpp; a straight simplex has one number for each b_k). So no step of the method passes through
// an inverted element, from one valid mesh to another of another homotopy class, and the mesh that it leads to is
// certified: everywhere in a curved element, not only at the points of its quadrature. Most elements are cleared by the
// coefficients of the whole step; the others by bisection in space, and in s.
//
// Straight-sided cells of other types count as curved elements here: their determinant is not constant. A curved one
// whose determinant is small somewhere keeps a fifth of the least one in a step, as interior point
// methods keep a part of the distance to the boundary: it comes near to folding in several steps, between which its
// quadrature gets finer there (refined_rule.hpp).
//
// Conservative checks of this kind for curved elements: Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013; along
// steps: Wang, Ferguson, Schneider, Jiang, Attene, Panozzo, ACM Trans. Graph. 40(5), 2021.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "mesh/cells.hpp"

namespace almesh {

struct JacobianBasis;

// A place in the reference cell: barycentric coordinates of its factors, of a quadrilateral (1 - x, x, 1 - y, y).
using CellPoint = std::array<double, 6>;

// Where an element that a step has been cut for would have its least determinant at the end of the step.
struct Inversion {
    int element;
    CellPoint at;
    double ratio;  // of the determinant there to its mean over the element; 0 where it inverts or is not certified
};

class ValidStep {
public:
    ValidStep(const CellType& cell, int degree);

    // The largest s in [0, 1] found so that every element is valid along (1 - r) x + r x' for 0 <= r <= s, if it is at
    // x. node: count x m. Curved elements that a step is cut for because of what they would be at x' are added to
    // `inversions`. Same bits for any number of threads.
    double fraction(const std::vector<int>& node, int count, const std::vector<double>& from,
                    const std::vector<double>& to, std::vector<Inversion>& inversions) const;

private:
    int dim_, element_nodes_;
    std::shared_ptr<const JacobianBasis> basis_;  // none for straight simplices

    template <int n>
    double of_batch(const int* const* node, int count, const std::vector<double>& from, const std::vector<double>& to,
                    int first, std::vector<Inversion>& inversions) const;
};

}  // namespace almesh
