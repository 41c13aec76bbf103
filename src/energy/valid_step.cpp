// Batches of elements, one per lane -> least coefficients of b_0, ..., b_n -> bisection for lanes that are not cleared.
//
// Straight simplices with the Jacobians J and J':  b_0 = det J,  b_1 = cof J : J' / n,  b_n-1 = cof J' : J / n,
// b_n = det J'.
#include "energy/valid_step.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/element_jacobian.hpp"

namespace almesh {
namespace {

constexpr int time_bisections = 10;              // depth, of straight simplices,
constexpr int curved_bisections = 5;             // and of other elements
constexpr int space_bisections = 300;            // of one polynomial
constexpr int batches_per_task = 64;             // at most, of others few enough
constexpr int curved_tasks = 64;                 // for so many tasks: one of them may take long
constexpr double work = 20, curved_work = 1000;  // of an element, in simple operations
constexpr double much = 0.35;                    // deviation of the Jacobian of a bent element
constexpr double near_inversion = 0.1;           // ratio of the determinant to its mean
constexpr double small_deviation = 0.38;         // coefficients are at least 0.238 then, and their mean at most 1.82
constexpr double keeps = 0.2;                    // fraction of its least determinant that an element keeps in one step,
constexpr double nearest_inversion = 1e-6;       // and the least ratio that it can reach, far above rounding

// b: Bernstein coefficients on an interval of s, the first above the bound. Returns a length up to which the polynomial
// is above the bound: `length`, or short of the first crossing by at most a thousandth of the interval.
template <int n>
double positive_until(std::array<double, n + 1> b, double bound, double length = 1, int depth = time_bisections) {
    if (std::all_of(b.begin(), b.end(), [bound](double c) { return c > bound; })) return length;
    if (depth == 0) return 0;
    std::array<double, n + 1> right = b;  // de Casteljau at the middle: b keeps the left half
    for (int step = 1; step <= n; ++step) {
        for (int i = 0; i <= n - step; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
        b[step] = right[0];
    }
    const double half = 0.5 * length, left = positive_until<n>(b, bound, half, depth - 1);
    return left < half ? left : half + positive_until<n>(right, bound, half, depth - 1);
}

template <int n>
double straight_fraction(const int* const* node, int count, const std::vector<double>& from,
                         const std::vector<double>& to) {
    const Mat<n, Lanes> J0 = straight_jacobian<n>(node, from), J1 = straight_jacobian<n>(node, to);
    const Mat<n, Lanes> C0 = cofactor(J0), C1 = cofactor(J1);
    std::array<Lanes, n + 1> b{};
    for (int k = 0; k < n; ++k) {
        b[0] += C0[0][k] * J0[0][k];
        b[n] += C1[0][k] * J1[0][k];
        for (int a = 0; a < n; ++a) b[1] += (1.0 / n) * C0[a][k] * J1[a][k];
        for (int a = 0; a < n && n == 3; ++a) b[2] += (1.0 / n) * C1[a][k] * J0[a][k];
    }
    const Lanes bound = max(straight_rounding<n>(J0), straight_rounding<n>(J1));
    LaneBits positive = b[0] > bound;
    for (int k = 1; k <= n; ++k) positive &= b[k] > bound;
    double fraction = 1;
    for (int l = 0; l < count; ++l) {
        if (positive[l]) continue;
        std::array<double, n + 1> of_lane;
        for (int k = 0; k <= n; ++k) of_lane[k] = b[k][l];
        fraction = std::min(fraction, positive_until<n>(of_lane, bound[l]));
    }
    return fraction;
}

// Over the reference element; of a pyramid over its collapsed coordinates.
double mean(const JacobianBasis& basis, const double* b) {
    return std::accumulate(b, b + basis.jacobian.count, 0.0) / basis.jacobian.count;
}

// One element that needs bisection.
template <int n>
class SlowCheck {
public:
    SlowCheck(const JacobianBasis& basis, const int* node, const std::vector<double>& from,
              const std::vector<double>& to)
        : of_(basis), node_(node), from_(from), to_(to) {
        ElementJacobian<n, double> element(of_);
        place(0, element.position(0));
        element.compute(1);
        const double* const b = element.coefficients(0);
        const double average = mean(of_, b), coefficient = *std::min_element(b, b + of_.jacobian.count);
        const double least = coefficient >= near_inversion * average  // how large it is makes no difference then
                                 ? coefficient
                                 : polynomial_minimum(of_.jacobian, b, 0.001, space_bisections).lower;
        const double part = keeps * std::min(least, near_inversion * average);
        least_ = element.unit() * std::max(part, std::min(0.999 * least, nearest_inversion * average));
    }

    // The largest s found up to which it is valid from s0 to s1, if so at s0.
    double until(double s0, double s1, int depth) {
        if (valid_between(s0, s1)) return s1;
        if (depth == 0) return s0;
        const double middle = 0.5 * (s0 + s1), left = until(s0, middle, depth - 1);
        return left < middle ? left : until(middle, s1, depth - 1);
    }

    std::optional<Inversion> inversion;  // at the end of the step

private:
    const JacobianBasis& of_;
    const int* const node_;
    const std::vector<double>& from_;
    const std::vector<double>& to_;
    double least_;  // determinant that is wanted everywhere

    void place(double s, Vec<n>* x) const {
        for (int i = 0; i < of_.position.nodes; ++i) {
            const double* const x0 = point(from_, node_[i], n);
            const double* const x1 = point(to_, node_[i], n);
            for (int a = 0; a < n; ++a) x[i][a] = s == 1 ? x1[a] : x0[a] + s * (x1[a] - x0[a]);
        }
    }

    bool valid_between(double s0, double s1) {
        ElementJacobian<n, double> element(of_);
        place(s0, element.position(0));
        place(s1, element.position(1));
        element.compute(2);
        bool valid = element.has_frame();
        const double rounding = element.rounding(), bound = std::max(rounding, least_ / element.unit());
        for (int k = n; k >= 0 && valid; --k) {
            const double* const b = element.coefficients(k);
            valid = std::all_of(b, b + of_.jacobian.count, [](double c) { return std::isfinite(c); }) &&
                    compare_with(of_.jacobian, b, bound, space_bisections).lower > bound;
            if (k == n && s1 == 1 && !valid && !inversion) note_inversion(b, rounding);
        }
        return valid;
    }

    void note_inversion(const double* b, double rounding) {
        if (!std::isfinite(mean(of_, b))) return;
        const PolynomialMinimum least = polynomial_minimum(of_.jacobian, b, 0.5, space_bisections);
        inversion = {0, least.at, least.upper > rounding ? least.upper / mean(of_, b) : 0};
    }
};

// Lanes whose coefficients pass all bounds of SlowCheck, with twice its margin for rounding.
template <int n>
LaneBits cleared(const JacobianBasis& basis, const int* const* node, const std::vector<double>& from,
                 const std::vector<double>& to) {
    ElementJacobian<n, Lanes> elements(basis);
    const auto place = [&] {
        for (int i = 0; i < basis.position.nodes; ++i) {
            elements.position(0)[i] = gathered<n>(node, i, from);
            elements.position(1)[i] = gathered<n>(node, i, to);
        }
    };
    place();
    if (!basis.cell.is_simplex()) {
        const LaneBits small = elements.deviation(2) < small_deviation;
        if (!any(!small)) return small;
        place();
    }
    elements.compute(2);
    LaneBits clear = elements.has_frame();
    const auto all_above = [&](int k, Lanes bound) {
        for (int a = 0; a < basis.jacobian.count; ++a) clear &= elements.coefficients(k)[a] > bound;
    };
    const auto near = [&](int k) {
        Lanes sum{};
        for (int a = 0; a < basis.jacobian.count; ++a) sum += elements.coefficients(k)[a];
        return near_inversion / basis.jacobian.count * sum;
    };
    all_above(0, near(0));
    for (int k = 0; k <= n; ++k) all_above(k, max(2 * elements.rounding(), keeps * near(0)));
    return clear;
}

// node: the nodes of each lane; `first`: number of the first of the `count` elements.
template <int n>
double of_batch(const JacobianBasis* basis, const int* const* node, int count, const std::vector<double>& from,
                const std::vector<double>& to, int first, std::vector<Inversion>& inversions) {
    if (!basis) return straight_fraction<n>(node, count, from, to);
    double fraction = 1;
    const LaneBits clear = cleared<n>(*basis, node, from, to);
    for (int l = 0; l < count; ++l) {
        if (clear[l]) continue;
        SlowCheck<n> check(*basis, node[l], from, to);
        fraction = std::min(fraction, check.until(0, 1, curved_bisections));
        if (check.inversion) inversions.push_back({first + l, check.inversion->at, check.inversion->ratio});
    }
    return fraction;
}

}  // namespace

ValidStep::ValidStep(const CellType& cell, int degree) : dim_(cell.dim), element_nodes_(cell.node_count(degree)) {
    if (degree > 1 || !cell.is_simplex()) basis_ = std::make_shared<const JacobianBasis>(cell, degree);
}

double ValidStep::fraction(const std::vector<int>& node, int count, const std::vector<double>& from,
                           const std::vector<double>& to, std::vector<Inversion>& inversions) const {
    struct Task {
        double fraction = 1;
        std::vector<Inversion> inversions;
    };
    const int batches = basis_ ? std::clamp(count / (curved_tasks * lanes), 1, batches_per_task) : batches_per_task;
    const int task_size = batches * lanes;
    std::vector<Task> tasks((count + task_size - 1) / task_size);
    with_dimension(dim_, [&](auto n) {
        parallel_for_uneven(static_cast<int>(tasks.size()), [&](int t) {
            Task& task = tasks[t];
            for (int k = t * task_size; k < std::min(count, (t + 1) * task_size); k += lanes) {
                const int* of_lane[lanes];
                for (int l = 0; l < lanes; ++l) of_lane[l] = &node[offset(std::min(k + l, count - 1), element_nodes_)];
                const int in_use = std::min(lanes, count - k);
                task.fraction = std::min(task.fraction, of_batch<n>(basis_.get(), of_lane, in_use, from, to, k,
                                                                     task.inversions));
            }
        }, (basis_ ? curved_work : work) * task_size);
    });
    double fraction = 1;
    for (const Task& task : tasks) {
        fraction = std::min(fraction, task.fraction);
        inversions.insert(inversions.end(), task.inversions.begin(), task.inversions.end());
    }
    return fraction;
}

bool ValidStep::add_bent(const std::vector<int>& node, const std::vector<double>& x, std::vector<char>& bent) const {
    const int count = static_cast<int>(bent.size());
    const auto before = std::count(bent.begin(), bent.end(), 1);
    with_dimension(dim_, [&](auto n) {
        parallel_for((count + lanes - 1) / lanes, [&](int batch) {
            const int first = batch * lanes;
            const int* of_lane[lanes];
            for (int l = 0; l < lanes; ++l) of_lane[l] = &node[offset(std::min(first + l, count - 1), element_nodes_)];
            ElementJacobian<n, Lanes> elements(*basis_);
            for (int i = 0; i < basis_->position.nodes; ++i) elements.position(0)[i] = gathered<n>(of_lane, i, x);
            const LaneBits is_plain = elements.deviation(1) < much;
            for (int l = 0; l < std::min(lanes, count - first); ++l)
                if (!is_plain[l]) bent[first + l] = 1;
        }, work * lanes);
    });
    return std::count(bent.begin(), bent.end(), 1) > before;
}

}  // namespace almesh
