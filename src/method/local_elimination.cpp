// |g_i|^2 / (2 h_i) chooses the nodes, Newton's method minimises over them.
#include "method/local_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/vector_ops.hpp"
#include "method/eigenvalue_filtering.hpp"
#include "method/functional.hpp"
#include "method/line_search.hpp"
#include "method/local_functional.hpp"

namespace almesh {
namespace {

constexpr double part_of_nodes = 0.01, part_of_decrease = 0.9;
// Of the nodes with their neighbours at most: in 3D with their elements this is a quarter of the mesh, and more costs
// more than the steps that it saves. From a coarser mesh less is left to do, and curved elements are dear.
constexpr double largest_part[] = {1, 0.07}, largest_dear_part[] = {0.1, 0.05};
constexpr double inner_part = 0.1;  // of a local minimisation's nodes, over which it is minimised in turn
constexpr std::size_t layers = 2;
constexpr int steps_of_easy_problem = 10, steps_without = 12;
// Of the work over the whole mesh: no local minimisation begins when all have done more than the first part of it, and
// where each step is dear the one at hand ends at the second, a fifth of a run.
constexpr double most_work = 0.18, most_dear_work = 0.26;
constexpr double no_bound = std::numeric_limits<double>::infinity();
constexpr int most_steps = 30;
constexpr double local_tolerance = 1e-2;  // relative residual of iterative solvers
constexpr double worthwhile = 0.01;       // decrease of a local step, in units of that of the Newton step before
constexpr double part_of_gain = 1e-3;     // and of all local steps so far: less is not worth another
constexpr double set_up_work = 420;       // of a local functional and its solver, for each node of each element
constexpr double much_alone = 0.1;        // of what a Newton step gained, that nodes could reach alone

// Decrease of E that the node of each row could reach alone.
std::vector<double> reachable_decrease(const BlockCsr& H, const std::vector<double>& g) {
    std::vector<double> decrease(H.n);
    parallel_for(H.n, [&](int i) {
        const double *const block = H.block(H.find(i, i)), *const gi = &g[offset(H.node_of(i), H.d)];
        double trace = 0, squared = 0;
        for (int a = 0; a < H.d; ++a) {
            trace += block[a * H.d + a];
            squared += gi[a] * gi[a];
        }
        decrease[i] = 0.5 * squared * H.d / std::max(std::abs(trace), std::numeric_limits<double>::min());
    });
    return decrease;
}

// The first `count` of `rows` with `layers` of neighbours; false where they are more than `most`.
bool with_neighbours(const BlockCsr& H, const std::vector<int>& rows, int count, double most, std::vector<int>& found) {
    std::vector<char> is_found(H.n, 0);
    found.assign(rows.begin(), rows.begin() + count);
    for (const int i : found) is_found[i] = 1;
    for (std::size_t layer = 0, begin = 0, end = found.size(); layer < layers; ++layer, begin = end, end = found.size())
        for (; begin < end; ++begin)
            for (int k = H.row[found[begin]]; k < H.row[found[begin] + 1]; ++k)
                if (!std::exchange(is_found[H.col[k]], 1)) found.push_back(H.col[k]);
    return static_cast<double>(found.size()) <= most;
}

// Per node.
std::vector<char> choose_nodes(const BlockCsr& H, const std::vector<double>& g, double most_of_all) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    std::vector<int> order(H.n), found;
    std::iota(order.begin(), order.end(), 0);
    const int most = std::max(1, static_cast<int>(part_of_nodes * H.n));
    const auto is_first = [&](int i, int j) {
        return decrease[i] != decrease[j] ? decrease[i] > decrease[j] : H.node_of(i) < H.node_of(j);
    };
    std::partial_sort(order.begin(), order.begin() + most, order.end(), is_first);
    const double wanted = part_of_decrease * std::accumulate(decrease.begin(), decrease.end(), 0.0);
    int count = 0;
    for (double sum = 0; count < most && sum <= wanted; ++count) sum += decrease[order[count]];
    while (!with_neighbours(H, order, count, most_of_all * H.n, found) && count > 1) count = (count + 1) / 2;
    std::vector<char> chosen(H.n, 0);
    for (const int i : found) chosen[H.node_of(i)] = 1;
    return chosen;
}

// Newton's method for E over the nodes of `local`, with as much of the negative eigenvalues as the Hessian bears. No
// damping: a step that is cut costs little here.
class LocalMinimisation {
public:
    // least_gain: a step that decreases E by less is the last. work_left: so is one after which work() exceeds it.
    // inner: whether before a step there can be a minimisation over the few nodes that hold it up.
    LocalMinimisation(const AugmentedFunctional& E, LocalFunctional& local, double least_gain, double work_left,
                      bool inner)
        : E_(E), local_(local), least_gain_(least_gain), work_left_(work_left), inner_(inner) {}

    // x: of the mesh, in place. Returns the number of steps.
    int run(std::vector<double>& x) {
        y_ = local_.read(x);
        const int steps = minimise(x);
        local_.write(y_, x);
        return steps;
    }

    // Of assembly and linear solves, in passes over an entry of a matrix.
    double work() const { return work_; }

private:
    const AugmentedFunctional& E_;
    LocalFunctional& local_;
    double least_gain_, work_left_;
    bool inner_;
    double work_ = set_up_work * local_.distortion().nodes_in_elements();
    BlockCsr H_ = local_.hessian_pattern();
    LinearSolver solver_{H_.d, {.tolerance = local_tolerance}};
    EigenvalueFiltering filtering_ = EigenvalueFiltering::of_few_nodes();
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
            while (found.step_length == 0 && filtering_.kept > 0) {
                filtering_.weaken();
                found = search();
            }
            if (found.step_length == 0) return step;
            gained = energy_ - found.energy;
            energy_ = found.energy;
            if (gained <= least_gain_ || gained <= part_of_gain * (first - energy_)) return step + 1;
            if (work_ > work_left_) return step + 1;
            filtering_.after_step(found.step_length);
        }
        return most_steps;
    }

    LineSearchResult search() {
        const double part = filtering_.kept;
        work_ += local_.distortion().hessian_work();
        local_.hessian(y_, part == 1 ? HessianKind::full : HessianKind::projected, H_, {.kept_negative = part});
        const SolveResult solve = solver_.solve(H_, minus_g_, d_, part > 0);
        work_ += solve.work;
        if (solve.status != SolveStatus::success) return {};
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
        LocalMinimisation few(E_, inside, worthwhile * gained, work_left_ - work_, false);
        few.run(x);
        work_ += few.work_;
        trial_ = local_.read(x);
        const double found = local_.energy(trial_);
        if (!(found <= energy_)) return;
        energy_ = found;
        y_.swap(trial_);
        local_.gradient(y_, g_);
    }
};

}  // namespace

bool LocalElimination::is_due(int iteration, const BlockCsr& H, const std::vector<double>& g, double gained) {
    if (iteration == 1) state_.was_hard = state_.is_hard;
    state_.is_hard = state_.is_hard || iteration > steps_of_easy_problem;
    if (state_.work > most_work * state_.work_of_newton) return false;
    return state_.was_hard || iteration > steps_without || (from_coarser_ && holds_up(H, g, gained));
}

bool LocalElimination::holds_up(const BlockCsr& H, const std::vector<double>& g, double gained) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    return std::accumulate(decrease.begin(), decrease.end(), 0.0) > much_alone * gained;
}

LocalElimination::Result LocalElimination::eliminate(const AugmentedFunctional& E, const BlockCsr& H,
                                                     const std::vector<double>& g, double gained,
                                                     std::vector<double>& x, double& energy) {
    const bool is_dear = E.distortion.is_curved() || (from_coarser_ && H.d == 3);
    const double most = (is_dear ? largest_dear_part : largest_part)[H.d - 2];
    std::vector<char> chosen = choose_nodes(H, g, most);
    for (std::size_t i = 0; i < E.fixed.size(); ++i) chosen[i] = chosen[i] && !E.fixed[i];
    LocalFunctional local(E, x, chosen);
    Result result;
    result.nodes = static_cast<int>(std::count(chosen.begin(), chosen.end(), 1));
    std::vector<double> moved = x;
    const double work_left = is_dear ? most_dear_work * state_.work_of_newton - state_.work : no_bound;
    LocalMinimisation minimisation(E, local, worthwhile * gained, work_left, !is_dear);
    result.steps = minimisation.run(moved);
    state_.work += minimisation.work();
    if (E.distortion.take_over_refinements(local.distortion())) energy = E.energy(x);
    if (result.steps == 0) return result;
    const double found = E.energy(moved);
    if (!(found <= energy)) return result;  // a gain below rounding
    energy = found;
    x.swap(moved);
    return result;
}

}  // namespace almesh
