#pragma once
#include <algorithm>

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

}  // namespace almesh
