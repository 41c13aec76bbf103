#include "method/local_functional.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"

namespace almesh {

LocalFunctional::LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, Restriction around,
                                 std::unique_ptr<DistortionEnergy> energy)
    : Functional(*energy),
      around_(std::move(around)),
      energy_(std::move(energy)),
      lambda_(E.lambda),
      constraint_(E.constraint.part(around_, lambda_)),
      E_(*energy_, *constraint_, lambda_, E.penalty),
      dim_(distortion.dim()),
      at_(at_nodes(around_.node, x, dim_)),
      to_(at_),
      g_(at_.size()),
      H_(distortion.hessian_pattern()) {}

std::unique_ptr<LocalFunctional> AugmentedFunctional::part(const std::vector<double>& x,
                                                           std::vector<char> moves) const {
    for (std::size_t i = 0; i < fixed.size(); ++i) moves[i] = moves[i] && !fixed[i];
    for (const PeriodicPairs::Pair& pair : distortion.pairs().pairs) moves[pair.slave] = moves[pair.master] = 0;
    Restriction around;
    auto energy = distortion.part(x, moves, around);
    return std::make_unique<LocalFunctional>(*this, x, std::move(around), std::move(energy));
}

std::unique_ptr<LocalFunctional> LocalFunctional::part(const std::vector<double>& y, std::vector<char> moves) const {
    moves.resize(around_.node.size(), 0);
    return E_.part(with_fixed(y, at_), std::move(moves));
}

void LocalFunctional::gradient(const std::vector<double>& y, std::vector<double>& g) const {
    E_.gradient(with_fixed(y, at_), g_);
    std::copy_n(g_.begin(), g.size(), g.begin());
}

// The rows and columns of H_ for nodes that move, which come first, in each row too.
BlockCsr LocalFunctional::hessian_pattern() const {
    BlockCsr H;
    H.n = nodes();
    H.d = dim_;
    H.row.assign(1, 0);
    for (int i = 0; i < nodes(); ++i) {
        const auto begin = H_.col.begin() + H_.row[i], end = H_.col.begin() + H_.row[i + 1];
        H.col.insert(H.col.end(), begin, std::lower_bound(begin, end, nodes()));
        H.row.push_back(H.blocks());
    }
    H.value.assign(H.col.size() * dim_ * dim_, 0.0);
    return H;
}

void LocalFunctional::hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H,
                              const Projection& projection) const {
    E_.hessian(with_fixed(y, at_), kind, H_, projection);
    parallel_for(nodes(), [&](int i) {
        std::copy_n(H_.block(H_.row[i]), H.block(H.row[i + 1]) - H.block(H.row[i]), H.block(H.row[i]));
    }, 50);
}

}  // namespace almesh
