// When Newton's method ends, besides at |grad E| <= omega.
//
// Out of reach, of functionals without multipliers: a mesh that meets the target has the energy of its distortion
// alone, which is not less than the minimum of E. Where that minimum is above `largest_energy` and nine tenths of it
// are penalty, only meshes of no use could meet the target on this way. The minimum counts as found to 0.1 % once a
// full step gains less than that. What the penalty makes of the best approximation error is in every E, and not
// counted.
//
// Attainable accuracy: with a large penalty, |grad E| cannot fall below some 1e-16 mu, and once the decrease that a
// step promises is below the rounding error of E, energies can no longer be compared (line_search.hpp). From then on
// the iteration goes on only while each step halves |grad E|.
//
// Futile steps: several steps in a row have almost no length and no gain, because a node is stuck at a kink of its
// surface or elements block each other.
//
// Invisible steps: if nodes slide and nothing else holds the mesh, E hardly changes along some directions: a disc can
// rotate, and in 2D every conformal map of the disc onto itself keeps eta. After three full steps in a row, or twelve
// short ones, whose total gain is negligible, the multipliers are updated first; once the constraint holds, Algorithm 1
// goes on without this test.
//
// Local minimisations (local_elimination.hpp) need no minimum: their last step is one that gains too little for
// another, or takes them beyond the work that they may do.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/interrupt.hpp"
#include "method/functional.hpp"
#include "method/newton.hpp"

namespace almesh {

class StoppingTests {
    static constexpr double short_step = 1e-8, unchanged = 1e-14;  // unchanged: relative difference of two energies
    static constexpr int most_futile_steps = 3;
    static constexpr double most_invisible = 3, shortest_invisible = 0.25;  // together; what a shorter step counts as
    static constexpr double part_of_gain = 1e-3;  // of all steps so far: a local step with less is not worth another

    const NewtonParams& params_;
    int futile_steps_ = 0;  // in a row
    double invisible_gain_ = 0, invisible_length_ = 0;  // of the steps since the last visible gain

    static bool is_finite(const NewtonResult& at) {
        return std::isfinite(at.energy) && std::isfinite(at.gradient_norm);
    }

public:
    explicit StoppingTests(const NewtonParams& params) : params_(params) {}

    // Whether a minimisation ends, and how, before a step from the iterate `at`.
    std::optional<Status> before_step(const NewtonResult& at) const {
        if (at.gradient_norm <= at.omega) return Status::converged;
        if (!is_finite(at)) return Status::overflow;
        if (at.iterations == params_.max_iterations) return Status::max_newton_iterations;
        if (interrupted()) return Status::interrupted;
        return std::nullopt;
    }

    // Whether the step from `before` to `at` is the last of a local minimisation.
    bool is_last(const NewtonResult& before, const NewtonResult& at) const {
        if (!params_.least_gain) return false;
        const double gained = before.energy - at.energy;
        return gained <= *params_.least_gain || gained <= part_of_gain * (at.start_energy - at.energy) ||
               at.work > params_.most_work || at.iterations == params_.max_iterations;
    }

    // Whether a minimisation ends, and how, after a step from `before` to `at`.
    std::optional<Status> after_step(const NewtonStep& step, const NewtonResult& before, const NewtonResult& at,
                                     const Functional& E, const std::vector<double>& x) {
        if (!step.has_direction) return Status::linear_solver_failed;
        if (step.step_length == 0) return Status::line_search_failed;
        if (params_.least_gain) return step.is_last ? std::optional(Status::converged) : std::nullopt;
        const double gained = before.energy - at.energy;
        const bool moves = step.step_length > short_step || gained > unchanged * std::abs(at.energy);
        futile_steps_ = moves ? 0 : futile_steps_ + 1;
        if (futile_steps_ == most_futile_steps) return Status::line_search_failed;
        if (!is_finite(at)) return Status::overflow;
        invisible_gain_ += gained;
        invisible_length_ += std::clamp(step.step_length, shortest_invisible, 1.0);
        const double visible = params_.visible_part > 0 ? params_.visible_part * E.distortion_energy(x, at.energy)
                                                        : params_.visible_gain;
        if (invisible_gain_ >= visible) invisible_gain_ = invisible_length_ = 0;
        if (visible > 0 && invisible_length_ >= most_invisible && at.gradient_norm > at.omega)
            return Status::no_visible_gain;
        if (at.energy > params_.largest_energy && step.step_length >= 1) {
            const double lost = E.lost_energy(x), energy = at.energy - lost;
            if (energy > params_.largest_energy && before.energy - lost - energy < 1e-3 * energy &&
                E.distortion_energy(x, at.energy) < 0.1 * energy)
                return Status::stalled;
        }
        if (step.by_rounding && at.gradient_norm > 0.5 * before.gradient_norm && at.gradient_norm > at.omega)
            return Status::attainable_accuracy;
        return std::nullopt;
    }
};

}  // namespace almesh
