#include "support/plain_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/lagrange.hpp"

namespace almesh::test {
namespace {

constexpr int most = 9;  // entries of F

double determinant(int n, const double* A) {
    if (n == 2) return A[0] * A[3] - A[1] * A[2];
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) + A[2] * (A[3] * A[7] - A[4] * A[6]);
}

// Inverse by cofactors.
void invert(int n, const double* A, double* out) {
    const double D = determinant(n, A);
    if (n == 2) {
        const double inverse[4] = {A[3] / D, -A[1] / D, -A[2] / D, A[0] / D};
        std::copy_n(inverse, 4, out);
        return;
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            out[j * 3 + i] = (A[i1 * 3 + j1] * A[i2 * 3 + j2] - A[i1 * 3 + j2] * A[i2 * 3 + j1]) / D;
        }
}

double distortion(int n, const double* F) {
    const double D = determinant(n, F);
    if (!(D > 0)) return std::numeric_limits<double>::infinity();
    double S = 0;
    for (int k = 0; k < n * n; ++k) S += F[k] * F[k];
    return S / (n * std::pow(D, 2.0 / n));
}

// What the derivatives of eta are made of.
struct Derivative {
    double eta, factor;  // factor: 2 / (n D^{2/n})
    double G[most];      // F^{-T}
    double eta_F[most];
};

Derivative derivative(int n, const double* F) {
    Derivative d;
    double inverse[most];
    invert(n, F, inverse);
    d.eta = distortion(n, F);
    d.factor = 2 / (n * std::pow(determinant(n, F), 2.0 / n));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) d.G[i * n + j] = inverse[j * n + i];
    for (int k = 0; k < n * n; ++k) d.eta_F[k] = d.factor * F[k] - 2.0 / n * d.eta * d.G[k];
    return d;
}

double f1(double eta, Objective objective) { return 2 * (objective == Objective::squared ? eta : eta - 1); }

// A: n*n x n*n, entry (i n + j, k n + l) = d2f / dF_ij dF_kl.
void second_derivative(int n, const double* F, Objective objective, double* A) {
    const Derivative d = derivative(n, F);
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const int row = i * n + j, column = k * n + l;
                    double eta_FF = d.factor * ((row == column) - 2.0 / n * d.G[column] * F[row]);
                    eta_FF -= 2.0 / n * d.eta_F[column] * d.G[row];
                    eta_FF += 2.0 / n * d.eta * d.G[i * n + l] * d.G[k * n + j];
                    A[row * n * n + column] = 2 * d.eta_F[row] * d.eta_F[column] + f1(d.eta, objective) * eta_FF;
                }
}

}  // namespace

void project(int size, double* A) {
    std::vector<double> Q(size * size, 0.0);
    for (int i = 0; i < size; ++i) Q[i * size + i] = 1;
    const auto rotate = [size](double* row_p, double* row_q, int stride, double c, double s) {
        for (int k = 0; k < size; ++k) {
            const double p = row_p[k * stride], q = row_q[k * stride];
            row_p[k * stride] = c * p - s * q;
            row_q[k * stride] = s * p + c * q;
        }
    };
    for (int sweep = 0; sweep < 50; ++sweep) {
        double off = 0, on = 0;
        for (int i = 0; i < size; ++i)
            for (int j = 0; j < size; ++j) (i == j ? on : off) += A[i * size + j] * A[i * size + j];
        if (off <= 1e-33 * on) break;
        for (int p = 0; p < size; ++p)
            for (int q = p + 1; q < size; ++q) {
                if (A[p * size + q] == 0) continue;
                const double tau = (A[q * size + q] - A[p * size + p]) / (2 * A[p * size + q]);
                const double t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::hypot(1, tau));
                const double c = 1 / std::hypot(1, t), s = c * t;
                rotate(A + p, A + q, size, c, s);
                rotate(A + p * size, A + q * size, 1, c, s);
                rotate(&Q[p], &Q[q], size, c, s);
            }
    }
    std::vector<double> value(size);
    for (int i = 0; i < size; ++i) value[i] = std::max(A[i * size + i], 0.0);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) {
            A[i * size + j] = 0;
            for (int k = 0; k < size; ++k) A[i * size + j] += value[k] * Q[i * size + k] * Q[j * size + k];
        }
}

PlainAssembly::PlainAssembly(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : mesh_(mesh), params_(params) {
    const int n = mesh.dim, m = mesh.element_nodes();
    const LagrangeBasis basis(n, mesh.degree);
    quadrature_ = simplex_quadrature(n, params.exactness ? params.exactness : default_exactness(mesh.degree));
    const double reference_volume = n == 2 ? 0.5 : 1.0 / 6;
    if (mesh.degree > 1) {  // a thousandth of the weight for the nodes
        for (double& weight : quadrature_.weight) weight *= 0.999;
        for (int i = 0; i < m; ++i) {
            for (int k = 0; k < n; ++k) quadrature_.xi.push_back(1.0 * basis.nodes[i][k + 1] / mesh.degree);
            quadrature_.weight.push_back(0.001 * reference_volume / m);
        }
        quadrature_.count += m;
    }
    gradients_.resize(static_cast<std::size_t>(quadrature_.count) * m * n);
    for (int q = 0; q < quadrature_.count; ++q) basis.gradients(&quadrature_.xi[q * n], &gradients_[q * m * n]);

    double volume = 0, weighted_volume = 0;
    std::vector<double> jacobians;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* node = mesh.element(e);
        double A[most], inverse[most];
        for (int a = 0; a < n; ++a)
            for (int k = 0; k < n; ++k) A[a * n + k] = ideal[node[k + 1] * n + a] - ideal[node[0] * n + a];
        invert(n, A, inverse);
        ideal_inverse_.insert(ideal_inverse_.end(), inverse, inverse + n * n);
        jacobians.push_back(determinant(n, A));
        weight_.push_back(std::pow(determinant(n, A), params.weight_exponent));
        volume += determinant(n, A);
        weighted_volume += weight_.back();
    }
    for (double& weight : weight_) weight *= volume / weighted_volume;
    double damped_volume = 0;
    for (double jacobian : jacobians) damped_volume += std::pow(jacobian, std::min(1.5 / n, params.weight_exponent));
    for (std::size_t e = 0; e < jacobians.size(); ++e)
        damping_.push_back(std::pow(jacobians[e], std::min(1.5 / n, params.weight_exponent)) * volume / damped_volume /
                           weight_[e]);
}

template <class Body>
void PlainAssembly::every_point(int e, const std::vector<double>& x, const Body& body) const {
    const int n = mesh_.dim, m = mesh_.element_nodes();
    const int* node = mesh_.element(e);
    const double* inverse = &ideal_inverse_[static_cast<std::size_t>(e) * n * n];
    std::vector<double> dN(m * n);
    for (int q = 0; q < quadrature_.count; ++q) {
        std::fill(dN.begin(), dN.end(), 0.0);
        double F[most] = {};
        for (int i = 0; i < m; ++i)
            for (int k = 0; k < n; ++k)
                for (int l = 0; l < n; ++l) dN[i * n + k] += gradients_[(q * m + i) * n + l] * inverse[l * n + k];
        for (int i = 0; i < m; ++i)
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k)
                    F[a * n + k] += (x[static_cast<std::size_t>(node[i]) * n + a] -
                                     x[static_cast<std::size_t>(node[0]) * n + a]) * dN[i * n + k];
        body(dN, F, weight_[e] * quadrature_.weight[q]);
    }
}

double PlainAssembly::energy(const std::vector<double>& x) const {
    double sum = 0;
    for (int e = 0; e < mesh_.element_count(); ++e)
        every_point(e, x, [&](const std::vector<double>&, const double* F, double weight) {
            const double eta = distortion(mesh_.dim, F), t = params_.objective == Objective::squared ? eta : eta - 1;
            sum += weight * t * t;
        });
    return sum;
}

void PlainAssembly::add_gradient(const std::vector<double>& x, std::vector<double>& g) const {
    const int n = mesh_.dim, m = mesh_.element_nodes();
    for (int e = 0; e < mesh_.element_count(); ++e)
        every_point(e, x, [&](const std::vector<double>& dN, const double* F, double weight) {
            const Derivative d = derivative(n, F);
            for (int i = 0; i < m; ++i)
                for (int a = 0; a < n; ++a)
                    for (int k = 0; k < n; ++k)
                        g[static_cast<std::size_t>(mesh_.element(e)[i]) * n + a] +=
                            weight * f1(d.eta, params_.objective) * d.eta_F[a * n + k] * dN[i * n + k];
        });
}

void PlainAssembly::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H) const {
    const int n = mesh_.dim, m = mesh_.element_nodes();
    const Objective objective = kind == HessianKind::squared_projected ? Objective::squared : params_.objective;
    std::vector<double> K(m * n * m * n);
    for (int e = 0; e < mesh_.element_count(); ++e) {
        std::fill(K.begin(), K.end(), 0.0);
        every_point(e, x, [&](const std::vector<double>& dN, const double* F, double weight) {
            double A[most * most];
            second_derivative(n, F, objective, A);
            if (kind == HessianKind::squared_projected) weight *= damping_[e];
            if (kind != HessianKind::full) project(n * n, A);
            for (int i = 0; i < m; ++i)
                for (int j = 0; j < m; ++j)
                    for (int a = 0; a < n; ++a)
                        for (int b = 0; b < n; ++b)
                            for (int k = 0; k < n; ++k)
                                for (int l = 0; l < n; ++l)
                                    K[(i * n + a) * m * n + j * n + b] +=
                                        weight * dN[i * n + k] * A[(a * n + k) * n * n + b * n + l] * dN[j * n + l];
        });
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j) {
                double* block = H.block(H.find(mesh_.element(e)[i], mesh_.element(e)[j]));
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) block[a * n + b] += K[(i * n + a) * m * n + j * n + b];
            }
    }
}

}  // namespace almesh::test
