// Lines 4-6, 7, 11-14 and 17-20 of Algorithm 1, in three versions, and the penalty method.
#include "method/schedule.hpp"

#include <cmath>

namespace almesh {
namespace {

constexpr double m0 = 10;  // line 4

// m/m0 where m0/m is printed, so that the tolerances tighten.
class PaperSchedule : public Schedule {
public:
    PaperSchedule(const AugmentedLagrangianParams& p, double mu0_) : mu0(mu0_), omega0(p.omega0), epsilon0(p.epsilon0) {
        mu = mu0;
        omega = omega0;
        epsilon = epsilon0;
        least_omega = p.omega_star;
    }
    AlUpdate tighten(double, double) override {
        epsilon /= std::pow(m, 0.9);  // 13
        omega /= m;                   // 14
        return AlUpdate::multipliers;
    }
    AlUpdate raise_penalty() override {
        m *= 100;                                    // 17
        mu = mu0 * (m / m0);                         // 18
        epsilon = epsilon0 / std::pow(m / m0, 0.1);  // 19
        omega = omega0 / (m / m0);                   // 20
        return AlUpdate::penalty;
    }

protected:
    double m = m0, mu0, omega0, epsilon0;
};

class LiteralSchedule : public PaperSchedule {
public:
    LiteralSchedule(const AugmentedLagrangianParams& p, double mu0_) : PaperSchedule(p, mu0_) {
        least_omega = 0;
        tests_reach = false;
    }
    double penalty() const override { return mu * mu; }                                                      // Eq. 6
    bool ends(bool constrained, bool stationary) const override { return constrained || stationary; }        // 7
    AlUpdate tighten(double, double) override {
        epsilon /= std::pow(m, 0.9);  // 13
        omega /= mu;                  // 14
        return AlUpdate::multipliers;
    }
    AlUpdate raise_penalty() override {
        m *= 100;                                    // 17
        mu = mu0 / (m0 / m);                         // 18
        epsilon = epsilon0 / std::pow(m0 / m, 0.1);  // 19
        omega = omega0 / (m0 / m);                   // 20
        return AlUpdate::penalty;
    }
};

// Prescribed positions are linear in x, so a large penalty makes no subproblem less convex, and the boundary holds
// almost at once; the first subproblem is solved loosely, because the multipliers change the next one.
class AdaptiveSchedule : public Schedule {
public:
    static constexpr double first_penalty = 1e5;  // in units of |1|^2

    AdaptiveSchedule(const AugmentedLagrangianParams& p, double mu0, double squared_constraint)
        : omega_star(p.omega_star), epsilon_star(p.epsilon_star), before(squared_constraint) {
        mu = mu0;
        omega = 1e3 * omega_star;
        epsilon = std::numeric_limits<double>::infinity();  // lambda is updated after every subproblem
        reduction = 0.1;
        wall_tolerance = p.wall_tolerance;
        least_omega = omega_star;
    }
    // Where the constraint holds already only |grad E| has to follow, and the penalty stays.
    AlUpdate tighten(double squared_constraint, double boundary_error) override {
        const bool on_target = boundary_error <= wall_tolerance;
        const bool holds = squared_constraint <= epsilon_star && on_target;
        const bool falls = squared_constraint <= 0.01 * before &&  // |c_D| by a factor ten
                           (on_target || boundary_error <= 0.1 * error_before);
        before = squared_constraint;
        error_before = boundary_error;
        omega = holds ? omega_star : 0.1 * omega;
        return holds || falls ? AlUpdate::multipliers : raise_penalty();
    }
    AlUpdate raise_penalty() override {
        mu *= 10;
        return AlUpdate::both;
    }

private:
    double omega_star, epsilon_star;
    double before;  // squared constraint of the subproblem before,
    double error_before = std::numeric_limits<double>::infinity();  // and its boundary error
};

// The multipliers stay zero. |c_D| falls like 1 / mu, so that mu has to grow by as many orders of magnitude as |c_D| is
// to fall, and the Hessian's condition number with it (Nocedal & Wright, Numerical Optimization, sec. 17.1).
class PenaltySchedule : public Schedule {
public:
    PenaltySchedule(const AugmentedLagrangianParams& p, double mu0) {
        mu = mu0;
        omega = least_omega = p.omega_star;
        wall_tolerance = p.wall_tolerance;
        epsilon = 0;
    }
    AlUpdate tighten(double, double) override { return AlUpdate::none; }
    AlUpdate raise_penalty() override { return mu *= 10, AlUpdate::penalty; }
};

}  // namespace

const char* to_string(AlUpdate update) {
    switch (update) {
        case AlUpdate::none: return "-";
        case AlUpdate::multipliers: return "lambda";
        case AlUpdate::penalty: return "mu";
        case AlUpdate::both: return "lambda+mu";
    }
    return "";
}

std::unique_ptr<Schedule> make_schedule(const AugmentedLagrangianParams& params, double mu, double one_squared,
                                        double squared_constraint) {
    const double mu0 = (mu > 0 ? mu : params.mu0) * one_squared;
    if (params.moving == MovingMethod::penalty) return std::make_unique<PenaltySchedule>(params, mu0);
    if (params.algorithm == Algorithm::adaptive)
        return std::make_unique<AdaptiveSchedule>(
            params, (mu > 0 ? mu : AdaptiveSchedule::first_penalty) * one_squared, squared_constraint);
    if (params.algorithm == Algorithm::literal) return std::make_unique<LiteralSchedule>(params, mu0);
    return std::make_unique<PaperSchedule>(params, mu0);
}

}  // namespace almesh
