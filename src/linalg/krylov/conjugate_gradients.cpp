// With q = A p, z = M^{-1} r:
//     alpha = r'z / p'q,  x += alpha p,  r -= alpha q,  beta = new r'z / old r'z,  p = z + beta p  (q = A z + beta q).
// The recurrence for r drifts from b - A x, which is therefore computed at the end; where it misses the tolerance, the
// iteration starts again from there.
#include "linalg/krylov/krylov.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace almesh {

double Preconditioner::apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az) {
    const double rz = apply(r, z);
#pragma omp for schedule(static)
    for (int i = 0; i < A.n; ++i) multiply_rows(A, i, i + 1, z, Az);
    return rz;
}

ConjugateGradients::ConjugateGradients(int size, const KrylovParams& params)
    : size_(size),
      params_(params),
      r_(size),
      z_(size),
      p_(size),
      q_(size),
      Az_(size),
      pq_(size),
      true_pq_(size),
      rr_(size),
      true_rr_(size) {}

// r = b - A x; returns |r|.
double ConjugateGradients::residual(const BlockCsr& A, const double* b, const double* x) {
    return std::sqrt(true_rr_([&](int i, int count) {
        multiply_rows(A, i / A.d, (i + count) / A.d, x, q_.data());
        for (int k = i; k < i + count; ++k) r_[k] = b[k] - q_[k];
        return dot_of_piece(count, r_.data() + i, r_.data() + i);
    }));
}

// p = z + beta p with z = M^{-1} r, beta = r'z / rz_before, and p = z where rz_before is 0; q likewise with A z.
// Returns r'z.
double ConjugateGradients::next_direction(const BlockCsr& A, Preconditioner& M, double rz_before) {
    const double rz = M.apply_and_multiply(A, r_.data(), z_.data(), Az_.data());
    const double beta = rz_before != 0 ? rz / rz_before : 0;
#pragma omp for schedule(static)
    for (int i = 0; i < size_; ++i) {
        p_[i] = beta != 0 ? z_[i] + beta * p_[i] : z_[i];  // at first p is undefined
        q_[i] = beta != 0 ? Az_[i] + beta * q_[i] : Az_[i];
    }
    return rz;
}

// q = A p; returns p'q.
double ConjugateGradients::multiply_direction(const BlockCsr& A) {
    return true_pq_([&](int i, int count) {
        multiply_rows(A, i / A.d, (i + count) / A.d, p_.data(), q_.data());
        return dot_of_piece(count, p_.data() + i, q_.data() + i);
    });
}

// Iterates from the current x, r and p, r'z = rz, until the recurrence for r is down to the targets of |r| and of
// r'M^{-1}r.
SolveStatus ConjugateGradients::cycle(const BlockCsr& A, Preconditioner& M, double r_norm, double rz,
                                      double r_target, double rz_target, int& iterations, double* x) {
    StagnationTest progress{r_norm};
    for (;;) {
        if (!std::isfinite(rz)) return SolveStatus::breakdown;
        if (r_norm <= r_target && rz <= rz_target) return SolveStatus::success;
        if (iterations == params_.max_iterations) return SolveStatus::max_iterations;
        double pq = pq_([&](int i, int count) { return dot_of_piece(count, p_.data() + i, q_.data() + i); });
        if (!(pq > 0)) pq = multiply_direction(A);
        ++iterations;
        if (!std::isfinite(pq)) return SolveStatus::breakdown;
        if (pq <= 0) return SolveStatus::not_positive_definite;
        const double alpha = rz / pq;
        r_norm = std::sqrt(rr_([&](int i, int count) {
            for (int k = i; k < i + count; ++k) {
                x[k] += alpha * p_[k];
                r_[k] -= alpha * q_[k];
            }
            return dot_of_piece(count, r_.data() + i, r_.data() + i);
        }));
        if (progress.stagnates(r_norm) && iterations >= params_.patience) return SolveStatus::stagnated;
        rz = next_direction(A, M, rz);
    }
}

KrylovResult ConjugateGradients::solve_in_team(const BlockCsr& A, Preconditioner& M, const double* b, double* x) {
    const double b_norm = std::sqrt(rr_([&](int i, int count) {
        std::fill_n(x + i, count, 0.0);
        std::copy_n(b + i, count, r_.data() + i);
        return dot_of_piece(count, b + i, b + i);
    }));
    if (!std::isfinite(b_norm)) return {SolveStatus::breakdown, 0, b_norm};
    if (b_norm == 0) return {SolveStatus::success, 0, 0};
    const double r_target = params_.tolerance * b_norm;
    double r_norm = b_norm, rz_target = -1;
    for (int iterations = 0;;) {
        const double corrected = M.correct_start(r_.data(), x);  // r'y with y what x has changed by
        if (corrected != 0) r_norm = residual(A, b, x);
        const double rz = next_direction(A, M, 0);
        if (rz_target < 0) rz_target = params_.tolerance * params_.tolerance * (rz + corrected);
        const SolveStatus end = cycle(A, M, r_norm, rz, r_target, rz_target, iterations, x);
        const double before = r_norm;
        r_norm = residual(A, b, x);
        if (!std::isfinite(r_norm)) {
#pragma omp for schedule(static)
            for (int i = 0; i < size_; ++i) x[i] = 0;
            return {SolveStatus::breakdown, iterations, 1};
        }
        const double relative = r_norm / b_norm;
        if (end != SolveStatus::success || r_norm <= r_target) return {end, iterations, relative};
        if (r_norm > 0.5 * before) return {SolveStatus::stagnated, iterations, relative};
    }
}

KrylovResult ConjugateGradients::solve(const BlockCsr& A, Preconditioner& M, const double* b, double* x) {
    KrylovResult result{};
#pragma omp parallel if (size_ >= parallel_work)
    {
        const KrylovResult own = solve_in_team(A, M, b, x);
#pragma omp single
        result = own;  // the same on every thread
    }
    return result;
}

}  // namespace almesh
