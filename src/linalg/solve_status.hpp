// How a factorisation or a solve of A x = b ended: one enum for all of linalg/, from ILU(0) to LinearSolver.
#pragma once

namespace almesh {

enum class SolveStatus {
    success,                    // factored, or solved to the tolerance
    max_iterations,             // Krylov methods
    stagnated,                  // Krylov methods: StagnationTest, or the tolerance is below rounding
    breakdown,                  // a number is not finite, A is singular, or x does not satisfy the system
    indefinite_preconditioner,  // ILU(0): a pivot is not positive. A itself may be positive definite
    not_positive_definite,      // Cholesky: a pivot is not positive; conjugate gradients: p'Ap <= 0
    too_large                   // the Cholesky factor does not fit the memory
};

struct FactorResult {
    SolveStatus status;
    int bad_row = -1;           // block row of the first bad pivot in elimination order; -1 if there is none
    double diagonal_shift = 0;  // ILU(0): what is factored is A with its diagonal blocks times 1 + diagonal_shift
    bool ssor = false;          // the preconditioner is SSOR, not ILU(0)
};

// In the order of the enum: the name in history.csv, and the reason in messages.
inline constexpr const char* status_text[][2] = {
    {"success", "solved"},
    {"max_iterations", "too many iterations"},
    {"stagnated", "stagnated"},
    {"breakdown", "breakdown: the matrix is singular, or a number was not finite"},
    {"indefinite_preconditioner", "ILU(0) met a pivot that is not positive"},
    {"not_positive_definite", "the matrix is not positive definite"},
    {"too_large", "the factorisation takes more than the machine's memory"}};

inline const char* to_string(SolveStatus status) { return status_text[static_cast<int>(status)][0]; }
inline const char* reason(SolveStatus status) { return status_text[static_cast<int>(status)][1]; }

}  // namespace almesh
