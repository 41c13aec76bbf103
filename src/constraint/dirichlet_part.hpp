// The Dirichlet constraint C as a function of the positions y of some nodes. It is quadratic in their distances r from
// where they should be: with u = r(y) - r(x), x the positions where the part was made,
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
    // Nodes of the part: x dim, the last three; which trace nodes they are, -1: none.
    std::vector<int> trace_node;
    std::vector<double> x, r, g;
    BlockCsr C;

    // whole: null where all places are prescribed: then u = y - x.
    explicit DirichletPart(const Dirichlet* whole) : whole_(whole) {}

    void add_value(const std::vector<double>& y, double& E) override;
    void add_gradient(const std::vector<double>& y, std::vector<double>& gradient) override;
    void add_hessian(const std::vector<double>& y, bool projected, BlockCsr& H) override;

private:
    const Dirichlet* whole_;
    std::vector<double> u_, force_, slope_;  // force: g + C u; slope: D, node x dim x dim

    void measure(const std::vector<double>& y);
};

}  // namespace almesh
