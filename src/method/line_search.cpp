// If E(x + t d) is infinite, t <- t / 2; if the way to x + t d is not valid, t <- half of its valid part; if E is too
// large, t <- the minimiser of the parabola through E(x), its slope and E(x + t d),
// t <- -t^2 slope / (2 (E(x + t d) - E(x) - t slope)), within [t / 10, t / 2] (Nocedal & Wright, sec. 3.5).
#include "method/line_search.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {
namespace {

constexpr double sufficient_decrease = 1e-4;  // c1
constexpr double smallest_step = 1e-14, largest_step = 64;
constexpr double shortest_cut = 1e-3;  // least factor, if hardly any part is valid
constexpr double smallest_cut_step = 1e-7;  // below: give up, since a finer quadrature may change d
constexpr double energy_rounding = 1e-14;  // relative error of a sum of element energies
constexpr double worth_lengthening = 2.0 / 3;  // of the predicted decrease

}  // namespace

LineSearchResult line_search(const EnergyFunction& E, const StepFunction& valid_fraction, double energy, double slope,
                             const std::vector<double>& d, std::vector<double>& x, std::vector<double>& trial,
                             const Correction& correct, double rounding_error) {
    const auto place = [&](double t) {
        for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] + t * d[i];
        if (correct) correct(t, trial);
    };
    const auto energy_at = [&](double t) {
        place(t);
        return E(trial);
    };
    LineSearchResult result;
    const double noise = std::max(energy_rounding * std::abs(energy), rounding_error);
    result.by_rounding = -slope <= noise;
    double t = 1, found = energy_at(t);
    const auto decreases = [&] {
        return found <= energy + sufficient_decrease * t * slope ||
               (result.by_rounding && t == 1 && std::abs(found - energy) <= noise);
    };
    for (;;) {
        if (!std::isfinite(found)) {
            ++result.cuts_inverted;
            t *= 0.5;
        } else if (decreases()) {
            const double valid = valid_fraction(x, trial);
            if (valid == 1) break;
            ++result.cuts_inverted;
            t *= std::max(0.5 * valid, shortest_cut);
            if (t < smallest_cut_step) return result;
        } else {
            ++result.cuts_decrease;
            const double parabola = -slope * t * t / (2 * (found - energy - t * slope));
            t = std::clamp(parabola, 0.1 * t, 0.5 * t);
        }
        if (!(t >= smallest_step)) return result;  // nor where the parabola overflows
        found = energy_at(t);
    }
    if (t == 1 && !result.by_rounding && energy - found > worth_lengthening * -slope)
        while (t < largest_step) {
            const double longer = energy_at(2 * t);
            if (!(longer < found) || valid_fraction(x, trial) < 1) break;
            found = longer;
            t *= 2;
        }
    place(t);
    x.swap(trial);
    result.step_length = t;
    result.energy = found;
    return result;
}

}  // namespace almesh
