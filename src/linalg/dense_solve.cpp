#include "linalg/dense_solve.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {

bool solve_dense(std::vector<double> A, std::vector<double> b, std::vector<double>& s, double smallest) {
    const int k = static_cast<int>(b.size());
    double largest = 0;
    for (const double a : A) largest = std::max(largest, std::abs(a));
    for (int i = 0; i < k; ++i) {
        int pivot = i;
        for (int r = i + 1; r < k; ++r)
            if (std::abs(A[r * k + i]) > std::abs(A[pivot * k + i])) pivot = r;
        if (!(std::abs(A[pivot * k + i]) > smallest * largest)) return false;
        for (int j = 0; j < k; ++j) std::swap(A[i * k + j], A[pivot * k + j]);
        std::swap(b[i], b[pivot]);
        for (int r = i + 1; r < k; ++r) {
            const double factor = A[r * k + i] / A[i * k + i];
            for (int j = i; j < k; ++j) A[r * k + j] -= factor * A[i * k + j];
            b[r] -= factor * b[i];
        }
    }
    s.assign(k, 0.0);
    for (int i = k; i-- > 0;) {
        double sum = b[i];
        for (int j = i + 1; j < k; ++j) sum -= A[i * k + j] * s[j];
        s[i] = sum / A[i * k + i];
    }
    return true;
}

}  // namespace almesh
