// The schedule of Algorithm 1: the penalty mu and the tolerances omega, epsilon of the next subproblem.
//
//   paper     Algorithm 1 in the only consistent reading: penalty weight mu in E to match the update
//             lambda - mu c_D, tolerances that tighten as m grows, and both tests must hold at the end
//             (Nocedal & Wright, Numerical Optimization, Alg. 17.4).
//   literal   Algorithm 1 exactly as printed (penalty weight mu^2, the loop ends when one test holds, m0/m in place of
//             m/m0, so that eps and omega grow with m), for teaching: src/README.md tells what goes wrong.
//   adaptive  lambda after every subproblem; mu, large from the start, times 10 whenever |c_D| or the largest distance
//             of a node from its target fell by less than a factor 10; omega a tenth, and omega* once both hold. Needs
//             no mu0, omega0, epsilon0: prescribed positions are linear in x, so a large penalty makes no subproblem
//             less convex; the first subproblem is solved loosely, because the multipliers change the next one.
//
// method = penalty has a schedule of its own: lambda = 0, and mu_k+1 = 10 mu_k until the constraint holds. |c_D| falls
// like 1 / mu, so that mu has to grow by as many orders of magnitude as |c_D| is to fall, and the Hessian's condition
// number with it (Nocedal & Wright, Numerical Optimization, sec. 17.1).
//
// The penalty is given in units of |1|^2: mu |c_D|^2 = (mu / |1|^2) times the weighted integral of |phi - g_D|^2, and
// with the weight 1/h that integral scales like the distortion term, whatever the unit of length and the number of
// boundary faces. All lengths are in the unit the caller has chosen for x; see length_scale in the table of deck keys.
#pragma once
#include <cmath>
#include <limits>

namespace almesh {

enum class Algorithm { adaptive, paper, literal };
enum class Continuation { automatic, never, always };  // of the boundary's motion, see continuation.hpp

enum class MovingMethod { augmented_lagrangian, penalty };  // the latter for comparison

struct AugmentedLagrangianParams {
    MovingMethod moving = MovingMethod::augmented_lagrangian;
    Algorithm algorithm = Algorithm::adaptive;
    double mu0 = 1000;            // paper, literal, method penalty: first penalty, in units of |1|^2
    double omega0 = 1e-2;         // paper, literal: tolerance of |grad E| in the first subproblem
    double epsilon0 = 1e-3;       // paper, literal: tolerance of |P c_D|^2 that decides between the updates
    double omega_star = 1e-8;     // final tolerance of |grad E|
    double epsilon_star = 1e-16;  // final tolerance of |P c_D|^2
    double wall_tolerance = 1e-3;  // adaptive, penalty: of the distance of a node from its target, in cell heights
    int max_iterations = 50;
    int max_newton_iterations = 200;
};

enum class AlUpdate { none, multipliers, penalty, both };

inline const char* to_string(AlUpdate update) {
    constexpr const char* names[] = {"-", "lambda", "mu", "lambda+mu"};
    return names[static_cast<int>(update)];
}

class Schedule {
    static constexpr double m0 = 10;                // line 4
    static constexpr double first_penalty = 1e5;    // adaptive: in units of |1|^2
    AugmentedLagrangianParams params_;
    bool is_penalty_ = params_.moving == MovingMethod::penalty;
    bool is_adaptive_ = !is_penalty_ && params_.algorithm == Algorithm::adaptive;
    bool is_literal_ = !is_penalty_ && params_.algorithm == Algorithm::literal;
    double m_ = m0, mu0_;
    double constraint_before_;  // |P c_D|^2 of the subproblem before,
    double error_before_ = std::numeric_limits<double>::infinity();  // and its boundary error

public:
    double mu, omega = params_.omega0, epsilon = params_.epsilon0;    // mu_k, omega_k, epsilon_k
    double reduction = 1;                                             // omega is lowered to this part of |grad E| at
    double least_omega = is_literal_ ? 0 : params_.omega_star;        // the start, and never below this
    double wall_tolerance = std::numeric_limits<double>::infinity();  // see AugmentedLagrangianParams

    // first: penalty, in units of |1|^2; 0: that of the schedule. squared_constraint: |P c_D|^2 at the start.
    Schedule(const AugmentedLagrangianParams& params, double first, double one_squared, double squared_constraint)
        : params_(params),
          mu0_((first > 0 ? first : is_adaptive_ ? first_penalty : params.mu0) * one_squared),
          constraint_before_(squared_constraint),
          mu(mu0_) {
        if (is_penalty_) omega = params.omega_star, epsilon = 0;
        if (is_adaptive_) omega = 1e3 * params.omega_star, epsilon = wall_tolerance, reduction = 0.1;
        if (is_penalty_ || is_adaptive_) wall_tolerance = params.wall_tolerance;
    }

    bool tests_reach() const { return !is_literal_; }  // whether the first subproblem may find the target out of reach
    double penalty() const { return is_literal_ ? mu * mu : mu; }  // weight of |c_D|^2 / 2 in E, Eq. 6
    bool ends(bool constrained, bool stationary) const {           // not line 7
        return is_literal_ ? constrained || stationary : constrained && stationary;
    }

    // Lines 11-14, after the update of lambda. boundary_error: bounded by wall_tolerance.
    AlUpdate tighten(double squared_constraint, double boundary_error) {
        if (is_adaptive_) return tighten_adaptively(squared_constraint, boundary_error);
        if (is_penalty_) return AlUpdate::none;
        epsilon /= std::pow(m_, 0.9);     // 13
        omega /= is_literal_ ? mu : m_;   // 14
        return AlUpdate::multipliers;
    }

    AlUpdate raise_penalty() {
        if (is_penalty_) return mu *= 10, AlUpdate::penalty;
        if (is_adaptive_) return mu *= 10, AlUpdate::both;
        m_ *= 100;                                                        // 17
        const double growth = is_literal_ ? m0 / m_ : m_ / m0;
        mu = is_literal_ ? mu0_ / growth : mu0_ * growth;                 // 18
        epsilon = params_.epsilon0 / std::pow(growth, 0.1);               // 19
        omega = params_.omega0 / growth;                                  // 20
        return AlUpdate::penalty;
    }

private:
    // Where the constraint holds already only |grad E| has to follow, and the penalty stays.
    AlUpdate tighten_adaptively(double squared_constraint, double boundary_error) {
        const bool on_target = boundary_error <= wall_tolerance;
        const bool holds = squared_constraint <= params_.epsilon_star && on_target;
        const bool falls = squared_constraint <= 0.01 * constraint_before_ &&  // |c_D| by a factor ten
                           (on_target || boundary_error <= 0.1 * error_before_);
        constraint_before_ = squared_constraint;
        error_before_ = boundary_error;
        omega = holds ? params_.omega_star : 0.1 * omega;
        return holds || falls ? AlUpdate::multipliers : raise_penalty();
    }
};

}  // namespace almesh
