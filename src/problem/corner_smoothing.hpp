// What raises the least scaled Jacobian of a mesh beyond where the least distortion has it: users look at that.
//
// At the corners of simplices (check/scaled_jacobian.hpp), with s there and s_0 the least of them,
//
//     E_p(x) = sum (s_0 / s)^p + 0.03 (s_0 / s)^2,   p = 8, 16, 32, 64,
//
// nearly counts the worst corners, and its minimum is near the largest s_0; the square keeps the others good. (Freitag
// and Ollivier-Gooch, Int. J. Numer. Meth. Eng. 40, 1997, raise the worst corner around one node at a time.) The free
// nodes of elements with s < s_0 + 0.15 (1 - s_0) move, all at once, by Newton's method with the Hessian of
// exp(-p log s) without that of log s.
//
// The best worst distortion, objective = minimax, is not always where the least scaled Jacobian is largest. In
// tetrahedra it mostly is so at a lower power of the p-norm continuation: two are tried, where the deck gives none.
#pragma once
#include <cstdio>
#include <vector>

#include "energy/distortion_energy.hpp"
#include "linalg/linear_solver.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

struct CornerSmoothing {
    double before, after;  // the least of elements with a free node
    int newton_steps = 0;
};

// x: node_count x dim, a valid mesh of simplices of degree 1; becomes better, or stays. fixed: per node, the others are
// free. energy: of the mesh, for what Newton's method counts.
CornerSmoothing smooth_corners(const Mesh& mesh, const std::vector<char>& fixed, DistortionEnergy& energy,
                               const LinearSolverParams& linear, std::vector<double>& x);

// Of the solutions with the two powers the one with the larger least scaled Jacobian.
Solution best_of_powers(const ProblemOptions& options, const Problem& problem, const Solve& solve, std::FILE* out);

}  // namespace almesh
