// Energy, gradient and Hessian of `lanes` linear elements at once, each element in its own lane: every formula is that
// of one element. F is constant on a linear element, so that one point is enough and everything fits the registers.
//
// The derivatives of the basis on the reference element are unit vectors but for the first node's, which are minus the
// sum of the others'. So the gradient is the density's derivative by J = F A and minus its row sums, and the Hessian
// its second derivatives by J (density_hessian.hpp), bordered by minus their row sums.
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "energy/density_hessian.hpp"
#include "energy/gradient_products.hpp"
#include "energy/point_lanes.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

template <int n>
class LinearBatch {
public:
    static constexpr int dimension = n;

    LinearBatch(const ReferenceElement& reference, const GradientProducts&) : volume_(reference.weight[0]) {}

    // node: lanes x m nodes of the elements, x: nodes x n. node and ideal.inverse are looked at until the next start().
    void start(const int* node, const std::vector<double>& x, const IdealLanes<n>& ideal) {
        node_ = node;
        ideal_inverse_ = &ideal.inverse;
        for (int a = 0; a < n; ++a) {
            const Lanes origin = gathered(x.data() + a, node, all_lanes());
            for (int k = 0; k < n; ++k) J_[a][k] = gathered(x.data() + a, node + k + 1, all_lanes()) - origin;
        }
        F_ = multiply<n>(J_, ideal.inverse);
    }

    Lanes distortion_at(int) const { return distortion<n>(F_, 0); }
    Lanes share_at(int) const { return in_all_lanes(1); }

    // Per unit of det A; infinite or nan for an inverted element.
    template <class Density>
    Lanes energy(Density density, double delta) const {
        return volume_ * density.f(distortion<n>(F_, delta, measure_of(density)));
    }

    // Adds to g (nodes x n) the gradient of the first `count` elements, times `factor`.
    template <class Density>
    void add_gradient(Density density, double delta, Lanes factor, int count, double* g) const {
        const Mat<n, Lanes> P = multiply<n>(density_gradient<n>(F_, delta, density), transpose<n>(*ideal_inverse_));
        const Lanes weight = factor * volume_;
        Lanes part[m][n];
        for (int a = 0; a < n; ++a) {
            Lanes sum{};
            for (int k = 0; k < n; ++k) {
                sum += P[a][k];
                part[k + 1][a] = weight * P[a][k];
            }
            part[0][a] = -weight * sum;
        }
        // The first two components of each lane side by side, to be added as a pair: those of lane l are in register
        // l & 1 from l & ~1 on.
        for (int i = 0; i < m; ++i) exchange_blocks<1>(part[i][0], part[i][1], all_lanes());
        for (int l = 0; l < count; ++l)
            for (int i = 0; i < m; ++i) {
                const double* const pair = reinterpret_cast<const double*>(&part[i][l & 1]) + (l & ~1);
                double* const gi = g + offset(node_[l * m + i], n);
                gi[0] += pair[0];
                gi[1] += pair[1];
                if constexpr (n == 3) gi[2] += part[i][2][l];
            }
    }

    // The Hessian of each element after the other, times `factor`: lanes x stride(), blocks (i, j) of n x n numbers row
    // by row, both triangles. kept_negative: see density_hessian().
    template <class Density>
    const double* hessian(const Density& density, double delta, double kept_negative, Lanes factor) {
        const Tensor<n> C =
            density_hessian<n>(J_, *ideal_inverse_, factor * volume_, density, delta, kept_negative);
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                Lanes corner{};
                for (int k = 0; k < n; ++k) {
                    Lanes row{};
                    for (int l = 0; l < n; ++l) {
                        row += C[k][l][a][b];
                        entry(k + 1, l + 1, a, b) = C[k][l][a][b];
                    }
                    entry(k + 1, 0, a, b) = entry(0, k + 1, b, a) = -row;
                    corner += row;
                }
                entry(0, 0, a, b) = corner;
            }
        return separate_lanes(hessian_, entries, separate_);
    }
    static constexpr std::size_t stride() { return whole_registers(entries); }

private:
    static constexpr int m = n + 1, entries = m * m * n * n;

    static auto all_lanes() { return std::make_integer_sequence<int, lanes>(); }

    template <int... l>
    static Lanes gathered(const double* x, const int* node, std::integer_sequence<int, l...>) {
        return Lanes{x[offset(node[l * m], n)]...};
    }

    Lanes& entry(int i, int j, int a, int b) { return hessian_[((i * m + j) * n + a) * n + b]; }

    const double volume_;  // of the reference element
    const int* node_ = nullptr;
    const Mat<n, Lanes>* ideal_inverse_ = nullptr;
    Mat<n, Lanes> J_, F_;
    Lanes hessian_[whole_registers(entries)] = {}, separate_[whole_registers(entries)];  // pads are zero
};

}  // namespace almesh
