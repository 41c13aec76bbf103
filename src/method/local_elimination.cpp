// |g_i|^2 / (2 h_i) chooses the nodes, Newton's method minimises over them.
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
#include "method/local_functional.hpp"
#include "method/negative_part.hpp"

namespace almesh {
namespace {

constexpr double part_of_nodes = 0.01, part_of_decrease = 0.9;
// Of the nodes with their neighbours at most: in 3D more than this is nearly the whole mesh, and with a tenth Newton
// takes a third more steps. From a coarser mesh less is left to do, and curved elements are dear.
constexpr double largest_part[] = {1, 0.2}, largest_dear_part[] = {0.1, 0.05};
constexpr double inner_part = 0.1;  // of a local minimisation's nodes, over which it is minimised in turn
constexpr int layers = 2;
constexpr int most_steps = 30;
constexpr double local_tolerance = 1e-2;  // relative residual of iterative solvers
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

// Newton's method for E over the nodes of `local`, with as much of the negative eigenvalues as the Hessian bears. No
// damping: a step that is cut costs little here.
class LocalMinimisation {
public:
    // least_gain: a step that decreases E by less is the last. inner: whether before a step there can be a minimisation
    // over the few nodes that hold it up.
    LocalMinimisation(const AugmentedFunctional& E, LocalFunctional& local, double least_gain, bool inner)
        : E_(E), local_(local), least_gain_(least_gain), inner_(inner) {}

    // x: of the mesh, in place. Returns the number of steps.
    int run(std::vector<double>& x) {
        y_ = local_.read(x);
        const int steps = minimise(x);
        local_.write(y_, x);
        return steps;
    }

private:
    const AugmentedFunctional& E_;
    LocalFunctional& local_;
    double least_gain_;
    bool inner_;
    BlockCsr H_ = local_.hessian_pattern();
    LinearSolver solver_{H_.d, {.tolerance = local_tolerance}};
    NegativePart negative_part_;
    std::vector<double> y_, g_, minus_g_, d_, trial_;  // of the nodes that move
    double energy_ = 0;

    int minimise(std::vector<double>& x) {
        g_.resize(y_.size());
        minus_g_.resize(y_.size());
        trial_.resize(y_.size());
        energy_ = local_.energy(y_);
        double first = energy_, gained = 0;
        for (int step = 0; step < most_steps; ++step) {
            if (local_.refine_quadrature()) first = energy_ = local_.energy(y_);
            local_.gradient(y_, g_);
            if (inner_ && step > 0 && LocalElimination::holds_up(H_, g_, gained)) relax_inside(gained, x);
            for (std::size_t i = 0; i < g_.size(); ++i) minus_g_[i] = -g_[i];
            LineSearchResult found = search();
            while (found.step_length == 0 && negative_part_.value > 0) {
                negative_part_.weaken();
                found = search();
            }
            if (found.step_length == 0) return step;
            gained = energy_ - found.energy;
            energy_ = found.energy;
            if (gained <= least_gain_ || gained <= part_of_gain * (first - energy_)) return step + 1;
            negative_part_.after_step(found.step_length);
        }
        return most_steps;
    }

    LineSearchResult search() {
        const double part = negative_part_.value;
        local_.hessian(y_, part == 1 ? HessianKind::full : HessianKind::projected, H_, {.negative_part = part});
        if (solver_.solve(H_, minus_g_, d_, part > 0).status != SolveStatus::success) return {};
        const double slope = dot(g_, d_);
        if (!(slope < 0)) return {};
        const auto energy_of = [&](const std::vector<double>& at) { return local_.energy(at); };
        const auto valid_fraction = [&](const std::vector<double>& from, const std::vector<double>& to) {
            return local_.valid_fraction(from, to);
        };
        return line_search(energy_of, valid_fraction, energy_, slope, d_, y_, trial_);
    }

    // gained: by the step before.
    void relax_inside(double gained, std::vector<double>& x) {
        const std::vector<char> chosen = choose_nodes(H_, g_, inner_part);
        std::vector<char> moves(x.size() / H_.d, 0);
        for (int i = 0; i < H_.n; ++i) moves[local_.node(i)] = chosen[i];
        local_.write(y_, x);
        LocalFunctional inside(E_, x, moves);
        LocalMinimisation(E_, inside, worthwhile * gained, false).run(x);
        trial_ = local_.read(x);
        const double found = local_.energy(trial_);
        if (!(found <= energy_)) return;
        energy_ = found;
        y_.swap(trial_);
        local_.gradient(y_, g_);
    }
};

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
    const std::vector<double> start = local.read(x);
    Result result;
    result.nodes = static_cast<int>(std::count(chosen.begin(), chosen.end(), 1));
    std::vector<double> moved = x;
    result.steps = LocalMinimisation(E, local, worthwhile * gained, !is_dear).run(moved);
    if (E.distortion.take_over_refinements(local.distortion())) energy = E.energy(x);
    if (result.steps == 0) return result;
    local.write(local.read(moved), x);
    const double found = E.energy(x);
    if (found <= energy) energy = found;
    else  // a gain below rounding
        local.write(start, x);
    return result;
}

}  // namespace almesh
