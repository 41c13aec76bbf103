// The textbook assembly of the distortion energy (distortion_energy.hpp). At a quadrature point q of element e
//
//     F = sum_i x_i (grad N_i)^T,   grad N_i = A^{-T} dN_i/dxi,   S = |F|^2,   D = det F,   C = dD/dF,   eta = S r(D)
//
//     E    += w f(eta)                                        w = w_e det A times the quadrature's weight
//     g_i  += w P grad N_i,                                   P = f' eta_F,   eta_F = 2 r F + S r' C
//     H_ij += w sum_kl dN_i/dy_k  (d2f / dF_.k dF_.l) dN_j/dy_l
//
//     d2f   = f'' eta_F (x) eta_F + f' eta_FF
//     eta_FF = 2 r I + 2 r' (F (x) C + C (x) F) + S (r'' C (x) C + r' d2D/dF2)
#include "energy/plain_energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "energy/densities.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh {
namespace {

// d2D / dF_ij dF_kl = sum_mn e_ikm e_jln F_mn in 3D, e_ik e_jl in 2D, e the permutation symbol.
template <int n>
double determinant_second_derivative(const Mat<n>& F, int i, int j, int k, int l) {
    if constexpr (n == 2) {
        return (k - i) * (l - j);
    } else {
        const auto e = [](int a, int b, int c) { return (a - b) * (b - c) * (c - a) / 2; };
        double sum = 0;
        for (int m = 0; m < 3; ++m)
            for (int p = 0; p < 3; ++p) sum += e(i, k, m) * e(j, l, p) * F[m][p];
        return sum;
    }
}

// Adds w times the second derivative of f(eta) to A: n^2 x n^2, entry (i n + j, k n + l) = d2f / dF_ij dF_kl.
template <int n, class Density>
void add_second_derivative(const Mat<n>& F, Density density, double delta, double w, double* A) {
    const Mat<n> C = cofactor(F);
    const double S = frobenius_squared<n>(F);
    const DeterminantFactor<double> factor = Density::Measure::template derivatives<n>(determinant(F), delta);
    const double r = factor.r, r1 = factor.r1, r2 = factor.r2;
    const double f1 = density.f1(S * r), f2 = density.f2(S * r);
    const auto eta_F = [&](int i, int j) { return 2 * r * F[i][j] + S * r1 * C[i][j]; };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                for (int l = 0; l < n; ++l) {
                    double eta_FF = i == k && j == l ? 2 * r : 0;
                    eta_FF += 2 * r1 * (F[i][j] * C[k][l] + C[i][j] * F[k][l]);
                    eta_FF += S * (r2 * C[i][j] * C[k][l] + r1 * determinant_second_derivative<n>(F, i, j, k, l));
                    A[(i * n + j) * n * n + k * n + l] += w * (f2 * eta_F(i, j) * eta_F(k, l) + f1 * eta_FF);
                }
}

// eta^2 with the measure of another density: what it is damped by.
template <class Density>
Quadratic<typename Density::Measure> square_like(Density) {
    return {false};
}

// Of one element at one quadrature point.
template <int n>
struct ElementPoint {
    const double* gradient;  // m x n: dN_i/dy_k on the ideal element
    Mat<n> F;
    double weight;  // of the point in the reference element: in the functional,
    double volume;  // and in an integral
};

}  // namespace

PlainEnergy::PlainEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : DistortionEnergy(params, mesh),
      refined_place_(mesh.element_count(), -1),
      pattern_(matrix_of_cells(mesh.nodes(), mesh.dim, mesh.elements, mesh.element_nodes())) {
    nodes_ = mesh.elements;
    const double exponent = damping_exponent(dim_, params.weight_exponent);
    double jacobians = 0, weights = 0, damping_weights = 0;
    with_dimension(dim_, [&](auto n) {
        for (int e = 0; e < element_count_; ++e) {
            const Mat<n> A = straight_jacobian<n>(mesh.element(e), ideal), inverse_of_A = inverse<n>(A);
            const double jacobian = determinant(A);
            if (!(jacobian > 0))
                throw InputError("element ", mesh.file.element_id[e], " of the ideal mesh has no positive volume");
            for (const auto& row : inverse_of_A) ideal_inverse_.insert(ideal_inverse_.end(), row.begin(), row.end());
            ideal_jacobian_.push_back(jacobian);
            weight_.push_back(std::pow(jacobian, params.weight_exponent));
            damping_weight_.push_back(std::pow(jacobian, exponent));
            jacobians += jacobian;
            weights += weight_.back();
            damping_weights += damping_weight_.back();
        }
    });
    for (double& w : weight_) w *= jacobians / weights;
    for (double& w : damping_weight_) w *= jacobians / damping_weights;
    volume_ = jacobians * simplex(dim_).volume();
}

// body(point) for every quadrature point of element e.
template <int n, class Body>
void PlainEnergy::every_point(int e, const std::vector<double>& x, const Body& body) const {
    const int m = reference_.nodes;
    const RefinedQuadrature* const refined =
        refined_place_[e] < 0 ? nullptr : refined_[refined_place_[e]].quadrature.get();
    const ReferenceElement& rule = refined ? refined->reference : reference_;
    const std::vector<double>& volume = refined ? refined->volume : rule.weight;
    const double* const inverse_of_A = &ideal_inverse_[offset(e, n * n)];
    std::vector<double> gradient(offset(m, n));
    for (int q = 0; q < rule.points; ++q) {
        const double* const dN = &rule.gradients[offset(q, m * n)];
        std::fill(gradient.begin(), gradient.end(), 0.0);
        Mat<n> F{};
        for (int i = 0; i < m; ++i)
            for (int k = 0; k < n; ++k) {
                for (int l = 0; l < n; ++l) gradient[i * n + k] += dN[i * n + l] * inverse_of_A[l * n + k];
                for (int a = 0; a < n; ++a)  // relative to the first node, whose gradients are minus the others' sum
                    F[a][k] += (point(x, element(e)[i], n)[a] - point(x, element(e)[0], n)[a]) * gradient[i * n + k];
            }
        body(ElementPoint<n>{gradient.data(), F, rule.weight[q], volume[q]});
    }
}

double PlainEnergy::energy(const std::vector<double>& x) {
    double sum = 0;
    with_density(params_, [&](auto density) {
        with_dimension(dim_, [&](auto n) {
            for (int e = 0; e < element_count_; ++e)
                every_point<n>(e, x, [&](const ElementPoint<n>& at) {
                    const double eta = distortion<n>(at.F, params_.delta, typename decltype(density)::Measure());
                    sum += weight_[e] * at.weight * density.f(eta);
                });
        });
    });
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

void PlainEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) {
    with_density(params_, [&](auto density) {
        with_dimension(dim_, [&](auto n) {
            for (int e = 0; e < element_count_; ++e)
                every_point<n>(e, x, [&](const ElementPoint<n>& at) {
                    const Mat<n> P = density_gradient<n>(at.F, params_.delta, density);
                    for (int i = 0; i < reference_.nodes; ++i)
                        for (int a = 0; a < n; ++a)
                            for (int k = 0; k < n; ++k)
                                point(g, element(e)[i], n)[a] +=
                                    weight_[e] * at.weight * P[a][k] * at.gradient[i * n + k];
                });
        });
    });
}

void PlainEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                              const Projection& projection) {
    const bool projected = kind == HessianKind::projected;
    const double t = projected ? projection.damping : kind == HessianKind::damping ? 1 : 0;
    const int m = reference_.nodes;
    with_density(params_, [&](auto density) {
        with_dimension(dim_, [&](auto dimension) {
            constexpr int n = dimension;
            for (int e = 0; e < element_count_; ++e)
                every_point<n>(e, x, [&](const ElementPoint<n>& at) {
                    double A[n * n * n * n] = {};  // of w f + t w' eta^2
                    if (kind != HessianKind::damping)
                        add_second_derivative<n>(at.F, density, params_.delta, weight_[e] * at.weight, A);
                    if (t > 0)
                        add_second_derivative<n>(at.F, square_like(density), params_.delta,
                                                 t * damping_weight_[e] * at.weight, A);
                    if (kind != HessianKind::full) project(n * n, A, projected ? projection.negative_part : 0);
                    for (int i = 0; i < m; ++i)
                        for (int j = 0; j < m; ++j) {
                            double* const block = H.block(H.find(H.row_of(element(e)[i]), H.row_of(element(e)[j])));
                            for (int a = 0; a < n; ++a)
                                for (int b = 0; b < n; ++b)
                                    for (int k = 0; k < n; ++k)
                                        for (int l = 0; l < n; ++l)
                                            block[a * n + b] += at.gradient[i * n + k] *
                                                                A[(a * n + k) * n * n + b * n + l] *
                                                                at.gradient[j * n + l];
                        }
                });
        });
    });
}

void PlainEnergy::order_hessian(const ChooseOrder& choose) {
    auto order = choose(pattern_);
    if (!order) return;
    LargeVector<int> place;
    pattern_ = ordered_pattern(pattern_, std::move(order), place);
    pattern_.value.assign(offset(pattern_.blocks(), dim_ * dim_), 0.0);
}

DistortionStatistics PlainEnergy::statistics(const std::vector<double>& x) {
    DistortionStatistics result;
    result.element_max.assign(element_count_, 0.0);
    double squared_norm = 0;  // |M phi|^2
    with_dimension(dim_, [&](auto n) {
        for (int e = 0; e < element_count_; ++e)
            every_point<n>(e, x, [&](const ElementPoint<n>& at) {
                const double eta = distortion<n>(at.F, 0);
                squared_norm += ideal_jacobian_[e] * at.volume * eta * eta;
                result.element_max[e] = std::max(result.element_max[e], eta);
            });
    });
    result.relative_quality = std::sqrt(volume_ / squared_norm);
    for (double eta : result.element_max) result.max_distortion = std::max(result.max_distortion, eta);
    return result;
}

PlainEnergy::PlainEnergy(const PlainEnergy& whole, SubMesh chosen)
    : DistortionEnergy(whole, static_cast<int>(chosen.place.size())),
      refined_place_(element_count_, -1),
      pattern_(matrix_of_cells(static_cast<int>(chosen.node.size()), dim_, chosen.elements, reference_.nodes)) {
    nodes_ = std::move(chosen.elements);
    place_in_whole_ = std::move(chosen.place);
    for (const int e : place_in_whole_) {
        const double* const inverse_of_A = &whole.ideal_inverse_[offset(e, dim_ * dim_)];
        ideal_inverse_.insert(ideal_inverse_.end(), inverse_of_A, inverse_of_A + dim_ * dim_);
        ideal_jacobian_.push_back(whole.ideal_jacobian_[e]);
        weight_.push_back(whole.weight_[e]);
        damping_weight_.push_back(whole.damping_weight_[e]);
        volume_ += whole.ideal_jacobian_[e] * simplex(dim_).volume();
    }
    take_refined_of(whole);
}

std::unique_ptr<DistortionEnergy> PlainEnergy::part(const std::vector<double>&, const std::vector<char>& moves,
                                                    std::vector<int>& node) const {
    SubMesh chosen = elements_around(nodes_, element_count_, reference_.nodes, moves);
    node = chosen.node;
    return std::unique_ptr<PlainEnergy>(new PlainEnergy(*this, std::move(chosen)));
}

void project(int size, double* A, double negative_part) {
    std::vector<double> Q(offset(size, size));
    diagonalise(size, A, Q.data());
    std::vector<double> eigenvalue(size);
    for (int i = 0; i < size; ++i) eigenvalue[i] = std::max(A[i * size + i], negative_part * A[i * size + i]);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) {
            A[i * size + j] = 0;
            for (int k = 0; k < size; ++k) A[i * size + j] += eigenvalue[k] * Q[i * size + k] * Q[j * size + k];
        }
}

}  // namespace almesh
