#include "constraint/dirichlet_part.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

// u, g + C u, and D where nodes slide.
void DirichletPart::measure(const std::vector<double>& y) {
    const int d = dim_;
    u_.resize(g.size());
    if (whole_) slope_.assign(g.size() * d, 0.0);
    for (int i = 0; i < C.n; ++i) {
        const double* const at = &y[offset(node[i], d)];
        if (!whole_) {
            for (int a = 0; a < d; ++a) u_[offset(i, d, a)] = at[a] - x[offset(i, d, a)];
            continue;
        }
        const SurfaceDistance distance = whole_->distance(trace_node[i], in_space(at, d));
        for (int a = 0; a < d; ++a) {
            u_[offset(i, d, a)] = distance.r[a] - r[offset(i, d, a)];
            std::copy_n(distance.slope[a].begin(), d, &slope_[offset(i, d * d, a * d)]);
        }
    }
    force_.resize(g.size());
    with_dimension(d, [&](auto n) {
        for (int i = 0; i < C.n; ++i) {
            Vec<n> sum;
            std::copy_n(&g[offset(i, n)], n(), sum.begin());
            for (int k = C.row[i]; k < C.row[i + 1]; ++k)
                for (int a = 0; a < n; ++a) sum[a] += C.value[k] * u_[offset(C.col[k], n, a)];
            std::copy_n(sum.begin(), n(), &force_[offset(i, n)]);
        }
    });
}

void DirichletPart::add_value(const std::vector<double>& y, double& E) {
    measure(y);
    E += 0.5 * (dot(g, u_) + dot(force_, u_));
}

void DirichletPart::add_gradient(const std::vector<double>& y, std::vector<double>& gradient) {
    measure(y);
    const int d = dim_;
    for (int i = 0; i < C.n; ++i)
        for (int a = 0; a < d; ++a) {
            double& sum = gradient[offset(node[i], d, a)];
            if (!whole_) sum += force_[offset(i, d, a)];
            else
                for (int b = 0; b < d; ++b) sum += slope_[offset(i, d * d, b * d + a)] * force_[offset(i, d, b)];
        }
}

void DirichletPart::add_hessian(const std::vector<double>& y, bool projected, BlockCsr& H) {
    const int d = dim_;
    if (whole_) measure(y);
    for (int i = 0; i < C.n; ++i) {
        for (int k = C.row[i]; k < C.row[i + 1]; ++k) {
            double* const block = H.block(place[k]);
            if (whole_)
                add_congruence(C.value[k], &slope_[offset(i, d * d)], &slope_[offset(C.col[k], d * d)], d, block);
            else
                for (int a = 0; a < d; ++a) block[a * d + a] += C.value[k];
        }
        if (!whole_ || projected) continue;
        Vec<3> force{};
        std::copy_n(&force_[offset(i, d)], d, force.begin());
        const Mat<3> of_curvature = whole_->second_derivative_at(trace_node[i], in_space(&y[offset(node[i], d)], d),
                                                                 force);
        double* const block = H.block(H.find(node[i], node[i]));
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) block[a * d + b] += of_curvature[a][b];
    }
}

}  // namespace almesh
