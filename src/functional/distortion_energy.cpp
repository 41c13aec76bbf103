#include "functional/distortion_energy.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

int default_exactness(int degree) { return degree == 1 ? 0 : 2 * degree + 2; }

namespace {

std::vector<double> reference_gradients(const LagrangeBasis& basis, const std::vector<double>& xi) {
    const int points = static_cast<int>(xi.size()) / basis.dim, stride = basis.count * basis.dim;
    std::vector<double> dN(static_cast<std::size_t>(points) * stride);
    for (int q = 0; q < points; ++q) basis.gradients(&xi[q * basis.dim], &dN[static_cast<std::size_t>(q) * stride]);
    return dN;
}

std::vector<double> node_points(const LagrangeBasis& basis) {
    std::vector<double> xi;
    for (const MultiIndex& a : basis.nodes)
        for (int k = 1; k <= basis.dim; ++k) xi.push_back(static_cast<double>(a[k]) / basis.degree);
    return xi;
}

// Elements of degree p > 1 fold at vertices and edges first, where the quadrature has no points: a part `node_part` of
// the weight goes to the nodes, where the distortion then stops them as it does inside.
constexpr double node_part = 0.001;

void add_node_points(const LagrangeBasis& basis, Quadrature& quadrature) {
    double volume = 0;
    for (double& weight : quadrature.weight) {
        volume += weight;
        weight *= 1 - node_part;
    }
    const std::vector<double> xi = node_points(basis);
    quadrature.xi.insert(quadrature.xi.end(), xi.begin(), xi.end());
    quadrature.weight.insert(quadrature.weight.end(), basis.count, node_part * volume / basis.count);
    quadrature.count += basis.count;
}

// First fit, colour after colour: an element takes the colour if none of its nodes has it yet.
void colour_elements(const Mesh& mesh, std::vector<int>& start, std::vector<int>& order) {
    const int elements = mesh.element_count(), m = mesh.element_nodes();
    std::vector<int> rest(elements), later, last_colour(mesh.nodes(), -1);
    for (int e = 0; e < elements; ++e) rest[e] = e;
    start = {0};
    order.clear();
    for (int colour = 0; !rest.empty(); ++colour) {
        later.clear();
        for (int e : rest) {
            const int* node = mesh.element(e);
            const bool free = std::none_of(node, node + m, [&](int i) { return last_colour[i] == colour; });
            (free ? order : later).push_back(e);
            if (free)
                for (int i = 0; i < m; ++i) last_colour[node[i]] = colour;
        }
        start.push_back(static_cast<int>(order.size()));
        rest.swap(later);
    }
}

}  // namespace

// What is done for one element, for one space dimension.
template <int n>
struct DistortionEnergy::Kernel {
    const DistortionEnergy& of;
    const int m = of.element_nodes_;
    Mat<n> ideal_inverse;
    const int* node = nullptr;
    double* const local;  // m x n positions relative to the element's first node: exact differences
    double* const modes;  // n*n x m n: the modes of the Hessian applied to the derivatives of the basis
    double* const matrix;  // (m n) x (m n): room for the element's gradient or Hessian

    explicit Kernel(const DistortionEnergy& energy)
        : of(energy), local(workspace((1 + n * n + m * n) * m * n)), modes(local + m * n), matrix(modes + n * n * m * n) {}

    // Kept by each thread between calls: nothing is allocated inside the Newton loop.
    static double* workspace(std::size_t size) {
        thread_local std::vector<double> values;
        if (values.size() < size) values.resize(size);
        return values.data();
    }

    void start(int e, const std::vector<double>& x) {
        node = &of.elements_[static_cast<std::size_t>(e) * m];
        const double* inverse = &of.ideal_inverse_[static_cast<std::size_t>(e) * n * n];
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) ideal_inverse[i][j] = inverse[i * n + j];
        const double* x0 = &x[static_cast<std::size_t>(node[0]) * n];
        for (int i = 0; i < m; ++i)
            for (int a = 0; a < n; ++a) local[i * n + a] = x[static_cast<std::size_t>(node[i]) * n + a] - x0[a];
    }

    // F = J A^{-1}; dN: m x n reference derivatives.
    Mat<n> deformation_gradient(const double* dN) const {
        Mat<n> J{};
        for (int i = 0; i < m; ++i)
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k) J[a][k] += local[i * n + a] * dN[i * n + k];
        return multiply<n>(J, ideal_inverse);
    }

    const double* gradients(int q) const { return &of.gradients_[static_cast<std::size_t>(q) * m * n]; }

    double energy() const {
        double sum = 0;
        for (int q = 0; q < of.quadrature_.count; ++q) {
            const double eta = distortion<n>(deformation_gradient(gradients(q)), of.params_.delta);
            sum += of.quadrature_.weight[q] * density(eta, of.params_.objective);
        }
        return sum;
    }

    // out: m x n, the element's part of the gradient.
    void gradient(double* out) const {
        std::fill(out, out + m * n, 0.0);
        for (int q = 0; q < of.quadrature_.count; ++q) {
            const double* dN = gradients(q);
            Mat<n> P = density_gradient<n>(deformation_gradient(dN), of.params_.delta, of.params_.objective);
            P = multiply<n>(P, transpose<n>(ideal_inverse));
            for (int i = 0; i < m; ++i)
                for (int a = 0; a < n; ++a)
                    for (int k = 0; k < n; ++k) out[i * n + a] += of.quadrature_.weight[q] * P[a][k] * dN[i * n + k];
        }
    }

    // K: (m n) x (m n), row-major, component a of node i in row i n + a; columns up to the diagonal block are filled.
    // Each mode of the density's Hessian adds value b b^T, with b the mode applied to the derivatives of the N_i.
    void hessian(HessianKind kind, double* K) {
        const int size = m * n;
        std::fill(K, K + size * size, 0.0);
        const bool squared = kind == HessianKind::squared_projected;
        const Objective objective = squared ? Objective::squared : of.params_.objective;
        for (int q = 0; q < of.quadrature_.count; ++q) {
            const double* dN = gradients(q);
            DensityHessian<n> A = density_hessian<n>(deformation_gradient(dN), of.params_.delta, objective);
            if (kind != HessianKind::full)
                for (double& value : A.value) value = std::max(value, 0.0);
            for (int mode = 0; mode < n * n; ++mode) {
                const Mat<n> B = multiply<n>(A.mode[mode], transpose<n>(ideal_inverse));
                double* b = &modes[mode * size];
                for (int i = 0; i < m; ++i)
                    for (int a = 0; a < n; ++a) {
                        double sum = 0;
                        for (int k = 0; k < n; ++k) sum += B[a][k] * dN[i * n + k];
                        b[i * n + a] = sum;
                    }
            }
            for (int r = 0; r < size; ++r) {
                double factor[n * n];
                for (int mode = 0; mode < n * n; ++mode)
                    factor[mode] = of.quadrature_.weight[q] * A.value[mode] * modes[mode * size + r];
                double* row = K + r * size;
                const int end = (r / n + 1) * n;
                for (int c = 0; c < end; ++c) {
                    double sum = row[c];
                    for (int mode = 0; mode < n * n; ++mode) sum += factor[mode] * modes[mode * size + c];
                    row[c] = sum;
                }
            }
        }
    }
};

DistortionEnergy::DistortionEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : dim_(mesh.dim),
      element_nodes_(mesh.element_nodes()),
      element_count_(mesh.element_count()),
      params_(params),
      quadrature_(simplex_quadrature(mesh.dim, params.exactness ? params.exactness : default_exactness(mesh.degree))),
      elements_(mesh.elements),
      element_value_(mesh.element_count()) {
    is_large_ = static_cast<double>(element_count_) * quadrature_.count * element_nodes_ >= parallel_work;
    const LagrangeBasis basis(dim_, mesh.degree);
    if (mesh.degree > 1) add_node_points(basis, quadrature_);
    gradients_ = reference_gradients(basis, quadrature_.xi);
    node_gradients_ = reference_gradients(basis, node_points(basis));
    colour_elements(mesh, colour_start_, coloured_);

    const double simplex_volume = dim_ == 2 ? 0.5 : 1.0 / 6;
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
        for (int e = 0; e < element_count_; ++e) {
            Mat<n> A;
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k)
                    A[a][k] = ideal[static_cast<std::size_t>(mesh.element(e)[k + 1]) * n + a] -
                              ideal[static_cast<std::size_t>(mesh.element(e)[0]) * n + a];
            ideal_jacobian_.push_back(determinant(A));
            if (!(ideal_jacobian_.back() > 0))
                throw InputError("element " + std::to_string(mesh.element_id[e]) + " of the ideal mesh has no positive volume");
            for (const auto& row : inverse<n>(A)) ideal_inverse_.insert(ideal_inverse_.end(), row.begin(), row.end());
        }
    });

    pattern_ = matrix_of_cells(mesh.nodes(), dim_, elements_, element_nodes_);
    const int m = element_nodes_;
    place_.resize(static_cast<std::size_t>(element_count_) * m * m);
    parallel_for(element_count_, [&](int e) {
        const int* node = mesh.element(e);
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j) place_[(static_cast<std::size_t>(e) * m + i) * m + j] = pattern_.find(node[i], node[j]);
    });

    pattern_.value = std::vector<double>();  // gives the memory back

    double weighted_volume = 0;
    for (double jacobian : ideal_jacobian_) {
        volume_ += jacobian * simplex_volume;
        weight_.push_back(std::pow(jacobian, params_.weight_exponent));
        weighted_volume += weight_.back() * simplex_volume;
    }
    for (double& weight : weight_) weight *= volume_ / weighted_volume;
}

BlockCsr DistortionEnergy::hessian_pattern() const {
    BlockCsr H = pattern_;
    H.value.assign(H.col.size() * H.d * H.d, 0.0);
    return H;
}

double DistortionEnergy::energy(const std::vector<double>& x) const {
    std::atomic<bool> inverted = false;  // one inverted element settles it: the others are skipped
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
#pragma omp parallel if (is_large_)
        {
            Kernel<n> kernel(*this);
#pragma omp for schedule(static)
            for (int e = 0; e < element_count_; ++e) {
                if (inverted.load(std::memory_order_relaxed)) continue;
                kernel.start(e, x);
                element_value_[e] = weight_[e] * kernel.energy();
                if (!std::isfinite(element_value_[e])) inverted.store(true, std::memory_order_relaxed);
            }
        }
    });
    if (inverted) return std::numeric_limits<double>::infinity();
    return deterministic_sum(element_count_, [this](int e) { return element_value_[e]; });
}

void DistortionEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) const {
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
#pragma omp parallel if (is_large_)
        {
            Kernel<n> kernel(*this);
            double* const part = kernel.matrix;
            for (std::size_t colour = 0; colour + 1 < colour_start_.size(); ++colour) {
#pragma omp for schedule(static)
                for (int k = colour_start_[colour]; k < colour_start_[colour + 1]; ++k) {
                    const int e = coloured_[k];
                    kernel.start(e, x);
                    kernel.gradient(part);
                    for (int i = 0; i < element_nodes_; ++i)
                        for (int a = 0; a < n; ++a)
                            g[static_cast<std::size_t>(kernel.node[i]) * n + a] += weight_[e] * part[i * n + a];
                }
            }
        }
    });
}

void DistortionEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H) const {
    const int m = element_nodes_;
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
#pragma omp parallel if (is_large_)
        {
            Kernel<n> kernel(*this);
            double* const K = kernel.matrix;
            for (std::size_t colour = 0; colour + 1 < colour_start_.size(); ++colour) {
#pragma omp for schedule(static)
                for (int c = colour_start_[colour]; c < colour_start_[colour + 1]; ++c) {
                    const int e = coloured_[c];
                    kernel.start(e, x);
                    kernel.hessian(kind, K);
                    for (int i = 0; i < m; ++i)
                        for (int j = 0; j <= i; ++j) {
                            const double* block = &K[(i * m * n + j) * n];
                            double* lower = H.block(place_[(static_cast<std::size_t>(e) * m + i) * m + j]);
                            double* upper = H.block(place_[(static_cast<std::size_t>(e) * m + j) * m + i]);
                            for (int a = 0; a < n; ++a)
                                for (int b = 0; b < n; ++b) {
                                    const double value = weight_[e] * block[a * m * n + b];
                                    lower[a * n + b] += value;
                                    if (i != j) upper[b * n + a] += value;
                                }
                        }
                }
            }
        }
    });
}

DistortionStatistics DistortionEnergy::statistics(const std::vector<double>& x) const {
    DistortionStatistics result;
    result.element_max.resize(element_count_);
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
        parallel_for(element_count_, [&](int e) {
            Kernel<n> kernel(*this);
            kernel.start(e, x);
            double largest = 0, squared = 0;
            for (int q = 0; q < quadrature_.count; ++q) {
                const double eta = distortion<n>(kernel.deformation_gradient(kernel.gradients(q)), 0);
                squared += quadrature_.weight[q] * eta * eta;
                largest = std::max(largest, eta);
            }
            for (int i = 0; i < element_nodes_; ++i) {
                const double* dN = &node_gradients_[static_cast<std::size_t>(i) * element_nodes_ * n];
                largest = std::max(largest, distortion<n>(kernel.deformation_gradient(dN), 0));
            }
            result.element_max[e] = largest;
            element_value_[e] = ideal_jacobian_[e] * squared;
        }, quadrature_.count * element_nodes_ * 10.0);
    });
    const double squared_norm = deterministic_sum(element_count_, [this](int e) { return element_value_[e]; });
    result.relative_quality = std::sqrt(volume_ / squared_norm);
    for (double eta : result.element_max) result.max_distortion = std::max(result.max_distortion, eta);
    return result;
}

}  // namespace almesh
