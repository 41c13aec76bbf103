// How a factorisation or a solve of A x = b ended: one enum for all of linalg/, from ILU(0) to LinearSolver.
#pragma once

namespace almesh {

enum class SolveStatus {
    success,                    // factored, or solved to the tolerance
    max_iterations,             // Krylov methods
    stagnated,                  // Krylov methods: krylov/convergence.hpp, or the tolerance is below rounding
    breakdown,                  // a number is not finite, A is singular, or x does not satisfy the system
    indefinite_preconditioner,  // ILU(0): a pivot is not positive. A itself may be positive definite
    not_positive_definite,      // Cholesky: a pivot is not positive; conjugate gradients: p'Ap <= 0
    too_large                   // the Cholesky factor does not fit the memory
};

struct FactorResult {
    SolveStatus status;
    int bad_row = -1;           // block row of the first bad pivot in elimination order; -1 if there is none
    double diagonal_shift = 0;  // ILU(0): what is factored is A with its diagonal blocks times 1 + diagonal_shift
};

// The name in history.csv.
inline const char* to_string(SolveStatus status) {
    switch (status) {
        case SolveStatus::success: return "success";
        case SolveStatus::max_iterations: return "max_iterations";
        case SolveStatus::stagnated: return "stagnated";
        case SolveStatus::breakdown: return "breakdown";
        case SolveStatus::indefinite_preconditioner: return "indefinite_preconditioner";
        case SolveStatus::not_positive_definite: return "not_positive_definite";
        case SolveStatus::too_large: return "too_large";
    }
    return "";
}

// The same for people.
inline const char* reason(SolveStatus status) {
    switch (status) {
        case SolveStatus::success: return "solved";
        case SolveStatus::max_iterations: return "too many iterations";
        case SolveStatus::stagnated: return "stagnated";
        case SolveStatus::breakdown: return "breakdown: the matrix is singular, or a number was not finite";
        case SolveStatus::indefinite_preconditioner: return "ILU(0) met a pivot that is not positive";
        case SolveStatus::not_positive_definite: return "the matrix is not positive definite";
        case SolveStatus::too_large: return "the factorisation takes more than the machine's memory";
    }
    return "";
}

}  // namespace almesh
