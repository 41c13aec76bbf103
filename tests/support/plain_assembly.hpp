// The distortion energy, its gradient and its Hessian the plain way: the oracle of energy/, and the yardstick of
// its speed. One element after the other, the second derivative of eta as a fourth-order tensor written down from
// F^{-T}, a general eigensolver for the projection, dense loops, every block found in its row by bisection.
//
//     eta_F      = 2 / (n D^{2/n}) F - 2/n eta F^{-T}
//     eta_FF: dF = 2 / (n D^{2/n}) (dF - 2/n (F^{-T} : dF) F) - 2/n (eta_F : dF) F^{-T} + 2/n eta F^{-T} dF^T F^{-T}
#pragma once
#include <vector>

#include "energy/distortion_energy.hpp"
#include "mesh/quadrature.hpp"

namespace almesh::test {

class PlainAssembly {
public:
    // params.delta must be 0. The mesh must outlive this.
    PlainAssembly(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params);

    double energy(const std::vector<double>& x) const;  // infinite for inverted elements
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) const;
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H) const;

private:
    const Mesh& mesh_;
    DistortionParams params_;
    Quadrature quadrature_;
    std::vector<double> gradients_;      // points x nodes x dim, on the reference element
    std::vector<double> ideal_inverse_;  // element x dim x dim
    std::vector<double> weight_;         // element, w_e det A
    std::vector<double> damping_;        // element, weight in the damping over weight_

    // body(derivatives of the element's basis on the ideal element (nodes x dim), F (dim x dim), weight).
    template <class Body>
    void every_point(int e, const std::vector<double>& x, const Body& body) const;
};

// Positive semidefinite part of a symmetric size x size matrix, row-major: cyclic Jacobi.
void project(int size, double* A);

}  // namespace almesh::test
