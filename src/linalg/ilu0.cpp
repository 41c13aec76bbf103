#include "linalg/ilu0.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace almesh {

namespace {

// c -= a b
template <int d>
void subtract_product(const double* a, const double* b, double* c) {
    for (int i = 0; i < d; ++i)
        for (int k = 0; k < d; ++k)
            for (int j = 0; j < d; ++j) c[i * d + j] -= a[i * d + k] * b[k * d + j];
}

// a <- a b
template <int d>
void multiply_right(double* a, const double* b) {
    double product[d * d] = {};
    for (int i = 0; i < d; ++i)
        for (int k = 0; k < d; ++k)
            for (int j = 0; j < d; ++j) product[i * d + j] += a[i * d + k] * b[k * d + j];
    std::copy(product, product + d * d, a);
}

// y -= a x
template <int d>
void subtract_product_vector(const double* a, const double* x, double* y) {
    for (int i = 0; i < d; ++i)
        for (int j = 0; j < d; ++j) y[i] -= a[i * d + j] * x[j];
}

// a <- a^{-1} by Gauss-Jordan with row exchanges; false if a is singular to working precision or not finite.
template <int d>
bool invert(double* a) {
    double largest = 0, inv[d * d] = {};
    for (int i = 0; i < d * d; ++i) largest = std::max(largest, std::abs(a[i]));
    for (int i = 0; i < d; ++i) inv[i * d + i] = 1;
    for (int k = 0; k < d; ++k) {
        int p = k;
        for (int i = k + 1; i < d; ++i)
            if (std::abs(a[i * d + k]) > std::abs(a[p * d + k])) p = i;
        if (!(std::abs(a[p * d + k]) > 1e-15 * largest) || !std::isfinite(a[p * d + k])) return false;
        for (int j = 0; j < d && p != k; ++j) {
            std::swap(a[p * d + j], a[k * d + j]);
            std::swap(inv[p * d + j], inv[k * d + j]);
        }
        const double pivot = 1 / a[k * d + k];
        for (int j = 0; j < d; ++j) a[k * d + j] *= pivot, inv[k * d + j] *= pivot;
        for (int i = 0; i < d; ++i) {
            const double factor = a[i * d + k];
            for (int j = 0; j < d && i != k; ++j) {
                a[i * d + j] -= factor * a[k * d + j];
                inv[i * d + j] -= factor * inv[k * d + j];
            }
        }
    }
    std::copy(inv, inv + d * d, a);
    return std::all_of(inv, inv + d * d, [](double v) { return std::isfinite(v); });
}

}  // namespace

Ilu0::Ilu0(const BlockCsr& pattern) : LU_(pattern), diagonal_(pattern.n), place_(pattern.n, -1) {
    for (int i = 0; i < pattern.n; ++i) diagonal_[i] = pattern.find(i, i);
}

template <int d>
Ilu0Result Ilu0::factor_blocks(const BlockCsr& A) {
    std::copy(A.value.begin(), A.value.end(), LU_.value.begin());
    for (int i = 0; i < LU_.n; ++i) {
        for (int k = LU_.row[i]; k < LU_.row[i + 1]; ++k) place_[LU_.col[k]] = k;
        for (int k = LU_.row[i]; k < diagonal_[i]; ++k) {
            const int m = LU_.col[k];
            multiply_right<d>(LU_.block(k), LU_.block(diagonal_[m]));
            for (int l = diagonal_[m] + 1; l < LU_.row[m + 1]; ++l) {
                const int target = place_[LU_.col[l]];
                if (target >= 0) subtract_product<d>(LU_.block(k), LU_.block(l), LU_.block(target));
            }
        }
        for (int k = LU_.row[i]; k < LU_.row[i + 1]; ++k) place_[LU_.col[k]] = -1;
        if (!invert<d>(LU_.block(diagonal_[i]))) return {Ilu0Status::zero_pivot, i};
    }
    return {Ilu0Status::factored, -1};
}

Ilu0Result Ilu0::factor(const BlockCsr& A) {
    if (LU_.d == 1) return factor_blocks<1>(A);
    if (LU_.d == 2) return factor_blocks<2>(A);
    return factor_blocks<3>(A);
}

template <int d>
void Ilu0::solve_blocks(double* x) const {
    for (int i = 0; i < LU_.n; ++i) {
        double* xi = x + static_cast<std::size_t>(i) * d;
        for (int k = LU_.row[i]; k < diagonal_[i]; ++k)
            subtract_product_vector<d>(LU_.block(k), x + static_cast<std::size_t>(LU_.col[k]) * d, xi);
    }
    for (int i = LU_.n - 1; i >= 0; --i) {
        double* xi = x + static_cast<std::size_t>(i) * d;
        for (int k = diagonal_[i] + 1; k < LU_.row[i + 1]; ++k)
            subtract_product_vector<d>(LU_.block(k), x + static_cast<std::size_t>(LU_.col[k]) * d, xi);
        double y[d] = {};
        subtract_product_vector<d>(LU_.block(diagonal_[i]), xi, y);
        for (int r = 0; r < d; ++r) xi[r] = -y[r];
    }
}

void Ilu0::solve(double* x) const {
    if (LU_.d == 1) return solve_blocks<1>(x);
    if (LU_.d == 2) return solve_blocks<2>(x);
    solve_blocks<3>(x);
}

}  // namespace almesh
