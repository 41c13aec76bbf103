#include "constraint/dirichlet_part.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

// u, C u, and D where nodes slide.
void DirichletPart::measure(const std::vector<double>& y) {
    const int d = C.d;
    u_.resize(y.size());
    force_.resize(y.size());
    if (!whole_)
        for (std::size_t i = 0; i < y.size(); ++i) u_[i] = y[i] - x[i];
    else {
        slope_.assign(y.size() * d, 0.0);
        for (int k = 0; k < C.n; ++k) {
            SurfaceDistance distance;
            if (trace_node[k] >= 0) distance = whole_->distance(trace_node[k], in_space(&y[offset(k, d)], d));
            for (int a = 0; a < d; ++a) {
                u_[offset(k, d, a)] = distance.r[a] - r[offset(k, d, a)];
                std::copy_n(distance.slope[a].begin(), d, &slope_[offset(k, d * d, a * d)]);
            }
        }
    }
    multiply(C, u_.data(), force_.data());
}

void DirichletPart::add_value(const std::vector<double>& y, double& E) {
    measure(y);
    E += dot(g, u_);
    E += 0.5 * dot(u_, force_);
}

void DirichletPart::add_gradient(const std::vector<double>& y, std::vector<double>& gradient) {
    measure(y);
    const int d = C.d;
    for (int k = 0; k < C.n; ++k)
        for (int a = 0; a < d; ++a) {
            const auto force = [&](int b) { return g[offset(k, d, b)] + force_[offset(k, d, b)]; };
            double& sum = gradient[offset(k, d, a)];
            if (!whole_) sum += force(a);
            else
                for (int b = 0; b < d; ++b) sum += slope_[offset(k, d * d, b * d + a)] * force(b);
        }
}

void DirichletPart::add_hessian(const std::vector<double>& y, bool projected, BlockCsr& H) {
    const int d = C.d;
    if (!whole_) {
        for (std::size_t k = 0; k < H.value.size(); ++k) H.value[k] += C.value[k];
        return;
    }
    measure(y);
    for (int k = 0; k < C.n; ++k) {
        for (int e = C.row[k]; e < C.row[k + 1]; ++e)
            add_congruence(C.block(e)[0], &slope_[offset(k, d * d)], &slope_[offset(C.col[e], d * d)], d, H.block(e));
        if (projected || trace_node[k] < 0) continue;
        Vec<3> force{};
        for (int a = 0; a < d; ++a) force[a] = g[offset(k, d, a)] + force_[offset(k, d, a)];
        const Mat<3> of_curvature = whole_->second_derivative_at(trace_node[k], in_space(&y[offset(k, d)], d), force);
        double* const block = H.block(H.find(k, k));
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) block[a * d + b] += of_curvature[a][b];
    }
}

}  // namespace almesh
