// max over i of |g_i|^2 / (2 h_i) chooses the nodes, Newton's method without damping minimises over them.
#include "method/local_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/index.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/line_search.hpp"

namespace almesh {

LocalFunctional::LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x,
                                 const std::vector<char>& moves)
    : dim_(static_cast<int>(x.size() / moves.size())),
      distortion_(E.distortion.part(x, moves, node_)),
      H_(distortion_->hessian_pattern()) {
    constraint_ = E.constraint.part(x, E.lambda, E.penalty, node_, H_);
    for (const int i : node_) {
        moving_ += moves[i];
        start_.insert(start_.end(), point(x, i, dim_), point(x, i, dim_) + dim_);
    }
    at_ = to_ = start_;
    g_.resize(start_.size());
}

LocalFunctional::~LocalFunctional() = default;

std::vector<double> LocalFunctional::start() const {
    return {start_.begin(), start_.begin() + static_cast<std::ptrdiff_t>(moving_) * dim_};
}

void LocalFunctional::write(const std::vector<double>& y, std::vector<double>& x) const {
    for (int i = 0; i < moving_; ++i) std::copy_n(point(y, i, dim_), dim_, point(x, node_[i], dim_));
}

const std::vector<double>& LocalFunctional::with_held(const std::vector<double>& y, std::vector<double>& all) const {
    std::copy(y.begin(), y.end(), all.begin());
    return all;
}

double LocalFunctional::energy(const std::vector<double>& y) {
    double value = distortion_->energy(with_held(y, at_));
    if (std::isfinite(value)) constraint_->add_value(at_, value);
    return value;
}

double LocalFunctional::valid_fraction(const std::vector<double>& y, const std::vector<double>& to) {
    return distortion_->valid_fraction(with_held(y, at_), with_held(to, to_));
}

bool LocalFunctional::refine_quadrature() const { return distortion_->refine_quadrature(); }

void LocalFunctional::gradient(const std::vector<double>& y, std::vector<double>& g) {
    std::fill(g_.begin(), g_.end(), 0.0);
    constraint_->add_gradient(with_held(y, at_), g_);
    distortion_->add_gradient(at_, g_);
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

void LocalFunctional::hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H) {
    std::fill(H_.value.begin(), H_.value.end(), 0.0);
    constraint_->add_hessian(with_held(y, at_), kind != HessianKind::full, H_);
    distortion_->add_hessian(at_, kind, H_);
    for (int i = 0; i < moving_; ++i)
        std::copy_n(H_.block(H_.row[i]), H.block(H.row[i + 1]) - H.block(H.row[i]), H.block(H.row[i]));
}

namespace {

constexpr double part_of_nodes = 0.01, part_of_decrease = 0.9;
// Of the nodes with their neighbours at most: in 3D more than this is nearly the whole mesh. With a fifth, plates
// turned against each other take three times the steps. From a coarser mesh less is left to do, and curved elements are
// dear.
constexpr double largest_part[] = {1, 0.4}, largest_dear_part[] = {0.1, 0.05};
constexpr int layers = 2;
constexpr int most_steps = 30;
constexpr double local_tolerance = 1e-4;  // relative residual of iterative solvers
constexpr double worthwhile = 0.01;       // decrease of a local step, in units of that of the Newton step before
constexpr double part_of_gain = 1e-3;     // and of all local steps so far: less is not worth another
constexpr double much_alone = 0.1;        // of what a Newton step gained, that nodes could reach alone

// Decrease of E that each node could reach alone.
std::vector<double> reachable_decrease(const BlockCsr& H, const std::vector<double>& g) {
    std::vector<double> decrease(H.n);
    for (int i = 0; i < H.n; ++i) {
        const double* const block = H.block(H.find(H.row_of(i), H.row_of(i)));
        double trace = 0, squared = 0;
        for (int a = 0; a < H.d; ++a) {
            trace += block[a * H.d + a];
            squared += g[offset(i, H.d, a)] * g[offset(i, H.d, a)];
        }
        decrease[i] = 0.5 * squared * H.d / std::max(std::abs(trace), std::numeric_limits<double>::min());
    }
    return decrease;
}

std::vector<char> with_neighbours(const BlockCsr& H, const std::vector<char>& chosen) {
    std::vector<char> result = chosen;
    for (int i = 0; i < H.n; ++i)
        if (chosen[H.node_of(i)])
            for (int k = H.row[i]; k < H.row[i + 1]; ++k) result[H.node_of(H.col[k])] = 1;
    return result;
}

std::vector<char> choose_nodes(const BlockCsr& H, const std::vector<double>& g, double most_of_all) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    std::vector<int> order(H.n);
    std::iota(order.begin(), order.end(), 0);
    const int most = std::max(1, static_cast<int>(part_of_nodes * H.n));
    std::partial_sort(order.begin(), order.begin() + most, order.end(),
                      [&](int i, int j) { return decrease[i] != decrease[j] ? decrease[i] > decrease[j] : i < j; });
    const double wanted = part_of_decrease * std::accumulate(decrease.begin(), decrease.end(), 0.0);
    int count = 0;
    for (double sum = 0; count < most && sum <= wanted; ++count) sum += decrease[order[count]];
    for (;; count = (count + 1) / 2) {
        std::vector<char> chosen(H.n, 0);
        for (int k = 0; k < count; ++k) chosen[order[k]] = 1;
        for (int layer = 0; layer < layers; ++layer) chosen = with_neighbours(H, chosen);
        if (count == 1 || std::count(chosen.begin(), chosen.end(), 1) <= most_of_all * H.n) return chosen;
    }
}

// Newton's method on the part: the full Hessian after a full step, else the projected one. No damping: a step that is
// cut costs little here. least_gain: a step that decreases E by less is the last. Returns the number of steps; y:
// start, then the last iterate.
int minimise_locally(LocalFunctional& E, double least_gain, std::vector<double>& y) {
    BlockCsr H = E.hessian_pattern();
    LinearSolver solver(H.d, {.tolerance = local_tolerance});
    const auto energy_of = [&E](const std::vector<double>& at) { return E.energy(at); };
    const auto valid_fraction = [&E](const std::vector<double>& from, const std::vector<double>& to) {
        return E.valid_fraction(from, to);
    };
    std::vector<double> g(y.size()), minus_g(y.size()), d, trial(y.size());
    const auto step_with = [&](HessianKind kind, double energy) -> LineSearchResult {
        E.hessian(y, kind, H);
        if (solver.solve(H, minus_g, d).status != SolveStatus::success) return {};
        const double slope = dot(g, d);
        return slope < 0 ? line_search(energy_of, valid_fraction, energy, slope, d, y, trial) : LineSearchResult{};
    };
    double first = E.energy(y), energy = first;
    bool try_full = true;
    for (int step = 0; step < most_steps; ++step) {
        if (E.refine_quadrature()) first = energy = E.energy(y);
        E.gradient(y, g);
        for (std::size_t i = 0; i < g.size(); ++i) minus_g[i] = -g[i];
        LineSearchResult found;
        if (try_full) found = step_with(HessianKind::full, energy);
        if (found.step_length == 0) found = step_with(HessianKind::projected, energy);
        if (found.step_length == 0) return step;
        const double gained = energy - found.energy;
        energy = found.energy;
        if (gained <= least_gain || gained <= part_of_gain * (first - energy)) return step + 1;
        try_full = found.step_length >= 1;
    }
    return most_steps;
}

}  // namespace

bool LocalElimination::holds_up(const BlockCsr& H, const std::vector<double>& g, double gained) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    return std::accumulate(decrease.begin(), decrease.end(), 0.0) > much_alone * gained;
}

LocalElimination::Result LocalElimination::eliminate(const AugmentedFunctional& E, const BlockCsr& H,
                                                     const std::vector<double>& g, double gained,
                                                     std::vector<double>& x, double& energy) const {
    const bool is_dear = E.distortion.is_curved() || (from_coarser_ && H.d == 3);
    const double most = (is_dear ? largest_dear_part : largest_part)[H.d - 2];
    std::vector<char> chosen = choose_nodes(H, g, most);
    for (std::size_t i = 0; i < E.held.size(); ++i) chosen[i] = chosen[i] && !E.held[i];
    LocalFunctional local(E, x, chosen);
    std::vector<double> y = local.start();
    Result result;
    result.nodes = static_cast<int>(std::count(chosen.begin(), chosen.end(), 1));
    result.steps = minimise_locally(local, worthwhile * gained, y);
    if (E.distortion.take_over_refinements(local.distortion())) energy = E.energy(x);
    if (result.steps == 0) return result;
    local.write(y, x);
    const double found = E.energy(x);
    if (found <= energy) energy = found;
    else  // a gain below rounding
        local.write(local.start(), x);
    return result;
}

}  // namespace almesh
