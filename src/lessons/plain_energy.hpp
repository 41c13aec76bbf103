// The distortion energy, its gradient and its Hessian as a textbook would assemble them: one element after the other,
// one quadrature point after the other, dense loops, the second derivative of eta written down from that of the
// determinant, a general eigensolver for its projection, every block found in its row by bisection. Made to be read,
// and the reference that energy/simd_energy.hpp is tested against; ten to fifty times slower. One thread.
//
// At a quadrature point q of element e
//
//     F = sum_i x_i (grad N_i)^T,   grad N_i = A^{-T} dN_i/dxi,   S = |F|^2,   D = det F,   C = dD/dF,   eta = S r(D)
//
//     E    += w f(eta)                                        w = w_e det A times the quadrature's weight
//     g_i  += w P grad N_i,                                   P = f' eta_F,   eta_F = 2 r F + S r' C
//     H_ij += w sum_kl dN_i/dy_k  (d2f / dF_.k dF_.l) dN_j/dy_l
//
//     d2f   = f'' eta_F (x) eta_F + f' eta_FF
//     eta_FF = 2 r I + 2 r' (F (x) C + C (x) F) + S (r'' C (x) C + r' d2D/dF2)
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "energy/densities.hpp"
#include "energy/group_energy.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh {

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
    const Measure measure = measure_of(density);
    const double S = squared_stretch<n>(F, measure);
    const DeterminantFactor<double> factor = measure.derivatives<n>(determinant(F), delta);
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

// One quadrature point of one element.
template <int n>
struct ElementPoint {
    int element;
    const int* node;               // m
    const double* gradient;        // m x n: dN_i/dy_k on the ideal element
    Mat<n> F;
    double w, damping_w, volume;  // weights in E, in the damping, and in an integral over the ideal mesh
};

// Multiplies the negative eigenvalues of a symmetric size x size matrix, row-major, by kept_negative; with 0 what is
// left is its positive semidefinite part. Cyclic Jacobi rotations (Golub & Van Loan, Matrix Computations, sec. 8.5).
inline void project(int size, double* A, double kept_negative = 0) {
    std::vector<double> Q(offset(size, size));
    diagonalise(size, A, Q.data());
    std::vector<double> eigenvalue(size);
    for (int i = 0; i < size; ++i) eigenvalue[i] = std::max(A[i * size + i], kept_negative * A[i * size + i]);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j) {
            A[i * size + j] = 0;
            for (int k = 0; k < size; ++k) A[i * size + j] += eigenvalue[k] * Q[i * size + k] * Q[j * size + k];
        }
}

class PlainEnergy : public GroupEnergy {
public:
    PlainEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params);

    double energy(const std::vector<double>& x) override;
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                     const Projection& projection = {}) override;
    DistortionStatistics statistics(const std::vector<double>& x) override;
    using GroupEnergy::part;
    std::unique_ptr<GroupEnergy> part(const std::vector<double>& x, const Restriction& around) const override;
    void scale_weights(const std::array<double, 2>& factor) override;

private:
    PlainEnergy(const PlainEnergy& whole, const Restriction& around);

    std::vector<IdealElement> ideal_;  // per element

    template <class Body>
    void every_point(const std::vector<double>& x, const Body& body, bool usual = false) const;
};

inline PlainEnergy::PlainEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : GroupEnergy(params, mesh, ideal) {
    nodes_ = mesh.elements;
    pattern_ = pattern_of_cells(mesh.nodes(), dim_, nodes_, reference_.nodes);
    double jacobians = 0;
    for (int e = 0; e < element_count_; ++e) {
        ideal_.push_back(ideal_element(mesh, e, ideal, params_, rules_.usual().reference));
        if (!(ideal_[e].jacobian > 0)) refuse_ideal_element(mesh, e);
        jacobians += ideal_[e].jacobian;
    }
    volume_ = jacobians * reference_.cell->volume();
    double weights = 0, damping_weights = 0;
    for (const IdealElement& entry : ideal_) {
        weights += entry.weight;
        damping_weights += entry.damping_weight;
    }
    normalise_weights({jacobians / weights, jacobians / damping_weights});
}

inline void PlainEnergy::scale_weights(const std::array<double, 2>& factor) {
    for (IdealElement& entry : ideal_) {
        entry.weight *= factor[0];
        entry.damping_weight *= factor[1];
    }
}

// body(point) for every quadrature point of every element.
template <class Body>
void PlainEnergy::every_point(const std::vector<double>& x, const Body& body, bool usual) const {
    const int m = reference_.nodes;
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
        std::vector<double> gradient(offset(m, n));
        std::vector<int> first_nodes(m);
        std::iota(first_nodes.begin(), first_nodes.end(), 0);
        for (int e = 0; e < element_count_; ++e) {
            const IdealElement& ideal = ideal_[e];
            const ElementRule& rule = rules_.of(e, usual);
            Mat<n> inverse_A = matrix_at<n>(ideal.inverse, 0);
            double share = 1;  // det A over its mean
            for (int q = 0; q < rule.reference.points; ++q) {
                if (!curved_ideal_.empty()) {
                    Mat<n> A = jacobian_at<n>(has_one_ideal_ ? first_nodes.data() : element(e), curved_ideal_,
                                              rule.reference, q);
                    if (has_one_ideal_) A = multiply<n>(inverse<n>(matrix_at<n>(ideal.inverse, 0)), A);
                    inverse_A = inverse<n>(A);
                    share = determinant(A) / ideal.jacobian;
                }
                const double* const dN = &rule.reference.gradients[offset(q, m * n)];
                std::fill(gradient.begin(), gradient.end(), 0.0);
                Mat<n> F{};
                for (int i = 0; i < m; ++i)
                    for (int k = 0; k < n; ++k) {
                        for (int l = 0; l < n; ++l) gradient[i * n + k] += dN[i * n + l] * inverse_A[l][k];
                        for (int a = 0; a < n; ++a)  // relative to the first node: the gradients' sum is zero
                            F[a][k] += (point(x, element(e)[i], n)[a] - point(x, element(e)[0], n)[a]) *
                                       gradient[i * n + k];
                    }
                const double weight = rule.reference.weight[q] * share;
                body(ElementPoint<n>{e, element(e), gradient.data(), F, ideal.weight * weight,
                                     ideal.damping_weight * weight, ideal.jacobian * rule.volume[q] * share});
            }
        }
    });
}

inline double PlainEnergy::energy(const std::vector<double>& x) {
    double sum = 0;
    with_density(params_, [&](auto density) {
        every_point(x, [&]<int n>(const ElementPoint<n>& at) {
            sum += at.w * density.f(distortion<n>(at.F, params_.delta, measure_of(density)));
        });
    });
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

inline void PlainEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) {
    with_density(params_, [&](auto density) {
        every_point(x, [&]<int n>(const ElementPoint<n>& at) {
            const Mat<n> P = density_gradient<n>(at.F, params_.delta, density);
            for (int i = 0; i < reference_.nodes; ++i)
                for (int a = 0; a < n; ++a)
                    for (int k = 0; k < n; ++k)
                        point(g, at.node[i], n)[a] += at.w * P[a][k] * at.gradient[i * n + k];
        });
    });
}

inline void PlainEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                              const Projection& projection) {
    const bool projected = kind == HessianKind::projected;
    const double t = projected ? projection.damping : kind == HessianKind::damping ? 1 : 0;
    with_density(params_, [&](auto density) {
        every_point(x, [&]<int n>(const ElementPoint<n>& at) {
            double A[n * n * n * n] = {};  // of w f + t w' eta^2
            if (kind != HessianKind::damping) add_second_derivative<n>(at.F, density, params_.delta, at.w, A);
            if (t > 0)
                add_second_derivative<n>(at.F, Power{measure_of(density), false}, params_.delta, t * at.damping_w, A);
            if (kind != HessianKind::full) project(n * n, A, projected ? projection.kept_negative : 0);
            for (int i = 0; i < reference_.nodes; ++i)
                for (int j = 0; j < reference_.nodes; ++j)
                    H.change_block(H.row_of(at.node[i]), H.row_of(at.node[j]), [&](double* block) {
                        for (int a = 0; a < n; ++a)
                            for (int b = 0; b < n; ++b)
                                for (int k = 0; k < n; ++k)
                                    for (int l = 0; l < n; ++l)
                                        block[a * n + b] += at.gradient[i * n + k] *
                                                            A[(a * n + k) * n * n + b * n + l] * at.gradient[j * n + l];
                    });
        });
    });
}

inline DistortionStatistics PlainEnergy::statistics(const std::vector<double>& x) {
    DistortionStatistics result;
    result.element_max.assign(element_count_, 0.0);
    double squared_norm = 0;  // |M phi|^2
    every_point(x, [&]<int n>(const ElementPoint<n>& at) {
        const double eta = distortion<n>(at.F, 0);
        squared_norm += at.volume * eta * eta;
        result.element_max[at.element] = std::max(result.element_max[at.element], eta);
    }, true);
    result.relative_quality = std::sqrt(volume_ / squared_norm);
    for (double eta : result.element_max) result.max_distortion = std::max(result.max_distortion, eta);
    return result;
}

inline PlainEnergy::PlainEnergy(const PlainEnergy& whole, const Restriction& around)
    : GroupEnergy(whole, around.element, around.node) {
    nodes_ = around.elements;
    pattern_ = pattern_of_cells(static_cast<int>(around.node.size()), dim_, nodes_, reference_.nodes);
    for (const int e : around.element) {
        ideal_.push_back(whole.ideal_[e]);
        volume_ += whole.ideal_[e].jacobian * reference_.cell->volume();
    }
}

inline std::unique_ptr<GroupEnergy> PlainEnergy::part(const std::vector<double>&, const Restriction& around) const {
    return std::unique_ptr<PlainEnergy>(new PlainEnergy(*this, around));
}

}  // namespace almesh
