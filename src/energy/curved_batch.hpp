// Energy, gradient and Hessian of `lanes` elements at once whose F is not constant, each in its own lane: all arrays
// here are structures of lanes, so that every formula is that of one element. Or of one element with a long rule, which
// is in all lanes, each lane with its own points; the sum over the lanes is that over the points.
//
// Derivatives of the basis are those on the reference element, the same for all elements: the density is differentiated
// with respect to J = sum x_i (grad N_i)^T = F A instead of F, which costs nothing (density_hessian.hpp). The Hessian's
// block of nodes i and j is a sum over the points of products of two gradients with the density's second derivatives,
// made from moments of these (gradient_products.hpp); of other cells that sum itself, of products along a line first.
// Points are taken in blocks, so that a tile of moments, or a block of the Hessian, stays in registers while it gathers
// a block's share.
#pragma once
#include <algorithm>
#include <type_traits>
#include <vector>

#include "base/index.hpp"
#include "energy/density_hessian.hpp"
#include "energy/gradient_products.hpp"
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

    CurvedBatch(const Reference& reference, const GradientProducts& products) : of_(reference), products_(products) {}

    // node: lanes x m nodes of the elements, x: nodes x n. node is looked at until the next start().
    void start(const int* node, const std::vector<double>& x, const IdealLanes<n>& ideal) {
        node_ = node;
        gather(x, position_);
        ideal_inverse_ = ideal.inverse;
        share_ = in_all_lanes(1);
        is_ideal_curved_ = !ideal.curved.empty();
        if (!is_ideal_curved_) return;
        if (ideal.has_one) scale(ideal);
        else gather(ideal.curved, ideal_position_);
        inverse_mean_ = select(ideal.jacobian > 0, 1.0 / ideal.jacobian, Lanes{});
    }

    Lanes distortion_at(int q) const { return distortion<n>(multiply<n>(jacobian(q), inverse_A(q)), 0); }
    // det A over its mean: what the point weighs more or less than on a straight ideal element.
    Lanes share_at(int q) const {
        inverse_A(q);
        return share_;
    }

    // Per unit of det A; infinite or nan for an inverted element.
    template <class Density>
    Lanes energy(Density density, double delta, int part = 0) const {
        Lanes sum{};
        for (int q = part * part_points(); q < (part + 1) * part_points(); ++q) {
            const Mat<n, Lanes> F = multiply<n>(jacobian(q), inverse_A(q));
            sum += of_.weight[q] * share_ * density.f(distortion<n>(F, delta, measure_of(density)));
        }
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
        sum_of_points(gradient_, size_, [&](int begin, int end) {
            for (int q = begin; q < end; ++q) {
                const Mat<n, Lanes> F = multiply<n>(jacobian(q), inverse_A(q));
                const Mat<n, Lanes> P =
                    multiply<n>(density_gradient<n>(F, delta, density), transpose<n>(ideal_inverse_));
                const Lanes weight = factor * of_.weight[q] * share_;
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
    // by row, both triangles. kept_negative: see density_hessian().
    template <class Density>
    const double* hessian(const Density& density, double delta, double kept_negative, Lanes factor) {
        const bool by_moments = products_.moments > 0;
        const int size = by_moments ? products_.moments * directions * entries : size_ * size_;
        sum_of_points(by_moments ? moment_ : hessian_, size, [&](int begin, int end) {
            for (int q = begin, count, number = 0; q < end; q += count, ++number) {
                const ProductPoints* const product = of_.products.empty() ? nullptr : &of_.products[number];
                count = product ? product->of_base * product->of_line : std::min(point_block, end - q);
                for (int k = 0; k < count; ++k) {
                    const int at = product ? product->point[k] : q + k;
                    const Mat<n, Lanes>& of_ideal = inverse_A(at);
                    keep_upper(k, density_hessian<n>(jacobian(at), of_ideal, factor * of_.weight[at] * share_, density,
                                                     delta, kept_negative));
                }
                if (by_moments) add_moments(q, count);
                else if (product) add_product(*product);
                else add_points(q, count);
            }
        });
        if (by_moments) turn_to_hessian();
        const auto node = [&](int k) { return of_.products.empty() ? k : of_.product_node[k]; };
        for (int i = 0; i < m_; ++i)
            for (int j = 0; j < i; ++j) transpose_block(block(node(i), node(j)), block(node(j), node(i)));
        return separate_lanes(hessian_, size_ * size_, separate_);
    }

    std::size_t stride() const { return whole_registers(size_ * size_); }

private:
    static constexpr int point_block = 8;             // points whose tensors fit the innermost cache
    static constexpr int tile_rows = n == 2 ? 5 : 3;  // blocks of moments that fit the registers
    static constexpr int entries = n * n;             // of a block
    static constexpr int directions = n * (n + 1) / 2, pairs = (n + 1) * (n + 2) / 2;

    const Reference& of_;
    const GradientProducts& products_;
    const int m_ = of_.nodes, size_ = m_ * n;
    const int* node_ = nullptr;
    bool is_ideal_curved_ = false;
    mutable Mat<n, Lanes> ideal_inverse_;  // A^{-1} and share_at() of the elements, or of the last point asked for
    mutable Lanes share_;
    Lanes inverse_mean_;      // 1 over the mean det A of curved ideal elements; 0 where they weigh nothing
    Lanes* const position_ = workspace(room());          // m x n, relative to the first node
    Lanes* const ideal_position_ = position_ + size_;     // the same of curved ideal elements
    Lanes* const gradient_ = ideal_position_ + size_;     // m x n
    Lanes* const hessian_ = gradient_ + size_;            // m x m blocks of n x n
    Lanes* const separate_ = hessian_ + stride();         // the gradient or Hessian, element after element
    Lanes* const second_ = separate_ + stride();         // points at hand x directions: C_kl, k <= l
    Lanes* const column_ = second_ + at_hand() * directions * entries;  // point_block x n x n: sums of C_kl over lines
    Lanes* const moment_ = column_ + point_block * n * n * entries;  // moments x directions: sums over the points of
                                                                     // C_kl times a monomial
    Lanes* const barycentric_ = moment_ + products_.moments * directions * entries;  // moments x pairs: by barycentric
                                                                                     // coordinates v <= w
    Lanes* const line_ = barycentric_ + products_.moments * pairs * entries;  // m: a row or column of blocks

    std::size_t room() const {
        const std::size_t blocks = at_hand() * directions + point_block * n * n +
                                   products_.moments * (directions + pairs) + m_;
        return 3 * size_ + 2 * stride() + blocks * entries;
    }
    int at_hand() const {
        int most = point_block;
        for (const ProductPoints& points : of_.products) most = std::max(most, points.of_base * points.of_line);
        return most;
    }
    Lanes* block(int i, int j) { return hessian_ + (i * m_ + j) * entries; }

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
    const Number* monomials(int q) const { return &of_.monomials[offset(q, products_.moments)]; }

    // Positions of the elements' nodes, relative to the first node of each: exact differences.
    void gather(const std::vector<double>& x, Lanes* to) const {
        for (int i = 0; i < m_; ++i)
            for (int l = 0; l < lanes; ++l) {
                const double* const xi = &x[offset(node_[l * m_ + i], n)];
                for (int a = 0; a < n; ++a) to[i * n + a][l] = xi[a];
            }
        for (int i = m_ - 1; i >= 0; --i)
            for (int a = 0; a < n; ++a) to[i * n + a] -= to[a];
    }

    // The one ideal element by the map of each.
    void scale(const IdealLanes<n>& ideal) const {
        const Mat<n, Lanes> map = almesh::inverse<n>(ideal.inverse);
        for (int i = 0; i < m_; ++i)
            for (int a = 0; a < n; ++a) {
                Lanes& sum = ideal_position_[i * n + a] = Lanes{};
                for (int k = 0; k < n; ++k) sum += map[a][k] * (ideal.curved[i * n + k] - ideal.curved[k]);
            }
    }

    Mat<n, Lanes> jacobian(int q) const { return jacobian(position_, q); }
    Mat<n, Lanes> jacobian(const Lanes* position, int q) const {
        Mat<n, Lanes> J = {};
        const Number* const dN = gradients(q);
        for (int i = 1; i < m_; ++i)  // the first node is the origin
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k) J[a][k] += position[i * n + a] * dN[i * n + k];
        return J;
    }

    const Mat<n, Lanes>& inverse_A(int q) const {
        if (is_ideal_curved_) {
            const Mat<n, Lanes> A = jacobian(ideal_position_, q);
            ideal_inverse_ = inverse<n>(A);
            share_ = determinant(A) * inverse_mean_;
        }
        return ideal_inverse_;
    }

    // The blocks C_kl, k <= l, of the point-th point at hand.
    void keep_upper(int point, const Tensor<n>& C) {
        Lanes* to = second_ + point * directions * entries;
        for (int k = 0; k < n; ++k)
            for (int l = k; l < n; ++l)
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) *to++ = C[k][l][a][b];
    }

    // Adds the products of the gradients of rows i and j with C, summed up over `count` points, to the blocks (i, j),
    // in a symmetric part but those with j > i. gradient(point, i): n numbers. C(point, k, l, e): entry e of C_kl.
    template <class Gradient, class Second, class Block>
    [[gnu::always_inline]] inline void add_products(int rows, int count, bool symmetric, const Gradient& gradient, const Second& C,
                      const Block& block_of) {
        Lanes row[point_block][n][entries];  // sum_k dN_i/dxi_k C_kl
        for (int i = 0; i < rows; ++i) {
            for (int point = 0; point < count; ++point) {
                const auto* const dN = gradient(point, i);
                for (int l = 0; l < n; ++l)
                    for (int e = 0; e < entries; ++e) {
                        row[point][l][e] = dN[l] * C(point, l, l, e);
                        for (int k = 0; k < l; ++k) row[point][l][e] += dN[k] * C(point, k, l, e);
                        for (int k = l + 1; k < n; ++k) row[point][l][e] += dN[k] * C(point, k, l, e);
                    }
            }
            for (int j = 0; j < (symmetric ? i + 1 : rows); ++j) {
                Lanes* const to = block_of(i, j);
                Lanes sum[entries];
                std::copy_n(to, entries, sum);
                for (int point = 0; point < count; ++point)
                    for (int l = 0; l < n; ++l) {
                        const auto dN = gradient(point, j)[l];
                        for (int e = 0; e < entries; ++e) sum[e] += row[point][l][e] * dN;
                    }
                std::copy_n(sum, entries, to);
            }
        }
    }

    // Of the point-th point at hand.
    const Lanes& second(int point, int k, int l, int e) const {
        if (k > l) return second(point, l, k, e % n * n + e / n);
        return second_[(point * directions + upper_place(n, k, l)) * entries + e];
    }

    // Adds a block of points to the lower triangle of the Hessian.
    void add_points(int q, int count) {
        add_products(
            m_, count, true, [&](int point, int i) { return gradients(q + point) + i * n; },
            [&](int point, int k, int l, int e) -> const Lanes& { return second(point, k, l, e); },
            [&](int i, int j) { return block(i, j); });
    }

    // Adds all points of a product to one triangle of the Hessian, that of its nodes (b, z): for each two places of
    // its line the sums over the points of the line, then those over the base.
    void add_product(const ProductPoints& points) {
        const int levels = of_.degree + 1, of_level = m_ / levels;
        for (int y = 0; y < levels; ++y)
            for (int z = 0; z <= y; ++z)
                for (int r = 0; r < points.of_base; r += point_block) {
                    const int count = std::min(point_block, points.of_base - r);
                    for (int point = 0; point < count; ++point) sum_up_line(points, r + point, y, z, point);
                    add_products(
                        of_level, count, y == z,
                        [&](int point, int b) { return &points.base[((r + point) * of_level + b) * n]; },
                        [&](int point, int k, int l, int e) -> const Lanes& {
                            return column_[((point * n + k) * n + l) * entries + e];
                        },
                        [&](int b, int c) {
                            return block(of_.product_node[y * of_level + b], of_.product_node[z * of_level + c]);
                        });
                }
    }

    // To point `to` of column_: the sums over the points of the line above r of C_kl times the factors at y and z.
    void sum_up_line(const ProductPoints& points, int r, int y, int z, int to) {
        const int S = points.of_line, width = 2 * (of_.degree + 1);
        for (int k = 0; k < n; ++k)
            for (int l = 0; l < n; ++l) {
                Lanes sum[entries] = {};
                for (int s = 0; s < S; ++s) {
                    const double* const L = &points.line[s * width];
                    const double factor = L[2 * y + (k == n - 1)] * L[2 * z + (l == n - 1)];
                    for (int e = 0; e < entries; ++e) sum[e] += factor * second(r * S + s, k, l, e);
                }
                std::copy_n(sum, entries, column_ + ((to * n + k) * n + l) * entries);
            }
    }

    // Adds a block of points to the moments, and the Hessian of those.
    void add_moments(int q, int count) {
        for (int direction = 0; direction < directions; ++direction) {
            int c = 0;
            for (; c + tile_rows <= products_.moments; c += tile_rows) add_moments<tile_rows>(c, direction, q, count);
            for (; c < products_.moments; ++c) add_moments<1>(c, direction, q, count);
        }
    }
    void turn_to_hessian() {
        turn_to_barycentric();
        for (int a = 0, k = 0; a < m_; ++a)
            for (int b = 0; b <= a; ++b, ++k) {
                sum_up_terms(k, block(a, b));
                transpose_block(block(a, b), block(b, a));
            }
        turn_to_nodes();
    }

    // Adds a block of points to the moments c, ..., c + rows - 1.
    template <int rows>
    void add_moments(int c, int direction, int q, int count) {
        const auto moment = [&](int r) { return moment_ + ((c + r) * directions + direction) * entries; };
        Lanes sum[rows][entries];
        for (int r = 0; r < rows; ++r)
            for (int e = 0; e < entries; ++e) sum[r][e] = moment(r)[e];
        for (int point = 0; point < count; ++point) {
            const Lanes* const C = second_ + (point * directions + direction) * entries;
            const Number* const power = monomials(q + point) + c;
            for (int e = 0; e < entries; ++e)
                for (int r = 0; r < rows; ++r) sum[r][e] += C[e] * power[r];
        }
        for (int r = 0; r < rows; ++r)
            for (int e = 0; e < entries; ++e) moment(r)[e] = sum[r][e];
    }

    // barycentric_ from moment_: grad l_k is the k-th unit vector, grad l_0 minus their sum.
    void turn_to_barycentric() {
        for (int c = 0; c < products_.moments; ++c) {
            const Lanes* const M = moment_ + c * directions * entries;
            Lanes* const D = barycentric_ + c * pairs * entries;
            const auto of_pair = [&](int v, int w) { return D + upper_place(n + 1, v, w) * entries; };
            std::fill_n(D, (n + 1) * entries, Lanes{});
            for (int k = 0; k < n; ++k)
                for (int l = k; l < n; ++l) {
                    const Lanes* const from = M + upper_place(n, k, l) * entries;
                    std::copy_n(from, entries, of_pair(k + 1, l + 1));
                    for (int a = 0; a < n; ++a)
                        for (int b = 0; b < n; ++b) {
                            of_pair(0, l + 1)[a * n + b] -= from[a * n + b];
                            if (k < l) of_pair(0, k + 1)[a * n + b] -= from[b * n + a];
                        }
                }
            for (int l = 1; l <= n; ++l)
                for (int e = 0; e < entries; ++e) D[e] -= of_pair(0, l)[e];
        }
    }

    // The k-th block of the lower triangle of K'.
    void sum_up_terms(int k, Lanes* to) const {
        Lanes sum[entries] = {};
        for (int t = products_.term_start[k]; t < products_.term_start[k + 1]; ++t) {
            const GradientProducts::Term& term = products_.term[t];
            const Lanes* const D = barycentric_ + (term.moment * pairs + term.pair) * entries;
            if (term.transposed)
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b) sum[a * n + b] += term.factor * D[b * n + a];
            else
                for (int e = 0; e < entries; ++e) sum[e] += term.factor * D[e];
        }
        for (int e = 0; e < entries; ++e) to[e] = sum[e];
    }

    // K = T' K' T in the place of K', of which the lower triangle is made.
    void turn_to_nodes() {
        const auto sum_up = [&](int i, auto&& of_row, Lanes* to) {
            Lanes sum[entries] = {};
            for (int t = products_.entry_start[i]; t < products_.entry_start[i + 1]; ++t) {
                const Lanes* const from = of_row(products_.entry[t].row);
                for (int e = 0; e < entries; ++e) sum[e] += products_.entry[t].value * from[e];
            }
            for (int e = 0; e < entries; ++e) to[e] = sum[e];
        };
        for (int a = 0; a < m_; ++a) {
            std::copy_n(block(a, 0), m_ * entries, line_);
            for (int j = 0; j < m_; ++j) sum_up(j, [&](int b) { return line_ + b * entries; }, block(a, j));
        }
        for (int j = 0; j < m_; ++j) {
            for (int a = 0; a < m_; ++a) std::copy_n(block(a, j), entries, line_ + a * entries);
            for (int i = j; i < m_; ++i) sum_up(i, [&](int a) { return line_ + a * entries; }, block(i, j));
        }
    }

    static void transpose_block(const Lanes* from, Lanes* to) {
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) to[b * n + a] = from[a * n + b];
    }
};

}  // namespace almesh
