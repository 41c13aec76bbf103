// Energy, gradient and Hessian of `lanes` elements of degree p > 1 at once, each element in its own lane: all arrays
// here are structures of lanes, so that every formula is that of one element. Or of one element with a long rule, which
// is in all lanes, each lane with its own points; the sum over the lanes is that over the points.
//
// Derivatives of the basis are those on the reference element, the same for all elements: the density is differentiated
// with respect to J = sum x_i (grad N_i)^T = F A instead of F, which costs nothing (density_hessian.hpp). The Hessian's
// block of nodes i and j is then a sum over the points q and the directions k, l
//
//     K_ij = sum_q sum_k dN_i/dxi_k T_jk,   T_jk = sum_l C_kl dN_j/dxi_l,   C_kl: n x n blocks of second derivatives,
//
// n + n/(m-i) multiplications per entry and point. Points are taken in blocks, so that a tile of K stays in registers
// while it gathers a block's share.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "base/index.hpp"
#include "energy/density_hessian.hpp"
#include "energy/point_lanes.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

// Reference: ReferenceElement, or PointLanes for one element.
template <int n, class Reference = ReferenceElement>
class CurvedBatch {
public:
    static constexpr int dimension = n;
    static constexpr bool points_in_lanes = std::is_same_v<Reference, PointLanes>;
    using Number = std::conditional_t<points_in_lanes, Lanes, double>;  // of the rule

    explicit CurvedBatch(const Reference& reference)
        : of_(reference), m_(reference.nodes), size_(m_ * n), position_(workspace(room())) {
        gradient_ = position_ + size_;
        hessian_ = gradient_ + size_;
        separate_ = hessian_ + stride();
        second_ = separate_ + stride();
        applied_ = second_ + point_block * n * n * n * n;
    }

    int nodes() const { return m_; }

    // node: lanes x m nodes of the elements, x: nodes x n. ideal_inverse: A^{-1} of the elements.
    // node and ideal_inverse are looked at until the next start().
    void start(const int* node, const std::vector<double>& x, const Mat<n, Lanes>& ideal_inverse) {
        node_ = node;
        ideal_inverse_ = &ideal_inverse;
        for (int i = 0; i < m_; ++i)
            for (int l = 0; l < lanes; ++l) {
                const double* const xi = &x[offset(node[l * m_ + i], n)];
                for (int a = 0; a < n; ++a) position_[i * n + a][l] = xi[a];
            }
        for (int i = m_ - 1; i >= 0; --i)  // relative to the element's first node: exact differences
            for (int a = 0; a < n; ++a) position_[i * n + a] -= position_[a];
    }

    Lanes distortion_at(int q) const { return distortion<n>(multiply<n>(jacobian(q), *ideal_inverse_), 0); }

    // Per unit of det A; infinite or nan for an inverted element.
    template <class Density>
    Lanes energy(Density density, double delta, int part = 0) const {
        Lanes sum{};
        for (int q = part * part_points(); q < (part + 1) * part_points(); ++q)
            sum += of_.weight[q] * density.f(distortion<n>(multiply<n>(jacobian(q), *ideal_inverse_), delta,
                                                           typename Density::Measure()));
        return sum;
    }

    // The same of the one element whose points are in the lanes.
    template <class Density>
    double energy_of_element(Density density, double delta) const {
        double sum = 0;
        for (int part = 0; part < parts; ++part) sum = sum_of_lanes(energy(density, delta, part), sum);
        return sum;
    }

    // The gradient of each element after the other, times `factor`: lanes x whole_registers(nodes x n).
    template <class Density>
    const double* gradient(const Density& density, double delta, Lanes factor) {
        const Mat<n, Lanes> ideal_inverse_transposed = transpose<n>(*ideal_inverse_);
        sum_of_points(gradient_, size_, [&](int begin, int end) {
            for (int q = begin; q < end; ++q) {
                const Mat<n, Lanes> F = multiply<n>(jacobian(q), *ideal_inverse_);
                const Mat<n, Lanes> P = multiply<n>(density_gradient<n>(F, delta, density), ideal_inverse_transposed);
                const Lanes weight = factor * of_.weight[q];
                const Number* const dN = gradients(q);
                for (int i = 0; i < m_; ++i)
                    for (int a = 0; a < n; ++a) {
                        Lanes sum = P[a][0] * dN[i * n];
                        for (int k = 1; k < n; ++k) sum += P[a][k] * dN[i * n + k];
                        gradient_[i * n + a] += weight * sum;
                    }
            }
        });
        return separate_lanes(gradient_, size_, separate_);
    }

    // Adds it to g (nodes x n) for the first `count` elements.
    template <class Density>
    void add_gradient(const Density& density, double delta, Lanes factor, int count, double* g) {
        const double* part = gradient(density, delta, factor);
        for (int l = 0; l < count; ++l, part += whole_registers(size_))
            for (int i = 0; i < m_; ++i)
                for (int a = 0; a < n; ++a) g[offset(node_[l * m_ + i], n, a)] += part[i * n + a];
    }

    // The Hessian of each element after the other, times `factor`: lanes x stride(), blocks (i, j) of n x n numbers row
    // by row, both triangles.
    template <class Density>
    const double* hessian(const Density& density, double delta, bool projected, Lanes factor) {
        sum_of_points(hessian_, size_ * size_, [&](int begin, int end) {
            for (int q = begin; q < end; q += point_block) {
                const int count = std::min(point_block, end - q);
                for (int k = 0; k < count; ++k)
                    tensor(k) = density_hessian<n>(jacobian(q + k), *ideal_inverse_, factor * of_.weight[q + k],
                                                   density, delta, projected);
                for (int j = 0; j < m_; ++j) {
                    apply_to_node(j, q, count);
                    int i = j;
                    for (; i + tile_rows <= m_; i += tile_rows) add_blocks<tile_rows>(i, j, q, count);
                    for (; i < m_; ++i) add_blocks<1>(i, j, q, count);
                }
            }
        });
        for (int i = 0; i < m_; ++i)
            for (int j = 0; j < i; ++j)
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) block(j, i)[b * n + a] = block(i, j)[a * n + b];
        return separate_lanes(hessian_, size_ * size_, separate_);
    }

    std::size_t stride() const { return whole_registers(size_ * size_); }

private:
    static constexpr int point_block = 8;               // points whose tensors fit the innermost cache
    static constexpr int tile_rows = n == 2 ? 5 : 3;    // blocks K_ij of one j that fit the registers

    const Reference& of_;
    const int m_, size_;
    const int* node_ = nullptr;
    const Mat<n, Lanes>* ideal_inverse_ = nullptr;
    Lanes* const position_;  // m x n, relative to the first node
    Lanes* gradient_;        // m x n
    Lanes* hessian_;         // m x m blocks of n x n
    Lanes* separate_;        // the gradient or Hessian, element after element
    Lanes* second_;          // point_block tensors C
    Lanes* applied_;         // point_block x n x n x n: T_jk for the current j

    std::size_t room() const { return 2 * size_ + 2 * stride() + point_block * (n * n * n * n + n * n * n); }
    Lanes* block(int i, int j) { return hessian_ + (i * m_ + j) * n * n; }

    // Kept by each thread between calls: nothing is allocated inside the Newton loop.
    static Lanes* workspace(std::size_t size) {
        thread_local std::vector<Lanes> values;
        if (values.size() < size) values.resize(size);
        return values.data();
    }

    static constexpr int parts = points_in_lanes ? PointLanes::parts : 1;
    int part_points() const { return of_.points / parts; }

    // add(begin, end) adds the points [begin, end) to values. With points in lanes all lanes get the sum over these.
    template <class Add>
    void sum_of_points(Lanes* values, int count, const Add& add) {
        if constexpr (points_in_lanes) {
            thread_local std::vector<double> total;  // kept between calls
            total.assign(count, 0);
            for (int part = 0; part < parts; ++part) {
                std::fill_n(values, count, Lanes{});
                add(part * part_points(), (part + 1) * part_points());
                for (int i = 0; i < count; ++i) total[i] = sum_of_lanes(values[i], total[i]);
            }
            for (int i = 0; i < count; ++i) values[i] = in_all_lanes(total[i]);
        } else {
            std::fill_n(values, count, Lanes{});
            add(0, of_.points);
        }
    }

    const Number* gradients(int q) const { return &of_.gradients[offset(q, size_)]; }
    Tensor<n>& tensor(int k) { return reinterpret_cast<Tensor<n>*>(second_)[k]; }

    Mat<n, Lanes> jacobian(int q) const {
        Mat<n, Lanes> J = {};
        const Number* const dN = gradients(q);
        for (int i = 1; i < m_; ++i)  // the first node is the origin
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k) J[a][k] += position_[i * n + a] * dN[i * n + k];
        return J;
    }

    // T_jk for the points q, q + 1, ..., q + count - 1.
    void apply_to_node(int j, int q, int count) {
        for (int point = 0; point < count; ++point) {
            const Number* const dN = gradients(q + point) + j * n;
            const Tensor<n>& C = tensor(point);
            Lanes* T = applied_ + point * n * n * n;
            for (int k = 0; k < n; ++k)
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) {
                        Lanes sum = C[k][0][a][b] * dN[0];
                        for (int l = 1; l < n; ++l) sum += C[k][l][a][b] * dN[l];
                        *T++ = sum;
                    }
        }
    }

    // Adds a block of points to the blocks (i, j), ..., (i + rows - 1, j).
    template <int rows>
    void add_blocks(int i, int j, int q, int count) {
        Lanes sum[rows][n * n];
        for (int r = 0; r < rows; ++r)
            for (int e = 0; e < n * n; ++e) sum[r][e] = block(i + r, j)[e];
        const Lanes* T = applied_;
        for (int point = 0; point < count; ++point) {
            const Number* const dN = gradients(q + point) + i * n;
            for (int k = 0; k < n; ++k, T += n * n)
                for (int e = 0; e < n * n; ++e)
                    for (int r = 0; r < rows; ++r) sum[r][e] += T[e] * dN[r * n + k];
        }
        for (int r = 0; r < rows; ++r)
            for (int e = 0; e < n * n; ++e) block(i + r, j)[e] = sum[r][e];
    }
};

}  // namespace almesh
