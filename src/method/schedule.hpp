// How Algorithm 1 of the paper goes on after a subproblem: the penalty mu and the tolerances omega, epsilon of the
// next.
//
//   paper     Algorithm 1 in the only consistent reading: penalty weight mu in E to match the update
//             lambda - mu c_D, tolerances that tighten as m grows, and both tests must hold at the end
//             (Nocedal & Wright, Numerical Optimization, Alg. 17.4).
//   literal   Algorithm 1 exactly as printed (penalty weight mu^2, the loop ends when one test holds, eps and omega
//             grow with m), for teaching: src/README.md tells what goes wrong.
//   adaptive  lambda after every subproblem; mu, large from the start, times 10 whenever |c_D| or the largest distance
//             of a node from its target fell by less than a factor 10; omega a tenth, and omega* once both hold. Needs
//             no mu0, omega0, epsilon0.
//
// method = penalty has a schedule of its own: lambda = 0, and mu_k+1 = 10 mu_k until the constraint holds.
//
// The penalty is given in units of |1|^2: mu |c_D|^2 = (mu / |1|^2) times the weighted integral of |phi - g_D|^2, and
// with the weight 1/h that integral scales like the distortion term, whatever the unit of length and the number of
// boundary faces. All lengths are in the unit the caller has chosen for x; see length_scale in the table of deck keys.
#pragma once
#include <limits>
#include <memory>

namespace almesh {

enum class Algorithm { adaptive, paper, literal };
enum class Continuation { automatic, never, always };  // of the boundary's motion, see continuation.hpp

// How a mesh is moved. penalty is there to be compared with the first; boundary_set (set_boundary.hpp) is not for decks.
enum class MovingMethod { augmented_lagrangian, penalty, boundary_set };

struct AugmentedLagrangianParams {
    MovingMethod moving = MovingMethod::augmented_lagrangian;
    Algorithm algorithm = Algorithm::adaptive;
    double mu0 = 1000;            // paper, literal, method penalty: first penalty, in units of |1|^2
    double omega0 = 1e-2;         // paper, literal: tolerance of |grad E| in the first subproblem
    double epsilon0 = 1e-3;       // paper, literal: tolerance of |P c_D|^2 that decides between the updates
    double omega_star = 1e-8;     // final tolerance of |grad E|
    double epsilon_star = 1e-16;  // final tolerance of |P c_D|^2
    double wall_tolerance = 1e-3;  // adaptive: of the distance of every boundary node from its target, in cell heights
    int max_iterations = 50;
    int max_newton_iterations = 200;
};

enum class AlUpdate { none, multipliers, penalty, both };
const char* to_string(AlUpdate update);

class Schedule {
public:
    virtual ~Schedule() = default;

    double mu = 0, omega = 0, epsilon = 0;            // mu_k, omega_k, epsilon_k
    double reduction = 1;                             // omega is lowered to this part of |grad E| at the start
    double least_omega = 0;                           // and never below this
    double wall_tolerance = std::numeric_limits<double>::infinity();  // see AugmentedLagrangianParams
    bool tests_reach = true;                          // whether the first subproblem may find the target out of reach
    virtual double penalty() const { return mu; }     // weight of |c_D|^2 / 2 in E
    virtual bool ends(bool constrained, bool stationary) const { return constrained && stationary; }  // not line 7
    // Lines 11-14: lambda has been updated. boundary_error: what wall_tolerance is for.
    virtual AlUpdate tighten(double squared_constraint, double boundary_error) = 0;
    virtual AlUpdate raise_penalty() = 0;                     // lines 17-20
};

// mu: first penalty, in units of |1|^2; 0: that of the schedule. squared_constraint: |P c_D|^2 at the start.
std::unique_ptr<Schedule> make_schedule(const AugmentedLagrangianParams& params, double mu, double one_squared,
                                        double squared_constraint);

}  // namespace almesh
