#include "linalg/dense_solve.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {

bool solve_dense(std::vector<double> A, std::vector<double> b, std::vector<double>& s, double smallest) {
    const int k = static_cast<int>(std::lround(std::sqrt(static_cast<double>(A.size()))));
    const int columns = k == 0 ? 0 : static_cast<int>(b.size()) / k;
    double largest = 0;
    for (const double a : A) largest = std::max(largest, std::abs(a));
    for (int i = 0; i < k; ++i) {
        int pivot = i;
        for (int r = i + 1; r < k; ++r)
            if (std::abs(A[r * k + i]) > std::abs(A[pivot * k + i])) pivot = r;
        if (!(std::abs(A[pivot * k + i]) > smallest * largest)) return false;
        for (int j = 0; j < k; ++j) std::swap(A[i * k + j], A[pivot * k + j]);
        for (int c = 0; c < columns; ++c) std::swap(b[i * columns + c], b[pivot * columns + c]);
        for (int r = i + 1; r < k; ++r) {
            const double factor = A[r * k + i] / A[i * k + i];
            for (int j = i; j < k; ++j) A[r * k + j] -= factor * A[i * k + j];
            for (int c = 0; c < columns; ++c) b[r * columns + c] -= factor * b[i * columns + c];
        }
    }
    s.assign(b.size(), 0.0);
    for (int i = k; i-- > 0;)
        for (int c = 0; c < columns; ++c) {
            double sum = b[i * columns + c];
            for (int j = i + 1; j < k; ++j) sum -= A[i * k + j] * s[j * columns + c];
            s[i * columns + c] = sum / A[i * k + i];
        }
    return true;
}

void diagonalise(int n, double* A, double* V) {
    constexpr int most_sweeps = 30;
    constexpr double negligible = 1e-30;  // squared sum off the diagonal over that on it
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) V[i * n + j] = i == j;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double off = 0, on = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) (i == j ? on : off) += A[i * n + j] * A[i * n + j];
        if (off <= negligible * on) return;
        for (int i = 0; i < n; ++i)
            for (int j = i + 1; j < n; ++j) {
                if (A[i * n + j] == 0) continue;
                const double angle = 0.5 * std::atan2(2 * A[i * n + j], A[j * n + j] - A[i * n + i]);
                const double c = std::cos(angle), s = std::sin(angle);
                for (int k = 0; k < n; ++k) {
                    const double a = A[k * n + i], b = A[k * n + j], v = V[k * n + i], w = V[k * n + j];
                    A[k * n + i] = c * a - s * b, A[k * n + j] = s * a + c * b;
                    V[k * n + i] = c * v - s * w, V[k * n + j] = s * v + c * w;
                }
                for (int k = 0; k < n; ++k) {
                    const double a = A[i * n + k], b = A[j * n + k];
                    A[i * n + k] = c * a - s * b, A[j * n + k] = s * a + c * b;
                }
            }
    }
}

}  // namespace almesh
