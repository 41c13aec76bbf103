// The boundary constraint c of the augmented Lagrangian (paper, Eq. 6), as the method sees it: a function of the node
// positions x with multipliers lambda and a penalty mu, whose part of the functional is
//
//     C(x) = -(lambda, c) + mu/2 |c|^2,
//
// in a scalar product of the boundary with (1, 1) = |1|^2. The interface does not assume that c is linear, nor fix
// which nodes it acts on or how many multipliers a node has. dirichlet.hpp prescribes positions, sliding_boundary.hpp
// only requires some nodes to be on surfaces.
//
// Evaluations use work space of the object: one call at a time. x: node_count x dim positions everywhere.
#pragma once
#include <algorithm>
#include <memory>
#include <vector>

#include "base/index.hpp"
#include "base/small_matrix.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/restriction.hpp"

namespace almesh {

// The residual r of a node at x, zero if P c = 0 there, and its derivative.
struct SurfaceDistance {
    Vec<3> r{};
    Mat<3> slope{};  // D, of r with respect to x
};

class Constraint {
public:
    virtual ~Constraint() = default;

    virtual int multipliers() const = 0;                     // length of lambda
    virtual double norm_of_one() const = 0;                  // |1|
    virtual double norm(const std::vector<double>& x) = 0;   // |c|
    // |P c|, P the projection onto the multiplier space: the part of c that can vanish, used by the stopping tests.
    virtual double projected_norm(const std::vector<double>& x) = 0;
    // Largest distance of a boundary node from its target or surface; and of points between nodes from the target, on
    // faces all of whose nodes are prescribed.
    virtual double max_error(const std::vector<double>& x) = 0;
    virtual double error_between_nodes(const std::vector<double>& /*x*/) { return 0; }
    // The distance of each of nodes() from its position with P c = 0, over the height of the cells at that node.
    virtual std::vector<double> relative_errors(const std::vector<double>& x) const = 0;
    double relative_error(const std::vector<double>& x) const {  // the largest of them
        double largest = 0;
        for (const double error : relative_errors(x)) largest = std::max(largest, error);
        return largest;
    }

    virtual double value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) = 0;
    virtual void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                              std::vector<double>& g) = 0;
    // projected: replaces the Hessian mu dc dc + (mu c - lambda) d2c, whose second term may be indefinite, by a
    // positive semidefinite matrix: without that term (Gauss-Newton), or with its negative eigenvalues filtered.
    virtual void add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                             BlockCsr& H) = 0;
    virtual void update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) = 0;

    // Second-order correction of steps (Nocedal & Wright, sec. 18.3): moves y = x + t d so that c(y) is c(x) + t dc d.
    // Without it, steps along a curved surface leave it by the curvature times their square, and a large penalty keeps
    // them short (Maratos effect). Newton's method lets the inside follow where a corrected step is cut.
    virtual bool corrects_steps() const { return false; }
    virtual void correct(const std::vector<double>& /*x*/, const std::vector<double>& /*d*/, double /*t*/,
                         std::vector<double>& /*y*/) const {}

    // Restriction to some nodes: C up to a constant, as a function of their positions alone, in their numbering.
    // Derivatives are correct for nodes that move, and for no others. Errors between nodes are not measured. lambda: on
    // return the multipliers of the restriction.
    virtual std::unique_ptr<Constraint> part(const Restriction& around, std::vector<double>& lambda) const = 0;

    // For derivatives of the solution: r and D of nodes()[t] at x (r of a prescribed node is the vector from its
    // target); and the sum over k of force_k times the second derivative of r_k.
    virtual SurfaceDistance distance(int t, const Vec<3>& x) const = 0;
    virtual Mat<3> second_derivative_at(int /*t*/, const Vec<3>& /*x*/, const Vec<3>& /*force*/) const { return {}; }

    // As vector fields on the boundary, for pictures and to carry them to a finer mesh: nodes().size() x dim.
    virtual const std::vector<int>& nodes() const = 0;  // mesh nodes that the constraint acts on, ascending
    virtual std::vector<double> multiplier_field(const std::vector<double>& lambda) const = 0;
    virtual std::vector<double> multipliers_of_field(const std::vector<double>& field) const = 0;
    virtual std::vector<double> constraint_field(const std::vector<double>& x) const = 0;  // P c
    // nodes().size() x dim positions at which P c = 0, those closest to x; empty where there are none to be had.
    virtual std::vector<double> targets(const std::vector<double>& /*x*/) const { return {}; }
    // Per node: whether x is off its target, exactly or, for a node that slides, by more than rounding.
    virtual std::vector<char> off_target(const std::vector<double>& /*x*/) const { return {}; }
};

}  // namespace almesh
