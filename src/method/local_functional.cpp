#include "method/local_functional.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

LocalFunctional::LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x,
                                 const std::vector<char>& moves)
    : ElementsAround(E.distortion, x, moves),
      Functional(*elements_),
      E_(E),
      x_(x),
      dim_(distortion.dim()),
      moving_(static_cast<int>(std::count(moves.begin(), moves.end(), 1))),
      place_(node_.begin(), node_.begin() + moving_),
      H_(distortion.hessian_pattern()) {
    constraint_ = E.constraint.part(x, E.lambda, E.penalty, node_, H_);
    for (const int i : node_) at_.insert(at_.end(), point(x, i, dim_), point(x, i, dim_) + dim_);
    to_ = at_;
    g_.resize(at_.size());
}

std::unique_ptr<LocalFunctional> AugmentedFunctional::part(const std::vector<double>& x,
                                                           std::vector<char> moves) const {
    for (std::size_t i = 0; i < fixed.size(); ++i) moves[i] = moves[i] && !fixed[i];
    return std::make_unique<LocalFunctional>(*this, x, moves);
}

std::unique_ptr<LocalFunctional> LocalFunctional::part(const std::vector<double>& y, std::vector<char> moves) const {
    std::vector<double> x = x_;
    std::vector<int> here(x.size() / dim_);
    std::vector<char> of_mesh(here.size(), 0);
    for (int i = 0; i < moving_; ++i) {
        std::copy_n(point(y, i, dim_), dim_, point(x, node_[i], dim_));
        of_mesh[node_[i]] = moves[i];
        here[node_[i]] = i;
    }
    auto inside = std::make_unique<LocalFunctional>(E_, x, of_mesh);
    for (int& i : inside->place_) i = here[i];
    return inside;
}

std::vector<double> LocalFunctional::read(const std::vector<double>& x) const {
    std::vector<double> y(offset(moving_, dim_));
    for (int i = 0; i < moving_; ++i) std::copy_n(point(x, place_[i], dim_), dim_, point(y, i, dim_));
    return y;
}

void LocalFunctional::write(const std::vector<double>& y, std::vector<double>& x) const {
    for (int i = 0; i < moving_; ++i) std::copy_n(point(y, i, dim_), dim_, point(x, place_[i], dim_));
}

const std::vector<double>& LocalFunctional::with_fixed(const std::vector<double>& y, std::vector<double>& all) const {
    std::copy(y.begin(), y.end(), all.begin());
    return all;
}

double LocalFunctional::energy(const std::vector<double>& y) const {
    double value = distortion.energy(with_fixed(y, at_));
    if (std::isfinite(value)) constraint_->add_value(at_, value);
    return value;
}

double LocalFunctional::distortion_energy(const std::vector<double>& y, double energy) const {
    double of_constraint = 0;
    constraint_->add_value(with_fixed(y, at_), of_constraint);
    return energy - of_constraint;
}

double LocalFunctional::valid_fraction(const std::vector<double>& y, const std::vector<double>& to) const {
    return distortion.valid_fraction(with_fixed(y, at_), with_fixed(to, to_));
}

void LocalFunctional::gradient(const std::vector<double>& y, std::vector<double>& g) const {
    std::fill(g_.begin(), g_.end(), 0.0);
    constraint_->add_gradient(with_fixed(y, at_), g_);
    distortion.add_gradient(at_, g_);
    std::copy_n(g_.begin(), g.size(), g.begin());
}

// The rows and columns of H_ of nodes that move: the first, in each row as well.
BlockCsr LocalFunctional::hessian_pattern() const {
    BlockCsr H;
    H.n = moving_;
    H.d = dim_;
    H.row.assign(1, 0);
    for (int i = 0; i < moving_; ++i) {
        const auto begin = H_.col.begin() + H_.row[i], end = H_.col.begin() + H_.row[i + 1];
        H.col.insert(H.col.end(), begin, std::lower_bound(begin, end, moving_));
        H.row.push_back(H.blocks());
    }
    H.value.assign(H.col.size() * dim_ * dim_, 0.0);
    return H;
}

void LocalFunctional::hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H,
                              const Projection& projection) const {
    fill(static_cast<int>(H_.value.size()), 0, H_.value.data());
    constraint_->add_hessian(with_fixed(y, at_), kind != HessianKind::full, H_);
    distortion.add_hessian(at_, kind, H_, projection);
    parallel_for(moving_, [&](int i) {
        std::copy_n(H_.block(H_.row[i]), H.block(H.row[i + 1]) - H.block(H.row[i]), H.block(H.row[i]));
    }, 50);
}

}  // namespace almesh
