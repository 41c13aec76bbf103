// Penalty alone: the multipliers stay zero, and mu is raised tenfold after every subproblem,
//
//     x_k = argmin E(x) with lambda = 0,   mu_k+1 = 10 mu_k,
//
// until the constraint holds as it does for the augmented Lagrangian method. |c_D| falls like 1 / mu, so that mu has to
// grow by as many orders of magnitude as |c_D| is to fall, and the Hessian's condition number with it (Nocedal &
// Wright, Numerical Optimization, sec. 17.1).
#include "method/schedule.hpp"

namespace almesh {
namespace {

class PenaltySchedule : public Schedule {
public:
    PenaltySchedule(const AugmentedLagrangianParams& params, double mu0) {
        mu = mu0;
        omega = least_omega = params.omega_star;
        wall_tolerance = params.wall_tolerance;
        epsilon = 0;  // the multipliers are never updated
    }
    AlUpdate tighten(double, double) override { return AlUpdate::none; }
    AlUpdate raise_penalty() override {
        mu *= 10;
        return AlUpdate::penalty;
    }
};

}  // namespace

std::unique_ptr<Schedule> make_penalty_schedule(const AugmentedLagrangianParams& params, double mu0) {
    return std::make_unique<PenaltySchedule>(params, mu0);
}

}  // namespace almesh
