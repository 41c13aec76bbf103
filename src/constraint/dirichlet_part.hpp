// The Dirichlet constraint C as a function of the positions y of some nodes, of which those on the boundary matter. It
// is quadratic in their distances r from where they should be: with u = r(y) - r(x), x the positions where the part was
// made,
//
//     C = g . u + 1/2 u' C u   up to a constant,   gradient D'(g + C u),   Hessian D' C D + (g + C u) . d2r/dy2.
#pragma once
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/dirichlet.hpp"
#include "linalg/block_csr.hpp"

namespace almesh {

class DirichletPart : public ConstraintPart {
public:
    // The nodes of the part that are trace nodes.
    std::vector<int> node, trace_node;  // their numbers in the part and in the trace
    std::vector<double> x, r, g;        // of them, x dim
    BlockCsr C;                         // of them, d = 1: the same for each component
    std::vector<int> place;             // of each entry of C, its block in the Hessian

    // whole: null where all places are prescribed: then u = y - x.
    DirichletPart(const Dirichlet* whole, int dim) : whole_(whole), dim_(dim) {}

    void add_value(const std::vector<double>& y, double& E) override;
    void add_gradient(const std::vector<double>& y, std::vector<double>& gradient) override;
    void add_hessian(const std::vector<double>& y, bool projected, BlockCsr& H) override;

private:
    const Dirichlet* whole_;
    int dim_;
    std::vector<double> u_, force_, slope_;  // of the nodes above; force: g + C u; slope: D, x dim x dim

    void measure(const std::vector<double>& y);
};

}  // namespace almesh
