// The Arnoldi process A M^{-1} V_k = V_{k+1} H_k turns |b - A x| into |beta e_1 - H_k y| for x = x_0 + M^{-1} V_k y.
// Givens rotations make H_k upper triangular as it grows, and leave the norm of the residual in the last entry of the
// rotated beta e_1, without forming x.
#include "linalg/krylov/krylov.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

Gmres::Gmres(int size, const KrylovParams& params) : size_(size), params_(params) {
    params_.restart = std::max(1, std::min(params.restart, std::max(size, 1)));
    const int m = params_.restart;
    basis_.resize(offset(m + 1, size));
    hessenberg_.resize(m * (m + 1));
    cosine_.resize(m);
    sine_.resize(m);
    rotated_.resize(m + 1);
    work_.resize(size);
}

void Gmres::precondition(Preconditioner& M, const double* r, double* z) const {
    in_team(size_ >= parallel_work, [&] { M.apply(r, z); });
}

// v_{k+1} <- A M^{-1} v_k, orthogonalised against v_0 .. v_k. Fills column k of H above its last entry and returns
// that one, |v_{k+1}|.
double Gmres::extend(const BlockCsr& A, Preconditioner& M, int k) {
    precondition(M, V(k), work_.data());
    double* const w = V(k + 1);
    multiply(A, work_.data(), w);
    const double before = norm_2(size_, w);
    for (int i = 0; i <= k; ++i) {
        H(i, k) = dot(size_, V(i), w);
        axpy(size_, -H(i, k), V(i), w);
    }
    const double after = norm_2(size_, w);
    if (after <= 1e-14 * before) return 0;  // nothing but rounding is left: the Krylov space has ended
    scale(size_, 1 / after, w);
    return after;
}

// Applies the earlier rotations to column k, then a new one that removes the entry `below` the diagonal. False if the
// diagonal entry vanishes too: column k depends on the earlier ones.
bool Gmres::rotate(int k, double below) {
    double largest = 0;
    for (int i = 0; i <= k; ++i) largest = std::max(largest, std::abs(H(i, k)));
    for (int i = 0; i < k; ++i) {
        const double upper = H(i, k), lower = H(i + 1, k);
        H(i, k) = cosine_[i] * upper + sine_[i] * lower;
        H(i + 1, k) = cosine_[i] * lower - sine_[i] * upper;
    }
    const double length = std::hypot(H(k, k), below);
    if (!(length > 1e-14 * largest)) return false;
    cosine_[k] = H(k, k) / length;
    sine_[k] = below / length;
    H(k, k) = length;
    rotated_[k + 1] = -sine_[k] * rotated_[k];
    rotated_[k] *= cosine_[k];
    return true;
}

// One cycle from the residual in v_0, already normalised, of norm beta. On return k columns are usable.
// max_iterations: of the cycle or of all.
SolveStatus Gmres::cycle(const BlockCsr& A, Preconditioner& M, double beta, double target, int& iterations, int& k) {
    rotated_[0] = beta;
    StagnationTest progress{beta};
    for (k = 0; k < params_.restart && iterations < params_.max_iterations;) {
        const double below = extend(A, M, k);
        ++iterations;
        if (!std::isfinite(below)) return SolveStatus::breakdown;
        if (!rotate(k, below)) return SolveStatus::breakdown;
        ++k;
        if (std::abs(rotated_[k]) <= target) return SolveStatus::success;
        if (below == 0) return SolveStatus::breakdown;
        if (progress.stagnates(std::abs(rotated_[k]))) return SolveStatus::stagnated;
    }
    return SolveStatus::max_iterations;
}

// x += M^{-1} (v_0 .. v_{k-1}) y with R y = rotated
void Gmres::update(Preconditioner& M, int k, double* x) {
    for (int i = k - 1; i >= 0; --i) {
        for (int j = i + 1; j < k; ++j) rotated_[i] -= H(i, j) * rotated_[j];
        rotated_[i] /= H(i, i);
    }
    fill(size_, 0, work_.data());
    for (int i = 0; i < k; ++i) axpy(size_, rotated_[i], V(i), work_.data());
    precondition(M, work_.data(), V(0));  // v_0 is not needed any more
    axpy(size_, 1, V(0), x);
}

KrylovResult Gmres::solve(const BlockCsr& A, Preconditioner& M, const double* b, double* x) {
    fill(size_, 0, x);
    const double b_norm = norm_2(size_, b);
    if (!std::isfinite(b_norm)) return {SolveStatus::breakdown, 0, b_norm};
    if (b_norm == 0) return {SolveStatus::success, 0, 0};
    const double target = params_.tolerance * b_norm;
    double residual = b_norm;
    int iterations = 0;
    copy(size_, b, V(0));
    for (;;) {
        if (residual <= target) return {SolveStatus::success, iterations, residual / b_norm};
        if (iterations >= params_.max_iterations) return {SolveStatus::max_iterations, iterations, residual / b_norm};
        scale(size_, 1 / residual, V(0));
        int k = 0;
        const SolveStatus end = cycle(A, M, residual, target, iterations, k);
        update(M, k, x);

        multiply(A, x, work_.data());
        subtract(size_, b, work_.data(), V(0));
        const double before = residual;
        residual = norm_2(size_, V(0));
        if (!std::isfinite(residual)) {
            fill(size_, 0, x);
            return {SolveStatus::breakdown, iterations, 1};
        }
        if (residual <= target) continue;
        if (end == SolveStatus::breakdown) return {end, iterations, residual / b_norm};
        if (end == SolveStatus::stagnated ||
            (residual > 0.9 * before && (end == SolveStatus::success || k == params_.restart)))
            return {SolveStatus::stagnated, iterations, residual / b_norm};
    }
}

}  // namespace almesh
