// The parameters of the method: what a deck sets, with the defaults.
#pragma once
#include "linalg/linear_solver.hpp"
#include "method/forcing.hpp"

namespace almesh {

enum class Algorithm { adaptive, paper, literal };  // schedule.hpp

struct AugmentedLagrangianParams {
    Algorithm algorithm = Algorithm::adaptive;
    double mu0 = 1000;            // paper, literal: first penalty, in units of |1|^2
    double omega0 = 1e-2;         // paper, literal: tolerance of |grad E| in the first subproblem
    double epsilon0 = 1e-3;       // paper, literal: tolerance of |P c_D|^2 that decides between the updates
    double omega_star = 1e-8;     // final tolerance of |grad E|
    double epsilon_star = 1e-16;  // final tolerance of |P c_D|^2
    int max_iterations = 50;
    int max_newton_iterations = 200;
};

// How the method is run on every mesh.
struct MethodParams {
    AugmentedLagrangianParams schedule;
    LinearSolverParams linear;
    Forcing forcing = Forcing::automatic;
};

}  // namespace almesh
