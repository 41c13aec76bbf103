// A quadratic form on the trace space as a function of the values of some trace nodes: with u the change of their
// values, v that of which M v is the gradient before it, and C = factor M,
//
//     g . u + 1/2 u' C u,   g = M v,   gradient with respect to u: force = g + C u.
#pragma once
#include <vector>

#include "constraint/trace_space.hpp"
#include "linalg/block_csr.hpp"

namespace almesh {

struct TracePart {
    std::vector<int> node, trace_node;  // of the part's nodes those on the boundary: their numbers in it, in the trace
    std::vector<double> g;              // of them, x dim
    BlockCsr C;                         // of them, d = 1: the same for each component
    std::vector<int> block;             // of each entry of C, its block in the Hessian

    // part: numbers in the mesh of the nodes of the part. pattern: of its Hessian.
    TracePart(const TraceSpace& trace, const std::vector<double>& v, double factor, const std::vector<int>& part,
              const BlockCsr& pattern);

    // Sets the force as well.
    double value(const std::vector<double>& u, std::vector<double>& force) const;
    void set_force(const std::vector<double>& u, std::vector<double>& force) const;

private:
    int dim_;
};

}  // namespace almesh
