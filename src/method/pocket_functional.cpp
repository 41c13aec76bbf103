#include "method/pocket_functional.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/vector_ops.hpp"

namespace almesh {

PocketFunctional::PocketFunctional(const AugmentedFunctional& E, const std::vector<double>& x,
                                   const std::vector<char>& moves)
    : dim_(static_cast<int>(x.size() / moves.size())),
      distortion_(E.distortion.part(x, moves, node_)),
      C_(distortion_.hessian_pattern()) {
    std::vector<double> gradient(x.size(), 0.0);
    E.constraint.add_gradient(x, E.lambda, E.penalty, gradient);
    std::vector<int> row(moves.size(), -1);
    for (std::size_t i = 0; i < node_.size(); ++i) {
        row[node_[i]] = static_cast<int>(i);
        moves_.push_back(moves[node_[i]]);
        for (int a = 0; a < dim_; ++a) {
            const std::size_t of_mesh = static_cast<std::size_t>(node_[i]) * dim_ + a;
            start_.push_back(x[of_mesh]);
            g_.push_back(gradient[of_mesh]);
        }
    }
    E.constraint.add_hessian(E.penalty, C_, &row);
    u_.resize(start_.size());
    Cu_.resize(start_.size());
}

void PocketFunctional::write(const std::vector<double>& y, std::vector<double>& x) const {
    for (std::size_t i = 0; i < node_.size(); ++i)
        if (moves_[i]) std::copy_n(&y[i * dim_], dim_, &x[static_cast<std::size_t>(node_[i]) * dim_]);
}

// u and C u.
void PocketFunctional::multiply_displacement(const std::vector<double>& y) const {
    for (std::size_t i = 0; i < y.size(); ++i) u_[i] = y[i] - start_[i];
    multiply(C_, u_.data(), Cu_.data());
}

double PocketFunctional::energy(const std::vector<double>& y) const {
    const double value = distortion_.energy(y);
    if (!std::isfinite(value)) return value;
    multiply_displacement(y);
    return value + dot(g_, u_) + 0.5 * dot(u_, Cu_);
}

void PocketFunctional::gradient(const std::vector<double>& y, std::vector<double>& g) const {
    multiply_displacement(y);
    for (std::size_t i = 0; i < y.size(); ++i) g[i] = g_[i] + Cu_[i];
    distortion_.add_gradient(y, g);
    for (std::size_t i = 0; i < moves_.size(); ++i)
        if (!moves_[i]) std::fill_n(&g[i * dim_], dim_, 0.0);
}

void PocketFunctional::hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) const {
    H.value = C_.value;
    distortion_.add_hessian(y, kind, H);
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            if (moves_[i] && moves_[H.col[k]]) continue;
            std::fill_n(H.block(k), dim_ * dim_, 0.0);
            for (int a = 0; a < dim_ && i == H.col[k]; ++a) H.block(k)[a * dim_ + a] = 1;
        }
}

}  // namespace almesh
