// |g_i|^2 / (2 h_i) chooses the nodes, Newton's method minimises over them.
#include "method/local_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "method/local_functional.hpp"
#include "method/newton.hpp"

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
constexpr int most_steps = 30;
constexpr double local_tolerance = 1e-2;  // relative residual of iterative solvers
constexpr double worthwhile = 0.01;       // decrease of a local step, in units of that of the Newton step before
constexpr double set_up_work = 420;       // of a local functional and its solver, for each node of each element
constexpr double much_alone = 0.1;        // of what a Newton step gained, that nodes could reach alone

// Decrease of E that the node of each row could reach alone.
std::vector<double> reachable_decrease(const BlockCsr& H, const std::vector<double>& g) {
    std::vector<double> decrease(H.n);
    parallel_for(H.n, [&](int i) {
        const double *const block = H.diagonal(i), *const gi = &g[offset(H.node_of(i), H.d)];
        double trace = 0, squared = 0;
        for (int a = 0; a < H.d; ++a) {
            trace += block[a * H.d + a];
            squared += gi[a] * gi[a];
        }
        decrease[i] = 0.5 * squared * H.d / std::max(std::abs(trace), std::numeric_limits<double>::min());
    });
    return decrease;
}

// local: the first `count` of `rows` with `layers` of neighbours in H's rows; false if they are more than `most`.
bool with_neighbours(const BlockCsr& H, const std::vector<int>& rows, int count, double most, std::vector<int>& local) {
    std::vector<char> is_local(H.n, 0);
    local.assign(rows.begin(), rows.begin() + count);
    for (const int i : local) is_local[i] = 1;
    for (std::size_t layer = 0, begin = 0, end = local.size(); layer < layers; ++layer, begin = end, end = local.size())
        for (; begin < end; ++begin)
            for (int k = H.row[local[begin]]; k < H.row[local[begin] + 1]; ++k)
                if (!std::exchange(is_local[H.col[k]], 1)) local.push_back(H.col[k]);
    return static_cast<double>(local.size()) <= most;
}

// Per node.
std::vector<char> choose_nodes(const BlockCsr& H, const std::vector<double>& g, double most_of_all) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    std::vector<int> order(H.n), local;
    std::iota(order.begin(), order.end(), 0);
    const int most = std::max(1, static_cast<int>(part_of_nodes * H.n));
    const auto is_first = [&](int i, int j) {
        return decrease[i] != decrease[j] ? decrease[i] > decrease[j] : H.node_of(i) < H.node_of(j);
    };
    std::partial_sort(order.begin(), order.begin() + most, order.end(), is_first);
    const double wanted = part_of_decrease * std::accumulate(decrease.begin(), decrease.end(), 0.0);
    int count = 0;
    for (double sum = 0; count < most && sum <= wanted; ++count) sum += decrease[order[count]];
    while (!with_neighbours(H, order, count, most_of_all * H.n, local) && count > 1) count = (count + 1) / 2;
    std::vector<char> chosen(H.n, 0);
    for (const int i : local) chosen[H.node_of(i)] = 1;
    return chosen;
}

}  // namespace

bool LocalElimination::is_due(int iteration, const BlockCsr& H, const std::vector<double>& g, double gained) {
    if (of != Of::mesh) return of == Of::few_nodes && holds_up(H, g, gained);
    if (iteration == 1) was_hard = is_hard;
    is_hard = is_hard || iteration > steps_of_easy_problem;
    if (work > most_work * work_of_newton) return false;
    return was_hard || iteration > steps_without || (from_coarser && holds_up(H, g, gained));
}

bool LocalElimination::holds_up(const BlockCsr& H, const std::vector<double>& g, double gained) {
    const std::vector<double> decrease = reachable_decrease(H, g);
    return std::accumulate(decrease.begin(), decrease.end(), 0.0) > much_alone * gained;
}

LocalElimination::Result LocalElimination::eliminate(const Functional& E, const BlockCsr& H,
                                                     const std::vector<double>& g, double gained,
                                                     std::vector<double>& x, double& energy) {
    const bool is_dear = E.distortion.is_curved() || (from_coarser && H.d == 3);
    const double most = of == Of::mesh ? (is_dear ? largest_dear_part : largest_part)[H.d - 2] : inner_part;
    const std::unique_ptr<LocalFunctional> local = E.part(x, choose_nodes(H, g, most));
    Result result;
    result.nodes = local->nodes();
    if (result.nodes == 0) return result;  // those chosen are fixed, or on periodic sides
    result.work = set_up_work * local->distortion.nodes_in_elements();
    NewtonParams params{.omega = 0, .max_iterations = most_steps, .least_gain = worthwhile * gained};
    if (is_dear) params.most_work = most_dear_work * work_of_newton - work - result.work;
    NewtonPolicies policies = NewtonPolicies::of_few_nodes(of == Of::mesh && !is_dear ? Of::few_nodes : Of::nothing);
    policies.forcing = Forcing::fixed;
    // Where half of H is stored memory is short: a factor of a part may take more than H.
    Newton newton(local->hessian_pattern(), {.tolerance = local_tolerance, .fallback = !H.in_half()}, policies);
    std::vector<double> y = local->read(x), moved = x;
    result.work += newton.minimise(*local, params, y, [&](const NewtonStep&) { ++result.steps; }).work;
    local->write(y, moved);
    work += result.work;
    if (of == Of::mesh && E.distortion.take_over_refinements(local->distortion)) energy = E.energy(x);
    if (result.steps == 0) return result;
    const double found = E.energy(moved);
    if (!(found <= energy)) return result;  // a gain below rounding
    energy = found;
    x.swap(moved);
    return result;
}

}  // namespace almesh
