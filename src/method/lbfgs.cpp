#include "method/lbfgs.hpp"

#include <algorithm>
#include <cmath>

#include "base/interrupt.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {
namespace {

constexpr double sufficient_fall = 1e-4;  // of Armijo's condition
constexpr int most_cuts = 30;

// The last differences of iterates and gradients: a ring with a place for the next one, which may be refused.
class Differences {
public:
    Differences(int memory, std::size_t size) : s_(memory + 1, std::vector<double>(size)), y_(s_), rho_(s_.size()) {}

    void clear() { count_ = 0; }
    bool empty() const { return count_ == 0; }

    void add(const std::vector<double>& z, const std::vector<double>& before, const std::vector<double>& g,
             const std::vector<double>& g_before) {
        const int next = (first_ + count_) % places();
        std::vector<double>&s = s_[next], &y = y_[next];
        for (std::size_t i = 0; i < z.size(); ++i) {
            s[i] = z[i] - before[i];
            y[i] = g[i] - g_before[i];
        }
        const double sy = dot(s, y);
        if (!(sy > 1e-10 * norm_2(s) * norm_2(y))) return;  // the function is not convex there
        rho_[next] = 1 / sy;
        if (count_ + 1 < places()) ++count_;
        else first_ = (first_ + 1) % places();
    }

    // d = -H g, H the approximation of the inverse of the Hessian.
    void direction(const std::vector<double>& g, std::vector<double>& d) const {
        std::vector<double>& alpha = alpha_;
        alpha.resize(count_);
        for (std::size_t i = 0; i < g.size(); ++i) d[i] = -g[i];
        for (int k = count_ - 1; k >= 0; --k) {
            const int at = (first_ + k) % places();
            alpha[k] = rho_[at] * dot(s_[at], d);
            axpy(-alpha[k], y_[at], d);
        }
        if (count_ > 0) {
            const int last = (first_ + count_ - 1) % places();
            const double gamma = 1 / (rho_[last] * dot(y_[last], y_[last]));
            for (double& value : d) value *= gamma;
        }
        for (int k = 0; k < count_; ++k) {
            const int at = (first_ + k) % places();
            axpy(alpha[k] - rho_[at] * dot(y_[at], d), s_[at], d);
        }
    }

private:
    std::vector<std::vector<double>> s_, y_;
    std::vector<double> rho_;
    mutable std::vector<double> alpha_;
    int first_ = 0, count_ = 0;

    int places() const { return static_cast<int>(s_.size()); }
};

}  // namespace

int minimise(SmoothFunction& f, const LbfgsParams& params, std::vector<double>& z) {
    const std::size_t size = z.size();
    std::vector<double> g(size), d(size), trial(size), g_trial(size);
    Differences differences(params.memory, size);
    double value = f.value(z, g), before_window = value;
    int iteration = 0;
    while (iteration < params.max_iterations && !interrupted()) {
        differences.direction(g, d);
        double slope = dot(g, d);
        if (!(slope < 0)) {
            if (differences.empty()) break;
            differences.clear();
            continue;
        }
        double t = differences.empty() ? params.first_step / norm_inf(d)
                                       : std::min(1.0, params.largest_step / norm_inf(d));
        double reached = 0;
        int cuts = 0;
        for (; cuts < most_cuts; ++cuts, t *= 0.5) {
            for (std::size_t i = 0; i < size; ++i) trial[i] = z[i] + t * d[i];
            f.retract(trial);
            reached = f.value(trial, g_trial);
            if (reached <= value + sufficient_fall * t * slope) break;
        }
        if (cuts == most_cuts) {
            if (differences.empty()) break;
            differences.clear();
            continue;
        }
        differences.add(trial, z, g_trial, g);
        z.swap(trial);
        g.swap(g_trial);
        value = reached;
        ++iteration;
        if (!f.accept(z)) break;
        if (iteration % params.window > 0) continue;
        if (!(before_window - value > params.least_fall * std::abs(value))) break;
        before_window = value;
    }
    return iteration;
}

}  // namespace almesh
