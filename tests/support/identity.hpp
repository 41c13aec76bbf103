#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/krylov/krylov.hpp"

namespace almesh {

// M = I: no preconditioner.
class Identity final : public Preconditioner {
public:
    explicit Identity(int size) : rr_(size) {}

    FactorResult factor(const BlockCsr&) override { return {SolveStatus::success}; }
    double apply(const double* r, double* z) override {
        return rr_([=](int begin, int count) {
            std::copy_n(r + begin, count, z + begin);
            return dot_of_piece(count, r + begin, r + begin);
        });
    }

private:
    TeamSum rr_;
};

// |A x - b|_2 / |b|_2.
inline double relative_residual(const BlockCsr& A, const std::vector<double>& x, const std::vector<double>& b) {
    std::vector<double> r(b.size());
    multiply(A, x.data(), r.data());
    double rr = 0, bb = 0;
    for (std::size_t i = 0; i < b.size(); ++i) rr += (r[i] - b[i]) * (r[i] - b[i]), bb += b[i] * b[i];
    return std::sqrt(rr / bb);
}

// x by a Krylov method without preconditioner.
template <class Method>
KrylovResult plain(Method&& method, const BlockCsr& A, const std::vector<double>& b, std::vector<double>& x) {
    Identity none(A.size());
    return method.solve(A, none, b.data(), x.data());
}

}  // namespace almesh
