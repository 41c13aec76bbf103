#include "linalg/krylov/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "linalg/krylov/stagnation.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

namespace {

constexpr int block_size = 768;  // unknowns of a block: a multiple of every d

}  // namespace

ConjugateGradients::ConjugateGradients(int size, const CgParams& params)
    : size_(size), params_(params), r_(size), z_(size), p_(size), q_(size) {
    const int blocks = (size + block_size - 1) / block_size;
    pq_.resize(blocks);
    rr_.resize(blocks);
    rz_.resize(blocks);
    true_rr_.resize(blocks);
}

// term(begin, count) summed over the blocks of unknowns. Called by all threads of the team, and all get the sum.
template <class Term>
double ConjugateGradients::sum_over_blocks(std::vector<double>& partial, const Term& term) {
    const int blocks = static_cast<int>(partial.size());
#pragma omp for schedule(static)
    for (int b = 0; b < blocks; ++b) partial[b] = term(b * block_size, std::min(block_size, size_ - b * block_size));
    double sum = 0;
    for (double value : partial) sum += value;
    return sum;
}

// x = 0, r = b; returns |r|.
double ConjugateGradients::start(const double* b, double* x) {
    return std::sqrt(sum_over_blocks(rr_, [&](int i, int count) {
        std::fill_n(x + i, count, 0.0);
        std::copy_n(b + i, count, r_.data() + i);
        return dot_of_piece(count, b + i, b + i);
    }));
}

// r = b - A x; returns |r|.
double ConjugateGradients::residual(const BlockCsr& A, const double* b, const double* x) {
    return std::sqrt(sum_over_blocks(true_rr_, [&](int i, int count) {
        multiply_rows(A, i / A.d, (i + count) / A.d, x, q_.data());
        for (int k = i; k < i + count; ++k) r_[k] = b[k] - q_[k];
        return dot_of_piece(count, r_.data() + i, r_.data() + i);
    }));
}

// x += Z c, so that Z'(b - A x) = 0 for the r at hand; returns r'Z c.
double ConjugateGradients::deflate(Deflation& deflation, int d, double* x) {
    const double rZc = deflation.solve_in_team(r_.data(), nullptr);
#pragma omp for schedule(static)
    for (int node = 0; node < size_ / d; ++node)
        for (int a = 0; a < d; ++a) x[node * d + a] += deflation.correction(node)[a];
    return rZc;
}

// p = z + beta p with z = M^{-1} r, beta = r'z / rz_before; p = z where rz_before is 0. Returns r'z. d: of A.
double ConjugateGradients::next_direction(const CgPreconditioner& M, int d, double rz_before) {
    double* const z = M.ilu ? z_.data() : r_.data();
    double rz = M.ilu ? M.ilu->solve_in_team(r_.data(), z)
                      : sum_over_blocks(rz_, [&](int i, int count) { return dot_of_piece(count, z + i, z + i); });
    if (M.deflation) rz += M.deflation->solve_in_team(r_.data(), z);
    const double beta = rz_before != 0 ? rz / rz_before : 0;
    static constexpr double none[3] = {};
#pragma omp for schedule(static)
    for (int node = 0; node < size_ / d; ++node) {
        const double* const correction = M.deflation ? M.deflation->correction(node) : none;
        for (int a = 0, i = node * d; a < d; ++a, ++i) {
            const double p = z[i] + correction[a];
            p_[i] = beta != 0 ? p + beta * p_[i] : p;  // the old p may be anything where beta is 0
        }
    }
    return rz;
}

// From the x, r and p at hand, r'z = rz, until the r that is carried along is down to the targets of |r| and of
// r'M^{-1}r.
ConjugateGradients::Cycle ConjugateGradients::cycle(const BlockCsr& A, const CgPreconditioner& M, double r_norm,
                                                    double rz, const Targets& targets, int& iterations, double* x) {
    StagnationTest progress{r_norm};
    for (;;) {
        if (!std::isfinite(rz)) return Cycle::not_finite;
        if (r_norm <= targets.r_norm && rz <= targets.rz) return Cycle::small_residual;
        if (iterations == params_.max_iterations) return Cycle::max_iterations;
        const double pq = sum_over_blocks(pq_, [&](int i, int count) {
            multiply_rows(A, i / A.d, (i + count) / A.d, p_.data(), q_.data());
            return dot_of_piece(count, p_.data() + i, q_.data() + i);
        });
        ++iterations;
        if (!std::isfinite(pq)) return Cycle::not_finite;
        if (pq <= 0) return Cycle::negative_curvature;
        const double alpha = rz / pq;
        r_norm = std::sqrt(sum_over_blocks(rr_, [&](int i, int count) {
            for (int k = i; k < i + count; ++k) {
                x[k] += alpha * p_[k];
                r_[k] -= alpha * q_[k];
            }
            return dot_of_piece(count, r_.data() + i, r_.data() + i);
        }));
        if (progress.stagnates(r_norm)) return Cycle::stagnated;
        rz = next_direction(M, A.d, rz);
    }
}

CgResult ConjugateGradients::solve_in_team(const BlockCsr& A, const CgPreconditioner& M, const double* b, double* x) {
    const double b_norm = start(b, x);
    if (!std::isfinite(b_norm)) return {CgStatus::breakdown, 0, b_norm};
    if (b_norm == 0) return {CgStatus::converged, 0, 0};
    double r_norm = b_norm;
    Targets targets{params_.tolerance * b_norm, -1};
    for (int iterations = 0;;) {
        const double deflated = M.deflation ? deflate(*M.deflation, A.d, x) : 0;
        if (M.deflation) r_norm = residual(A, b, x);
        const double rz = next_direction(M, A.d, 0);
        if (targets.rz < 0) targets.rz = params_.tolerance * params_.tolerance * (rz + deflated);
        const Cycle end = cycle(A, M, r_norm, rz, targets, iterations, x);
        const double before = r_norm;
        r_norm = residual(A, b, x);
        const double relative = r_norm / b_norm;
        if (!std::isfinite(r_norm)) {
#pragma omp for schedule(static)
            for (int i = 0; i < size_; ++i) x[i] = 0;
            return {CgStatus::breakdown, iterations, 1};
        }
        switch (end) {
            case Cycle::small_residual:
                if (r_norm <= targets.r_norm) return {CgStatus::converged, iterations, relative};
                // The r carried along has drifted from the true one: once more from that.
                if (r_norm > 0.5 * before) return {CgStatus::stagnated, iterations, relative};
                break;
            case Cycle::max_iterations: return {CgStatus::max_iterations, iterations, relative};
            case Cycle::stagnated: return {CgStatus::stagnated, iterations, relative};
            case Cycle::negative_curvature: return {CgStatus::not_positive_definite, iterations, relative};
            case Cycle::not_finite: return {CgStatus::breakdown, iterations, relative};
        }
    }
}

CgResult ConjugateGradients::solve(const BlockCsr& A, const CgPreconditioner& M, const double* b, double* x) {
    CgResult result{};
#pragma omp parallel if (size_ >= parallel_work)
    {
        const CgResult own = solve_in_team(A, M, b, x);
#pragma omp single
        result = own;  // the same on every thread
    }
    return result;
}

}  // namespace almesh
