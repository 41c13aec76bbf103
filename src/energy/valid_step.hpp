// How far along a straight step all elements stay valid.
//
// Every node moves from x to x' on a straight line. The determinant of an element's map is a polynomial in the
// reference coordinates and in the fraction s of the step, of degree n in s; its Bernstein coefficients bound it from
// below (element_jacobian.hpp; a straight simplex has one number for each b_k). So no step of the method passes through
// an inverted element to a mesh of another homotopy class, and the mesh at its end is certified everywhere in each
// element, not only at the points of its quadrature. Most elements are cleared by the coefficients of the whole step,
// the others by bisection in space and in s.
//
// Straight-sided cells other than simplices count as curved here: their determinant is not constant. If the determinant
// of a curved element is small somewhere, a step must keep a fifth of its minimum, as interior point methods keep part
// of the distance to the boundary: the element approaches inversion in several steps, between which its quadrature is
// refined there (refined_rule.hpp).
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

// An element that shortened a step, and the position of its least determinant at the end of the step.
struct Inversion {
    int element;
    CellPoint at;
    double ratio;  // of the determinant there to its mean over the element; 0 where it inverts or is not certified
};

class ValidStep {
public:
    ValidStep(const CellType& cell, int degree);

    // The largest s in [0, 1] found such that every element that is valid at x is so at (1 - r) x + r x', 0 <= r <= s.
    // node: count x m. Curved elements that shorten the step because they are not valid at x' are added to
    // `inversions`. Same bits for any number of threads.
    double fraction(const std::vector<int>& node, int count, const std::vector<double>& from,
                    const std::vector<double>& to, std::vector<Inversion>& inversions) const;

    // Marks the elements over which the Jacobian at x varies much (ElementJacobian::deviation()), simplices excluded.
    // bent: per element. Whether there is one that was not marked.
    bool add_bent(const std::vector<int>& node, const std::vector<double>& x, std::vector<char>& bent) const;

private:
    int dim_, element_nodes_;
    std::shared_ptr<const JacobianBasis> basis_;  // none for straight simplices
};

}  // namespace almesh
