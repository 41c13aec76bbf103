// E of functional.hpp restricted to some nodes: the parts of distortion and constraint that see them.
#include "method/local_functional.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace almesh {

LocalFunctional::LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x,
                                 const std::vector<char>& moves)
    : dim_(static_cast<int>(x.size() / moves.size())),
      distortion_(E.distortion.part(x, moves, node_)),
      constraint_(E.constraint.part(x, E.lambda, E.penalty, node_, distortion_->hessian_pattern())) {
    for (const int i : node_) {
        moves_.push_back(moves[i]);
        start_.insert(start_.end(), point(x, i, dim_), point(x, i, dim_) + dim_);
    }
}

void LocalFunctional::write(const std::vector<double>& y, std::vector<double>& x) const {
    for (std::size_t i = 0; i < node_.size(); ++i)
        if (moves_[i]) std::copy_n(&y[i * dim_], dim_, point(x, node_[i], dim_));
}

double LocalFunctional::energy(const std::vector<double>& y) const {
    double value = distortion_->energy(y);
    if (std::isfinite(value)) constraint_->add_value(y, value);
    return value;
}

void LocalFunctional::gradient(const std::vector<double>& y, std::vector<double>& g) const {
    std::fill(g.begin(), g.end(), 0.0);
    constraint_->add_gradient(y, g);
    distortion_->add_gradient(y, g);
    for (std::size_t i = 0; i < moves_.size(); ++i)
        if (!moves_[i]) std::fill_n(&g[i * dim_], dim_, 0.0);
}

void LocalFunctional::hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) const {
    std::fill(H.value.begin(), H.value.end(), 0.0);
    constraint_->add_hessian(y, H);
    distortion_->add_hessian(y, kind, H);
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            if (moves_[i] && moves_[H.col[k]]) continue;
            std::fill_n(H.block(k), dim_ * dim_, 0.0);
            for (int a = 0; a < dim_ && i == H.col[k]; ++a) H.block(k)[a * dim_ + a] = 1;
        }
}

}  // namespace almesh
