// With q = A p, z = M^{-1} r:
//     beta = -z'q / p'q of the iteration before,  p = z + beta p,  q = A z + beta q,  alpha = r'z / p'q,
//     x += alpha p,  r -= alpha q.
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

// r = b - A x; returns |r|. Where half of A is stored, the r at hand: A is what the preconditioner has made of it.
double ConjugateGradients::residual(const BlockCsr& A, const double* b, const double* x) {
    return std::sqrt(true_rr_([&](int i, int count) {
        if (A.in_half()) return dot_of_piece(count, r_.data() + i, r_.data() + i);
        multiply_rows(A, i / A.d, (i + count) / A.d, x, q_.data());
        for (int k = i; k < i + count; ++k) r_[k] = b[k] - q_[k];
        return dot_of_piece(count, r_.data() + i, r_.data() + i);
    }));
}

// z = M^{-1} r, for the r at hand. Without r'r.
Products ConjugateGradients::start(const BlockCsr& A, Preconditioner& M) {
    if (M.puts_off_products()) return M.apply_and_put_off(r_.data(), z_.data(), Az_.data());
    Products now;
    now.rz = M.apply_and_multiply(A, r_.data(), z_.data(), Az_.data());
    now.zAz = zAz_([&](int i, int count) { return dot_of_piece(count, z_.data() + i, Az_.data() + i); });
    return now;
}

// q = A z + beta q, r -= alpha q, z = M^{-1} r.
Products ConjugateGradients::advance(const BlockCsr& A, Preconditioner& M, double alpha, double beta) {
    if (M.puts_off_products()) return M.advance(alpha, beta, q_.data(), r_.data(), z_.data(), Az_.data());
    const double rr = rr_([&](int i, int count) {
        for (int k = i; k < i + count; ++k) {
            q_[k] = Az_[k] + beta * q_[k];
            r_[k] -= alpha * q_[k];
        }
        return dot_of_piece(count, r_.data() + i, r_.data() + i);
    });
    Products now = start(A, M);
    now.rr = rr;
    return now;
}

// x += alpha p with the direction before, p = z + beta p.
void ConjugateGradients::next_direction(double alpha, double beta, double* x) {
#pragma omp for schedule(static)
    for (int k = 0; k < size_; ++k) {
        x[k] += alpha * p_[k];
        p_[k] = z_[k] + beta * p_[k];
    }
}

// p'A p by a product with A, which is left in Ap.
double ConjugateGradients::curvature(const BlockCsr& A, double* Ap) {
    return pAp_([&](int i, int count) {
        multiply_rows(A, i / A.d, (i + count) / A.d, p_.data(), Ap);
        return dot_of_piece(count, p_.data() + i, Ap + i);
    });
}

// Iterates from the current x, r and z until the recurrence for r is down to the targets of |r| and of r'M^{-1}r.
SolveStatus ConjugateGradients::cycle(const BlockCsr& A, Preconditioner& M, Products now, double r_target,
                                      double rz_target, int& iterations, double* x) {
    const int first = iterations;
    StagnationTest progress{std::sqrt(now.rr)};
    double alpha = 0, beta = 0, pAp = 0;
#pragma omp for schedule(static)
    for (int i = 0; i < size_; ++i) p_[i] = q_[i] = 0;
    for (;;) {
        const double zq = zq_([&](int i, int count) { return dot_of_piece(count, z_.data() + i, q_.data() + i); });
        beta = pAp > 0 ? -zq / pAp : 0;
        next_direction(alpha, beta, x);
        const double r_norm = std::sqrt(now.rr);
        if (!std::isfinite(now.rz)) return SolveStatus::breakdown;
        if (r_norm <= r_target && now.rz <= rz_target) return SolveStatus::success;
        if (iterations > first && progress.stagnates(r_norm) && iterations >= params_.patience)
            return SolveStatus::stagnated;
        if (iterations == params_.max_iterations) return SolveStatus::max_iterations;
        if (now.is_indefinite) return SolveStatus::not_positive_definite;
        ++iterations;
        pAp = now.zAz + beta * zq;
        if (!(pAp > 0) && !A.in_half()) {
            // z has done its part where products are put off; elsewhere A p takes the place of A z
            const bool puts_off = M.puts_off_products();
            pAp = curvature(A, puts_off ? z_.data() : Az_.data());
            if (!puts_off) beta = 0;
        }
        if (!std::isfinite(pAp)) return SolveStatus::breakdown;
        if (pAp <= 0) return SolveStatus::not_positive_definite;
        alpha = now.rz / pAp;
        now = advance(A, M, alpha, beta);
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
        Products now = start(A, M);
        now.rr = r_norm * r_norm;
        if (rz_target < 0) rz_target = params_.tolerance * params_.tolerance * (now.rz + corrected);
        const SolveStatus end = cycle(A, M, now, r_target, rz_target, iterations, x);
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
    in_team(size_ >= parallel_work, [&] {
        const KrylovResult own = solve_in_team(A, M, b, x);
#pragma omp single
        result = own;  // the same on every thread
    });
    return result;
}

}  // namespace almesh
