#include "linalg/krylov/gmres.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/krylov/stagnation.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

Gmres::Gmres(int size, const GmresParams& params) : size_(size), params_(params) {
    params_.restart = std::max(1, std::min(params.restart, std::max(size, 1)));
    const int m = params_.restart;
    basis_.resize(static_cast<std::size_t>(m + 1) * size);
    hessenberg_.resize(m * (m + 1));
    cosine_.resize(m);
    sine_.resize(m);
    rotated_.resize(m + 1);
    work_.resize(size);
}

// v_{k+1} <- A M^{-1} v_k, orthogonalised against v_0 .. v_k. Fills column k of H above its last entry and returns
// that one, |v_{k+1}|.
double Gmres::extend(const BlockCsr& A, Ilu0* M, int k) {
    if (M) M->solve(V(k), work_.data());
    else copy(size_, V(k), work_.data());
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

// One cycle from the residual in v_0, already normalised, of length beta. On return k columns are usable.
Gmres::Cycle Gmres::cycle(const BlockCsr& A, Ilu0* M, double beta, double target, int& iterations, int& k) {
    rotated_[0] = beta;
    StagnationTest progress{beta};
    for (k = 0; k < params_.restart && iterations < params_.max_iterations;) {
        const double below = extend(A, M, k);
        ++iterations;
        if (!std::isfinite(below)) return Cycle::not_finite;
        if (!rotate(k, below)) return Cycle::space_ended;
        ++k;
        if (std::abs(rotated_[k]) <= target) return Cycle::small_residual;
        if (below == 0) return Cycle::space_ended;
        if (progress.stagnates(std::abs(rotated_[k]))) return Cycle::stagnated;
    }
    return Cycle::full;
}

// x += M^{-1} (v_0 .. v_{k-1}) y with R y = rotated
void Gmres::update(Ilu0* M, int k, double* x) {
    for (int i = k - 1; i >= 0; --i) {
        for (int j = i + 1; j < k; ++j) rotated_[i] -= H(i, j) * rotated_[j];
        rotated_[i] /= H(i, i);
    }
    fill(size_, 0, work_.data());
    for (int i = 0; i < k; ++i) axpy(size_, rotated_[i], V(i), work_.data());
    if (M) M->solve(work_.data(), work_.data());
    axpy(size_, 1, work_.data(), x);
}

GmresResult Gmres::solve(const BlockCsr& A, Ilu0* M, const double* b, double* x) {
    fill(size_, 0, x);
    const double b_norm = norm_2(size_, b);
    if (!std::isfinite(b_norm)) return {GmresStatus::breakdown, 0, b_norm};
    if (b_norm == 0) return {GmresStatus::converged, 0, 0};
    const double target = params_.tolerance * b_norm;
    double residual = b_norm;
    int iterations = 0;
    copy(size_, b, V(0));
    for (;;) {
        if (residual <= target) return {GmresStatus::converged, iterations, residual / b_norm};
        if (iterations >= params_.max_iterations)
            return {GmresStatus::max_iterations, iterations, residual / b_norm};
        scale(size_, 1 / residual, V(0));
        int k = 0;
        const Cycle end = cycle(A, M, residual, target, iterations, k);
        update(M, k, x);

        multiply(A, x, work_.data());
        subtract(size_, b, work_.data(), V(0));
        const double before = residual;
        residual = norm_2(size_, V(0));
        if (!std::isfinite(residual)) {
            fill(size_, 0, x);
            return {GmresStatus::breakdown, iterations, 1};
        }
        if (residual <= target) continue;
        if (end == Cycle::not_finite || end == Cycle::space_ended)
            return {GmresStatus::breakdown, iterations, residual / b_norm};
        if (end == Cycle::stagnated ||
            (residual > 0.9 * before && (end == Cycle::small_residual || k == params_.restart)))
            return {GmresStatus::stagnated, iterations, residual / b_norm};
    }
}

}  // namespace almesh
