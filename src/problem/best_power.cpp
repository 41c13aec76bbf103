#include "problem/best_power.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "check/scaled_jacobian.hpp"

namespace almesh {
namespace {

constexpr int lower_power = 8;

}  // namespace

Solve best_of_powers(const Solve& solve, std::FILE* out) {
    return [solve, out](const ProblemOptions& options, const Problem& problem) {
        if (options.distortion.objective != Objective::minimax || options.power) return solve(options, problem);
        const auto least = [&](const Solution& solution) {
            const double certified = certify(problem.mesh(), solution.x).min_scaled_jacobian;
            return std::min(certified, least_corner_jacobian(problem.mesh(), solution.x));
        };
        ProblemOptions with_lower = options;
        with_lower.power = lower_power;
        Solution lower = solve(with_lower, problem);
        if (lower.al.status == Status::interrupted) return lower;
        Solution full = solve(options, problem);
        if (lower.al.status != Status::converged || full.al.status == Status::interrupted) return full;
        const double of_lower = least(lower), of_full = least(full);
        std::fprintf(out, "least scaled Jacobian: %s with power = %d, %s with all powers\n",
                     rounded_down(of_lower, 4).c_str(), lower_power, rounded_down(of_full, 4).c_str());
        return full.al.status != Status::converged || of_lower > of_full ? lower : full;
    };
}

}  // namespace almesh
