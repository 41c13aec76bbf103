// Solutions of the exercises of lesson 4.
#include <algorithm>
#include <cmath>

#include "lessons/exercises/04.hpp"

namespace almesh::lessons {

double order_of_convergence(const std::vector<double>& size) {
    const double* const last = &size.back();
    return std::log(last[0] / last[-1]) / std::log(last[-1] / last[-2]);
}

double backtracked(const std::function<double(double)>& E, double slope) {
    if (!(slope < 0)) return 0;
    const double start = E(0);
    double t = 1;
    while (!(E(t) <= start + 1e-4 * t * slope)) t /= 2;
    return t;
}

Mat<2> positive_part(const Mat<2>& A) {
    const double mean = (A[0][0] + A[1][1]) / 2, half = (A[0][0] - A[1][1]) / 2, radius = std::hypot(half, A[0][1]);
    const double larger = std::max(mean + radius, 0.0), smaller = std::max(mean - radius, 0.0);
    if (radius == 0) return {{{larger, 0}, {0, larger}}};
    // A = mean I + radius R with R R = I, so (I + R) / 2 and (I - R) / 2 project onto the eigenvectors.
    const double sum = (larger + smaller) / 2, difference = (larger - smaller) / 2;
    const double c = half / radius, s = A[0][1] / radius;
    return {{{sum + difference * c, difference * s}, {difference * s, sum - difference * c}}};
}

void fix_nodes(BlockCsr& H, std::vector<double>& g, const std::vector<char>& fixed) {
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            if (!fixed[i] && !fixed[j]) continue;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) H.block(k)[2 * a + b] = i == j && a == b;
        }
    for (int i = 0; i < H.n; ++i)
        if (fixed[i]) g[2 * i] = g[2 * i + 1] = 0;
}

double minimise(const std::function<double(double)>& f, const std::function<double(double)>& f1,
                const std::function<double(double)>& f2, double x) {
    while (std::abs(f1(x)) > 1e-7) {
        const double curvature = std::abs(f2(x)), d = -f1(x) / (curvature > 0 ? curvature : 1);
        x += backtracked([&](double t) { return f(x + t * d); }, f1(x) * d) * d;
    }
    return x;
}

}  // namespace almesh::lessons
