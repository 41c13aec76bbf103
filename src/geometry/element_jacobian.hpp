// The determinant of the map of an element as a polynomial in Bezier form, alone or while its nodes move along straight
// lines from one position to another.
//
// The nodes are first taken to reference coordinates, relative to node 0: there a boundary-layer element of aspect
// ratio 50000 is of size one like any other. This is done by the inverse of J_c, the derivative of the map at the
// centre with columns made perpendicular; of simplices the Jacobian of the straight-sided one of the vertices, where it
// is not much smaller, as in a valid element so bent that its vertices are nearly on a line. With y = J_c^{-1} (x - x_0)
//
//     det J / det J_c = (dy/dxi_0 x dy/dxi_1) . dy/dxi_2     (n = 2: dy/dxi_0 x dy/dxi_1)
//
// is a product of polynomials, which have in each factor of the cell the degree p, but p - 1 in that of their
// coordinate (of pyramids, below):
//
//     simplex n (p - 1),   quadrilateral (2 p - 1, 2 p - 1),   hexahedron 3 p - 1 in each,   prism (3 p - 2, 3 p - 1).
//
// Interpolating det J at the nodes of that degree instead would multiply rounding errors by the condition number of
// that interpolation, which grows exponentially with the degree.
//
// On a pyramid (cells.hpp) the derivatives are the reduced ones. x has degree p - k in a and b in its layer
// B_k^p(c) = binomial(p, k) c^k (1 - c)^(p - k), so that its derivatives by a and b have no layer k = p, and
//
//     B_k^p(c) / (1 - c) = p / (p - k) B_k^{p-1}(c):
//
// times their multinomials, coefficients stay what they are. They have the degrees (p - 1, p, p - 1), (p, p - 1, p - 1)
// and (p, p, p - 1); det J has (3 p - 1, 3 p - 1, 3 p - 3).
//
// Along (1 - s) x + s x' the determinant is a polynomial of degree n in s as well. Its Bernstein coefficients b_0, ...,
// b_n in s, each a polynomial in the reference coordinates, are those products with the derivatives taken from x or x'
// in all ways, k of them from x' in b_k. Where all coefficients of all b_k are positive, so is the determinant at every
// point and every s in [0, 1]. J_c is that of x throughout.
#pragma once
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/lanes.hpp"
#include "geometry/patch.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// The derivative by one reference coordinate.
struct TangentBasis {
    struct Difference {
        int from, to;   // of these coefficients of the position,
        double factor;  // times this
    };
    Bernstein form;
    std::vector<Difference> differences;  // of each coefficient

    TangentBasis(const CellType& cell, const Bernstein& position, int coordinate);
};

// The same for all elements of one type and degree; simplices: of degree > 1.
struct JacobianBasis {
    const CellType& cell;
    int dim, degree;
    PatchBasis position;
    std::vector<TangentBasis> tangent;              // by coordinate
    Bernstein normal, jacobian;                     // of the product of the first two tangents, and of all
    BezierProduct tangent_tangent, normal_tangent;  // the latter for n = 3 only
    std::vector<double> centre;                     // nodes x dim: dN_i/dxi_k at the centre
    double steepness = 0;                           // largest factor in a tangent

    JacobianBasis(int n, int p) : JacobianBasis(simplex(n), p) {}
    JacobianBasis(const CellType& cell, int p);
};

// A determinant of less than this may be zero, for all that rounding tells.
template <int n, class T>
T straight_rounding(const Mat<n, T>& J) {
    const T squared = frobenius_squared<n>(J);
    return (16 * std::numeric_limits<double>::epsilon()) * (n == 2 ? squared : squared * sqrt(squared));
}

// Scaled determinant of a straight-sided simplex: 1, -1, or 0 where the determinant may be zero or is not finite.
template <int n>
double straight_scaled_determinant(const int* vertex, const std::vector<double>& x) {
    const Mat<n> J = straight_jacobian<n>(vertex, x);
    const double det = determinant(J);
    if (!(std::abs(det) > straight_rounding<n>(J)) || !std::isfinite(det)) return 0;
    return det > 0 ? 1 : -1;
}

// The position of node i in each lane. node: the nodes of each lane's element.
template <int n>
Vec<n, Lanes> gathered(const int* const* node, int i, const std::vector<double>& x) {
    Vec<n, Lanes> position;
    for (int l = 0; l < lanes; ++l)
        for (int a = 0; a < n; ++a) position[a][l] = x[offset(node[l][i], n, a)];
    return position;
}

// The Jacobians of the straight-sided simplices of the first vertices.
template <int n>
Mat<n, Lanes> straight_jacobian(const int* const* node, const std::vector<double>& x) {
    const Vec<n, Lanes> origin = gathered<n>(node, 0, x);
    Mat<n, Lanes> J;
    for (int k = 0; k < n; ++k) {
        const Vec<n, Lanes> vertex = gathered<n>(node, k + 1, x);
        for (int a = 0; a < n; ++a) J[a][k] = vertex[a] - origin[a];
    }
    return J;
}

// T: double, or Lanes for as many elements at once. Objects of one T share their work space within a thread: one at a
// time.
template <int n, class T>
class ElementJacobian {
public:
    explicit ElementJacobian(const JacobianBasis& basis) : of_(basis) {
        int vectors = 2 * m_ + basis.position.bernstein.count + (n == 3 ? 3 * normals_ : 0);
        for (const TangentBasis& t : basis.tangent) vectors += 2 * t.form.count;
        T* next = workspace(vectors * n + (n + 1) * count_);
        const auto take = [&next](int size) { return std::exchange(next, next + size); };
        for (Vec<n, T>*& x : x_) x = reinterpret_cast<Vec<n, T>*>(take(m_ * n));
        bezier_ = reinterpret_cast<Vec<n, T>*>(take(basis.position.bernstein.count * n));
        for (auto& of_end : tangent_)
            for (int k = 0; k < n; ++k) of_end[k] = reinterpret_cast<Vec<n, T>*>(take(basis.tangent[k].form.count * n));
        if (n == 3)
            for (Vec<n, T>*& normal : normal_) normal = reinterpret_cast<Vec<n, T>*>(take(normals_ * n));
        for (T*& b : b_) b = take(count_);
    }

    // The positions x (end 0) and x' (end 1) of the nodes, to be set before compute(), which overwrites them.
    Vec<n, T>* position(int end) { return x_[end]; }

    // ends = 1: b_0 alone; 2: all.
    void compute(int ends) {
        set_frame();
        tangent_size_ = {};
        y_size_ = {};
        for (int end = 0; end < ends; ++end) {
            if (of_.cell.is_simplex()) to_frame(x_[end]);
            else to_frame_precisely(x_[end]);
            set_tangents(end);
        }
        multiply_tangents(ends);
        for (int k = 0; k <= n * (ends - 1); ++k)
            for (int a = 0; a < count_; ++a) b_[k][a] *= sign_ / of_.jacobian.multinomial[a];
    }

    // Instead of compute(): how much J at the ends differs from J_c with columns as they are. J_c^{-1} J = S + R in
    // Bezier form, S = I, in a pyramid the shear with the columns e_0, e_1, (1/2 - a, 1/2 - b, 1). d^2 is the sum over
    // the columns of R of the largest squared coefficient, times |S^{-1}|^2 <= 2. All coefficients() are at least
    // (1 - d)^n, as determinants of such columns are. 1 where it may be rounding errors. Overwrites the positions.
    T deviation(int ends) {
        const Mat<n, T> Jc = centre_jacobian();
        inverse_ = inverse<n>(Jc);
        Vec<n, T> squared{};
        const bool is_collapsed = of_.cell.is_collapsed;
        for (int end = 0; end < ends; ++end) {
            to_frame(x_[end]);
            set_tangents(end);
            for (int k = 0; k < n; ++k)
                for (int t = 0; t < of_.tangent[k].form.count; ++t) {
                    const Bernstein& form = of_.tangent[k].form;
                    T sum{};
                    for (int a = 0; a < n; ++a) {
                        double S = a == k ? 1 : 0;
                        if (is_collapsed && k == 2 && a < 2) S = 0.5 - 1.0 * form.index[t][2 * a + 1] / of_.degree;
                        const T R = tangent_[end][k][t][a] / form.multinomial[t] - S;
                        sum += R * R;
                    }
                    squared[k] = larger(squared[k], sum);
                }
        }
        const T d = std::sqrt(is_collapsed ? 2.0 : 1.0) * sqrt(std::accumulate(squared.begin(), squared.end(), T{}));
        return select(magnitude(determinant(Jc)) > 0x1p14 * straight_rounding<n>(Jc), d, T{} + 1);
    }

    // of_.jacobian.count coefficients of b_k, in units of |det J_c|.
    const T* coefficients(int k) const { return b_[k]; }

    // First-order effect on the coefficients of errors of a few units in the last place of y. Thin bent elements are
    // large in one coordinate of the frame only: so, except for simplices, each coordinate a has its own error e_a, and
    // the error of a product of tangents is bounded by those of its factors, whatever their signs.
    T rounding() const {
        constexpr double epsilon = std::numeric_limits<double>::epsilon(), factorial = n == 2 ? 2 : 6;
        const double of_one = 16 * epsilon * n * of_.steepness * of_.position.amplification;
        if (of_.cell.is_simplex()) {
            T largest = T{} + 1;
            for (const auto& of_tangents : tangent_size_)
                for (const T& size : of_tangents) largest = larger(largest, size);
            const T of_entry = of_one * inverse_norm_ * farthest_;
            return factorial * n * of_entry * (n == 2 ? largest : largest * largest);
        }
        T sum{};
        for (int k = 0; k < n; ++k) {
            Mat<n, T> sizes = tangent_size_;
            for (int a = 0; a < n; ++a) sizes[a][k] = of_one * y_size_[a];
            sum += permanent(sizes);
        }
        return sum;
    }

    // |det J_c|, and whether it exceeds its rounding error, without which all bounds are meaningless. Per lane.
    T unit() const { return magnitude(det_); }
    auto has_frame() const { return magnitude(det_) > smallest_det_; }

private:
    const JacobianBasis& of_;
    const int m_ = of_.position.nodes, count_ = of_.jacobian.count, normals_ = of_.normal.count;
    Vec<n, T>* x_[2];
    Vec<n, T>* bezier_;         // coefficients of the position, of the end at work
    Vec<n, T>* tangent_[2][n];  // derivatives by xi_k of x and x', times their multinomials
    Vec<n, T>* normal_[3];      // n = 3: products of two, by their number of factors from x'
    T* b_[n + 1];
    Mat<n, T> inverse_;
    T det_, smallest_det_, sign_;
    T inverse_norm_, farthest_;  // of simplices: its largest entry, and the largest coordinate of a node from the first
    Vec<n, T> lost_;             // of others: what y loses by rounding, over x and in units of the last place
    Vec<n, T> y_size_;           // the largest of each coordinate, with what it loses
    Mat<n, T> tangent_size_;     // [a][k]: largest coefficient of coordinate a of the derivative by xi_k

    static T larger(T a, T b) { return select(a < b, b, a); }
    static T magnitude(T v) { return select(v < 0, -v, v); }
    static T permanent(const Mat<n, T>& m) {
        if constexpr (n == 2) return m[0][0] * m[1][1] + m[0][1] * m[1][0];
        else return m[0][0] * (m[1][1] * m[2][2] + m[1][2] * m[2][1]) +
                    m[0][1] * (m[1][0] * m[2][2] + m[1][2] * m[2][0]) +
                    m[0][2] * (m[1][0] * m[2][1] + m[1][1] * m[2][0]);
    }

    static T* workspace(std::size_t size) {
        thread_local std::vector<T> values;
        if (values.size() < size) values.resize(size);
        return values.data();
    }

    Mat<n, T> centre_jacobian() const {
        Mat<n, T> Jc{};
        const Vec<n, T>* const x = x_[0];
        for (int i = 1; i < m_; ++i)
            for (int k = 0; k < n; ++k)
                for (int a = 0; a < n; ++a) Jc[a][k] += of_.centre[i * n + k] * (x[i][a] - x[0][a]);
        return Jc;
    }

    void set_frame() {
        Mat<n, T> Jc = centre_jacobian();
        const Vec<n, T>* const x = x_[0];
        if (of_.cell.is_simplex()) {
            Mat<n, T> Js;
            for (int k = 0; k < n; ++k)
                for (int a = 0; a < n; ++a) Js[a][k] = x[k + 1][a] - x[0][a];
            const auto straight = magnitude(determinant(Js)) > 0.1 * magnitude(determinant(Jc));
            for (int k = 0; k < n; ++k)
                for (int a = 0; a < n; ++a) Jc[a][k] = select(straight, Js[a][k], Jc[a][k]);
        } else {
            make_upright(Jc);
        }
        det_ = determinant(Jc);
        smallest_det_ = straight_rounding<n>(Jc);
        const Mat<n, T> C = cofactor(Jc);
        inverse_norm_ = farthest_ = T{};
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                inverse_[a][b] = C[b][a] / det_;
                inverse_norm_ = larger(inverse_norm_, magnitude(inverse_[a][b]));
            }
        if (!of_.cell.is_simplex()) cut_inverse();
        sign_ = select(det_ < 0, T{} - 1, T{} + 1);
    }

    // The columns by decreasing length, each perpendicular to those before: what is far away along a thin element, bent
    // or sheared, is so in one coordinate then. The determinant stays, but for its sign.
    static void make_upright(Mat<n, T>& J) {
        const auto product = [&J](int k, int l) {
            T sum{};
            for (int a = 0; a < n; ++a) sum += J[a][k] * J[a][l];
            return sum;
        };
        for (int end = n - 1; end > 0; --end)
            for (int k = 0; k < end; ++k) {
                const auto exchanged = product(k, k) < product(k + 1, k + 1);
                for (int a = 0; a < n; ++a) {
                    const T first = J[a][k];
                    J[a][k] = select(exchanged, J[a][k + 1], first);
                    J[a][k + 1] = select(exchanged, first, J[a][k + 1]);
                }
            }
        for (int k = 1; k < n; ++k)
            for (int l = 0; l < k; ++l) {
                const T share = product(k, l) / product(l, l);
                for (int a = 0; a < n; ++a) J[a][k] -= share * J[a][l];
            }
    }

    // To 25 digits of the largest of each row, where that changes little: any matrix near the inverse will do.
    void cut_inverse() {
        Mat<n, T> rough;
        lost_ = {};
        for (int a = 0; a < n; ++a) {
            for (int b = 0; b < n; ++b) lost_[a] = larger(lost_[a], magnitude(inverse_[a][b]));
            for (int b = 0; b < n; ++b) rough[a][b] = leading_digits(inverse_[a][b], lost_[a]);
        }
        const T change = magnitude(determinant(rough) * det_ - 1);
        for (int a = 0; a < n; ++a) {
            lost_[a] = select(change < 0.5, 0x1p-24 * lost_[a], lost_[a]);
            for (int b = 0; b < n; ++b) inverse_[a][b] = select(change < 0.5, rough[a][b], inverse_[a][b]);
        }
        det_ = 1 / determinant(inverse_);
    }

    // As a multiple of about largest / 2^25.
    static T leading_digits(T value, T largest) {
        const T shift = 0x1.8p28 * largest;
        return (value + shift) - shift;
    }

    // y = J_c^{-1} (x - x_0) in place of x.
    void to_frame(Vec<n, T>* y) {
        const Vec<n, T> origin = y[0];
        for (int i = 0; i < m_; ++i) {
            Vec<n, T> d;
            for (int a = 0; a < n; ++a) {
                d[a] = y[i][a] - origin[a];
                farthest_ = larger(farthest_, magnitude(d[a]));
            }
            for (int a = 0; a < n; ++a) {
                y[i][a] = T{};
                for (int b = 0; b < n; ++b) y[i][a] += inverse_[a][b] * d[b];
            }
        }
    }

    // The same with twice the digits: else a thin element loses those of its aspect ratio, times the amplification of
    // its degree, which is the product of those of the factors. x - x_0 = high + low, and products of high with the
    // entries of the inverse, both of 25 digits, are added up exactly (T. J. Dekker, Numer. Math. 18, 1971).
    void to_frame_precisely(Vec<n, T>* y) {
        const Vec<n, T> origin = y[0];
        T farthest{};
        for (int i = 0; i < m_; ++i)
            for (int a = 0; a < n; ++a) farthest = larger(farthest, magnitude(y[i][a] - origin[a]));
        for (int i = 0; i < m_; ++i) {
            Vec<n, T> high, low;
            for (int a = 0; a < n; ++a) {
                const T d = y[i][a] - origin[a], back = d - y[i][a];
                high[a] = leading_digits(d, farthest);
                low[a] = (d - high[a]) + ((y[i][a] - (d - back)) - (origin[a] + back));
            }
            for (int a = 0; a < n; ++a) {
                T of_high{}, of_low{};
                for (int b = 0; b < n; ++b) {
                    of_high += inverse_[a][b] * high[b];
                    of_low += inverse_[a][b] * low[b];
                }
                y[i][a] = of_high + of_low;
                y_size_[a] = larger(y_size_[a], magnitude(y[i][a]) + lost_[a] * farthest);
            }
        }
    }

    // Of positions in the frame.
    void set_tangents(int end) {
        const Vec<n, T>* const y = x_[end];
        for (int b = 0; b < of_.position.bernstein.count; ++b)
            bezier_[b] = of_.position.node(b) >= 0 ? y[of_.position.node(b)]
                                                   : of_.position.template point<Vec<n, T>>(b, [y](int i) {
                                                         return y[i];
                                                     });
        for (int k = 0; k < n; ++k)
            for (int t = 0; t < of_.tangent[k].form.count; ++t) {
                const TangentBasis::Difference& of = of_.tangent[k].differences[t];
                for (int a = 0; a < n; ++a) {
                    const T derivative = of.factor * (bezier_[of.to][a] - bezier_[of.from][a]);
                    tangent_size_[a][k] = larger(tangent_size_[a][k], magnitude(derivative));
                    tangent_[end][k][t][a] = of_.tangent[k].form.multinomial[t] * derivative;
                }
            }
    }

    // to += factor * a b, all with their multinomials.
    template <class A, class Product, class Times>
    void add_product(const BezierProduct& table, const A* a, const A* b, double factor, const Times& times,
                     Product* to) const {
        const int* place = table.place.data();
        for (std::size_t i = 0; i < table.left.size(); ++i)
            for (std::size_t j = 0; j < table.right.size(); ++j) times(a[i], b[j], factor, to[*place++]);
    }

    // The first two tangents.
    void add_cross(const Vec<n, T>* a, const Vec<n, T>* b, double factor, T* to) const requires(n == 2) {
        add_product(
            of_.tangent_tangent, a, b, factor,
            [](const auto& u, const auto& v, double f, T& sum) { sum += f * (u[0] * v[1] - u[1] * v[0]); }, to);
    }
    void add_cross(const Vec<n, T>* a, const Vec<n, T>* b, Vec<n, T>* to) const requires(n == 3) {
        add_product(
            of_.tangent_tangent, a, b, 1,
            [](const auto& u, const auto& v, double, Vec<n, T>& sum) {
                const Vec<n, T> product = cross(u, v);
                for (int c = 0; c < n; ++c) sum[c] += product[c];
            },
            to);
    }
    void add_dot(const Vec<n, T>* normal, const Vec<n, T>* t, double factor, T* to) const requires(n == 3) {
        add_product(
            of_.normal_tangent, normal, t, factor,
            [](const auto& u, const auto& v, double f, T& sum) { sum += f * dot(u, v); }, to);
    }

    // In all ways, each tangent from one of the ends: b_k is the mean of those with k from x'.
    void multiply_tangents(int ends) {
        for (int k = 0; k <= n * (ends - 1); ++k) std::fill_n(b_[k], count_, T{});
        if constexpr (n == 2) {
            for (int i = 0; i < ends; ++i)
                for (int j = 0; j < ends; ++j)
                    add_cross(tangent_[i][0], tangent_[j][1], i == j ? 1 : 0.5, b_[i + j]);
        } else {
            const int normals = 2 * ends - 1;
            for (int k = 0; k < normals; ++k) std::fill_n(normal_[k], normals_, Vec<n, T>{});
            for (int i = 0; i < ends; ++i)
                for (int j = 0; j < ends; ++j) add_cross(tangent_[i][0], tangent_[j][1], normal_[i + j]);
            for (int j = 0; j < ends; ++j)
                for (int k = 0; k < normals; ++k)
                    add_dot(normal_[k], tangent_[j][2], (j + k) % 3 == 0 ? 1 : 1.0 / 3, b_[j + k]);
        }
    }
};

}  // namespace almesh
