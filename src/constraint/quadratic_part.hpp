// A constraint whose functional C is quadratic in x, as a function of the positions of some nodes.
#pragma once
#include <cstddef>
#include <vector>

#include "constraint/constraint.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

// With u = y - x, x where the part was made, C is exactly g.u + u'Cu/2 up to a constant, g its gradient at x.
class QuadraticPart : public ConstraintPart {
public:
    std::vector<double> x, g;  // nodes of the part x dim
    BlockCsr C;

    void add_value(const std::vector<double>& y, double& E) override {
        multiply_displacement(y);
        E += dot(g, u_);
        E += 0.5 * dot(u_, Cu_);
    }
    void add_gradient(const std::vector<double>& y, std::vector<double>& gradient) override {
        multiply_displacement(y);
        for (std::size_t i = 0; i < y.size(); ++i) gradient[i] += g[i] + Cu_[i];
    }
    void add_hessian(const std::vector<double>&, bool, BlockCsr& H) override {
        for (std::size_t k = 0; k < H.value.size(); ++k) H.value[k] += C.value[k];
    }

private:
    std::vector<double> u_, Cu_;

    void multiply_displacement(const std::vector<double>& y) {
        u_.resize(y.size());
        Cu_.resize(y.size());
        for (std::size_t i = 0; i < y.size(); ++i) u_[i] = y[i] - x[i];
        multiply(C, u_.data(), Cu_.data());
    }
};

}  // namespace almesh
