// Newton's method with a line search for one subproblem of the augmented Lagrangian method: minimise E(x) for given
// multipliers and penalty until |grad E| <= omega (Nocedal & Wright, Numerical Optimization, ch. 3; the paper's sec.
// 3).
//
// Direction. Far from the minimum the Hessian is indefinite. Each step uses one of three matrices (HessianKind): the
// full Hessian, for quadratic convergence, after a step of length one or more, once the damping is small; the damped
// projected Hessian after a shortened step, and if the full one is not positive definite (found by Cholesky, by
// negative curvature or, before any factorisation, by its diagonal blocks) or gives no descent direction; the damping
// alone in the first step of a cold start, because the Hessian of (eta - 1)^2 vanishes at the identity.
//
// A direction along which nodes slide is a tangent: a second-order correction takes the boundary back onto the surface
// (Constraint::correct()), and where the step is cut then, what is inside as well, by the solution of another linear
// system.
//
// Around these lines, with formulas and sources: line_search.hpp, step_control.hpp (damping of the projected Hessian,
// how much of it is projected, tolerance of iterative linear solvers), local_elimination.hpp (of nodes that hold up the
// others), stopping_tests.hpp.
#pragma once
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/stopwatch.hpp"
#include "linalg/linear_solver.hpp"
#include "method/line_search.hpp"
#include "method/local_elimination.hpp"
#include "method/status.hpp"
#include "method/step_control.hpp"

namespace almesh {

struct Functional;

inline const char* to_string(HessianKind kind) {
    constexpr const char* names[] = {"full", "projected", "damping"};
    return names[static_cast<int>(kind)];
}

// The tolerance of |grad E| is max(min(omega, reduction |grad E| at the start), omega_star); a reduction of 1 does not
// lower it.
struct NewtonParams {
    double omega = 1e-8, reduction = 1, omega_star = 0;
    int max_iterations = 200;
    double largest_energy = std::numeric_limits<double>::infinity();  // above which a target may be out of reach
    double visible_gain = 0;  // least total decrease of E in several steps in a row; 0: no test
    double visible_part = 0;  // if not 0: that decrease as a fraction of the distortion energy
    HessianKind first = HessianKind::projected;  // of the first step
    bool cold_start = false;  // resets damping, filtering and elimination; the first step uses the damping alone
    bool from_coarser = false;  // x was interpolated from the solution of a coarser mesh or of a lower degree
    std::optional<double> least_gain = {};  // of a local minimisation: a smaller decrease of E makes a step the last,
    double most_work = std::numeric_limits<double>::infinity();  // and so does more work than this
};

// One row of the history: the step that led from one iterate to the next.
struct NewtonStep {
    int iteration = 0;         // 1, 2, ...
    double energy = 0;         // after the step
    double gradient_norm = 0;  // after the step
    bool has_direction = false;  // H d = -g gave one of descent
    double step_length = 0;    // t, see line_search.hpp; 0: there is none
    bool by_rounding = false;  // energies could not be compared
    int cuts_inverted = 0;     // trial lengths refused because an element was inverted
    int cuts_decrease = 0;     // trial lengths refused because E did not decrease enough
    HessianKind hessian = HessianKind::projected;
    bool is_last = false;      // of a local minimisation: it gained too little
    LocalElimination::Result local = {};  // of the local minimisation after the step
    int linear_iterations = 0;
    SolverKind solver = SolverKind::automatic;      // who made the direction
    PreconditionerKind preconditioner = PreconditionerKind::automatic;  // automatic: none
    double ilu_shift = 0;                           // of the diagonal in ILU(0), see Ilu0::factor()
    std::optional<SolveStatus> fallback = {};       // how an iterative solver failed before Cholesky took over
};

struct NewtonResult {
    Status status = Status::converged;
    int iterations = 0;
    int linear_iterations = 0;
    int local_steps = 0;  // of local eliminations
    double start_energy = 0;  // at the first x, or at the last refinement of the quadrature
    double energy = 0, gradient_norm = 0;
    double work = 0;   // of assembly, linear solves and local eliminations (local_elimination.hpp)
    double omega = 0;  // the tolerance that was used
};

// Policies that adapt to the steps. The defaults are for a whole mesh.
struct NewtonPolicies {
    Forcing forcing = Forcing::automatic;
    Damping damping = {};
    EigenvalueFiltering filtering = EigenvalueFiltering::of_mesh();
    LocalElimination elimination = {};

    static NewtonPolicies of_few_nodes(LocalElimination::Of of = LocalElimination::Of::nothing) {
        return {{}, Damping::none(), EigenvalueFiltering::of_few_nodes(), {of}};
    }
};

using NewtonObserver = std::function<void(const NewtonStep&)>;
// step: 1, 2, ... over all calls of minimise().
using IterateObserver = std::function<void(int step, const std::vector<double>& x)>;

class Newton {
public:
    // pattern: of the Hessian. The linear solver and all work arrays are set up once for all subproblems.
    Newton(BlockCsr pattern, const LinearSolverParams& linear, const NewtonPolicies& policies = {});

    // Called with every iterate that is accepted, of all calls of minimise().
    void observe_iterates(IterateObserver observer) { observe_iterate_ = std::move(observer); }

    void forget();  // what earlier steps have taught: then as on a whole mesh before any step

    const LinearSolver& linear_solver() const { return solver_; }
    Timings time;  // of all calls so far

    // x: node_count x dim; enters with finite energy, leaves as the last accepted iterate.
    NewtonResult minimise(const Functional& E, const NewtonParams& params, std::vector<double>& x,
                          const NewtonObserver& observe = {});

    // The predictor from x. to: x with the nodes `fixed` somewhere else; on return the others are where the model with
    // the Hessian of this kind has its minimum, H_II d_I = -(g_I + H_IB d_B), d = to - x. False where there is none.
    bool predict(const Functional& E, HessianKind kind, const std::vector<char>& fixed, const std::vector<double>& x,
                 std::vector<double>& to);

private:
    BlockCsr H_;
    LinearSolver solver_;
    std::vector<double> g_, minus_g_, d_, trial_, start_;
    HessianKind hessian_ = HessianKind::projected;  // of the next step
    ForcingTerm forcing_;
    Damping damping_;                // kept from one subproblem to the next,
    EigenvalueFiltering filtering_;  // and so is this
    LocalElimination elimination_;   // and this
    IterateObserver observe_iterate_;
    int steps_ = 0;  // of all calls

    NewtonResult start(const Functional& E, const NewtonParams& params, const std::vector<double>& x);
    bool refine_quadrature(const Functional& E, const std::vector<double>& x, NewtonResult& at);
    double gradient(const Functional& E, const std::vector<double>& x);
    bool find_direction(const Functional& E, const std::vector<double>& x, NewtonResult& at, NewtonStep& step);
    void search(const Functional& E, std::vector<double>& x, NewtonResult& at, NewtonStep& step);
    std::vector<double> correction_of_inside(const std::vector<double>& x, const Correction& correct, NewtonResult& at);
    std::vector<double> with_inside(const std::vector<char>& fixed, const std::vector<double>& g, std::vector<double> d,
                                    NewtonResult& at);
    bool filter_more(HessianKind& kind);
    void eliminate_locally(const Functional& E, double gained, std::vector<double>& x, NewtonResult& at,
                           NewtonStep& step);
    void report(const NewtonResult& at, const std::vector<double>& x, NewtonStep& step, const NewtonObserver& observe);
    void adapt(const NewtonStep& step, const NewtonResult& before, const NewtonResult& at);
};

}  // namespace almesh
