// The determinant of the map of a curved element as a polynomial in Bezier form, alone or while its nodes move along
// straight lines from one position to another.
//
// The nodes are first taken to reference coordinates, relative to vertex 0: there a boundary-layer element of aspect
// ratio 50000 is of size one like any other. This is done by the inverse of J_c: the Jacobian of the straight-sided
// simplex of the vertices, or the derivative of the map at the centroid where the former is much smaller, as in a valid
// element bent so far that its vertices lie nearly on a line. With y = J_c^{-1} (x - x_0)
//
//     det J / det J_c = (dy/dxi_0 x dy/dxi_1) . dy/dxi_2     (n = 2: dy/dxi_0 x dy/dxi_1)
//
// is a product of polynomials, of degree n (p - 1). Interpolating det J at the nodes of that degree instead would
// multiply rounding errors by the condition number of that interpolation, which grows exponentially with the degree.
//
// Along (1 - s) x + s x' the determinant is a polynomial of degree n in s as well. Its Bernstein coefficients b_0, ...,
// b_n in s, each a polynomial in the reference coordinates, are those products with the derivatives taken from x or x'
// in all ways, k of them from x' in b_k. Where all coefficients of all b_k are positive, so is the determinant at every
// point and every s in [0, 1]. J_c is that of x throughout.
#pragma once
#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "base/small_matrix.hpp"
#include "geometry/patch.hpp"

namespace almesh {

// The same for all elements of one dimension and degree > 1.
struct JacobianBasis {
    int dim, degree;
    PatchBasis position;
    Bernstein tangent, jacobian;                    // of degree p - 1 and n (p - 1)
    std::vector<int> raised;                        // raised_places(n, p - 1)
    BezierProduct tangent_tangent, normal_tangent;  // normal_tangent: n = 3 only
    std::vector<double> centre;                     // nodes x dim: dN_i/dxi_k at the centroid
    double amplification = 0;                       // infinity norm of position.to_bezier

    JacobianBasis(int n, int p)
        : dim(n),
          degree(p),
          position(n, p),
          tangent(n, p - 1),
          jacobian(n, n * (p - 1)),
          raised(raised_places(n, p - 1)),
          tangent_tangent(tangent, tangent, Bernstein(n, 2 * (p - 1))),
          normal_tangent(Bernstein(n, n == 3 ? 2 * (p - 1) : 0), Bernstein(n, n == 3 ? p - 1 : 0),
                         Bernstein(n, n == 3 ? 3 * (p - 1) : 0)) {
        const int nodes = position.bernstein.count;
        const double centroid[3] = {1.0 / (n + 1), 1.0 / (n + 1), 1.0 / (n + 1)};
        centre.resize(offset(nodes, n));
        LagrangeBasis(n, p).gradients(centroid, centre.data());
        for (int a = 0; a < nodes; ++a) {
            double sum = 0;
            for (int i = 0; i < nodes; ++i) sum += std::abs(position.to_bezier[offset(a, nodes, i)]);
            amplification = std::max(amplification, sum);
        }
    }
};

// A determinant of less than this may be zero, for all that rounding tells.
template <int n, class T>
T straight_rounding(const Mat<n, T>& J) {
    const T squared = frobenius_squared<n>(J);
    return (16 * std::numeric_limits<double>::epsilon()) * (n == 2 ? squared : squared * sqrt(squared));
}

// Scaled Jacobian of a straight-sided element: 1, -1, or 0 where the determinant may be zero or is not finite.
template <int n>
double straight_scaled_jacobian(const int* vertex, const std::vector<double>& x) {
    const Mat<n> J = straight_jacobian<n>(vertex, x);
    const double det = determinant(J);
    if (!(std::abs(det) > straight_rounding<n>(J)) || !std::isfinite(det)) return 0;
    return det > 0 ? 1 : -1;
}

// T: double, or Lanes for as many elements at once. Objects of one T share their work space within a thread: one at a
// time.
template <int n, class T>
class ElementJacobian {
public:
    explicit ElementJacobian(const JacobianBasis& basis)
        : of_(basis),
          m_(basis.position.bernstein.count),
          tangents_(basis.tangent.count),
          count_(basis.jacobian.count),
          normals_(static_cast<int>(basis.tangent_tangent.result.size())) {
        const int vectors = 2 * m_ + m_ + 2 * n * tangents_ + (n == 3 ? 3 * normals_ : 0);
        T* next = workspace(vectors * n + (n + 1) * count_);
        const auto take = [&next](int size) { return std::exchange(next, next + size); };
        for (Vec<n, T>*& x : x_) x = reinterpret_cast<Vec<n, T>*>(take(m_ * n));
        bezier_ = reinterpret_cast<Vec<n, T>*>(take(m_ * n));
        for (auto& of_end : tangent_)
            for (Vec<n, T>*& t : of_end) t = reinterpret_cast<Vec<n, T>*>(take(tangents_ * n));
        if (n == 3)
            for (Vec<n, T>*& normal : normal_) normal = reinterpret_cast<Vec<n, T>*>(take(normals_ * n));
        for (T*& b : b_) b = take(count_);
    }

    // The m positions x (end 0) and x' (end 1), to be set before compute(), which overwrites them.
    Vec<n, T>* position(int end) { return x_[end]; }

    // ends = 1: b_0 alone; 2: all.
    void compute(int ends) {
        set_frame();
        largest_ = T{} + 1;
        for (int end = 0; end < ends; ++end) set_tangents(end);
        if (ends == 1) product_at_rest();
        else products_along();
        for (int k = 0; k < (ends == 1 ? 1 : n + 1); ++k)
            for (int a = 0; a < count_; ++a) b_[k][a] *= sign_ / of_.jacobian.multinomial[a];
    }

    // of_.jacobian.count coefficients of b_k, in units of |det J_c|.
    const T* coefficients(int k) const { return b_[k]; }

    // First-order effect on them of errors of a few units in the last place of y.
    T rounding() const {
        constexpr double epsilon = std::numeric_limits<double>::epsilon(), factorial = n == 2 ? 2 : 6;
        const T of_entry = (16 * epsilon * n * of_.degree * of_.amplification) * inverse_norm_ * farthest_;
        return factorial * n * of_entry * (n == 2 ? largest_ : largest_ * largest_);
    }

    // |det J_c|, and whether it is far enough from zero, to rounding, for the above to mean anything. Per lane.
    T unit() const { return magnitude(det_); }
    auto has_frame() const { return magnitude(det_) > smallest_det_; }

private:
    const JacobianBasis& of_;
    const int m_, tangents_, count_, normals_;
    Vec<n, T>* x_[2];
    Vec<n, T>* bezier_;         // m, of the end at work
    Vec<n, T>* tangent_[2][n];  // derivatives by xi_k of x and x', times their multinomials
    Vec<n, T>* normal_[3];      // n = 3: products of two, by their number of factors from x'
    T* b_[n + 1];
    Mat<n, T> inverse_;
    T det_, smallest_det_, sign_, inverse_norm_, farthest_, largest_;

    static T larger(T a, T b) { return select(a < b, b, a); }
    static T magnitude(T v) { return select(v < 0, -v, v); }

    static T* workspace(std::size_t size) {
        thread_local std::vector<T> values;
        if (values.size() < size) values.resize(size);
        return values.data();
    }

    void set_frame() {
        Mat<n, T> Jc{};
        const Vec<n, T>* const x = x_[0];
        for (int i = 1; i < m_; ++i)
            for (int k = 0; k < n; ++k)
                for (int a = 0; a < n; ++a) Jc[a][k] += of_.centre[i * n + k] * (x[i][a] - x[0][a]);
        Mat<n, T> Js;
        for (int k = 0; k < n; ++k)
            for (int a = 0; a < n; ++a) Js[a][k] = x[k + 1][a] - x[0][a];
        const auto straight = magnitude(determinant(Js)) > 0.1 * magnitude(determinant(Jc));
        for (int k = 0; k < n; ++k)
            for (int a = 0; a < n; ++a) Jc[a][k] = select(straight, Js[a][k], Jc[a][k]);
        det_ = determinant(Jc);
        smallest_det_ = straight_rounding<n>(Jc);
        sign_ = select(det_ < 0, T{} - 1, T{} + 1);
        const Mat<n, T> C = cofactor(Jc);
        inverse_norm_ = farthest_ = T{};
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                inverse_[a][b] = C[b][a] / det_;
                inverse_norm_ = larger(inverse_norm_, magnitude(inverse_[a][b]));
            }
    }

    void set_tangents(int end) {
        Vec<n, T>* const y = x_[end];
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
        const std::vector<double>& M = of_.position.to_bezier;
        for (int b = 0; b < m_; ++b) {
            if (b <= n) {
                bezier_[b] = y[b];
                continue;
            }
            bezier_[b] = {};
            for (int i = 0; i < m_; ++i)
                for (int a = 0; a < n; ++a) bezier_[b][a] += M[offset(b, m_, i)] * y[i][a];
        }
        for (int k = 0; k < n; ++k)
            for (int t = 0; t < tangents_; ++t) {
                const int* const of = &of_.raised[t * (n + 1)];
                for (int a = 0; a < n; ++a) {
                    const T derivative = of_.degree * (bezier_[of[k + 1]][a] - bezier_[of[0]][a]);
                    largest_ = larger(largest_, magnitude(derivative));
                    tangent_[end][k][t][a] = of_.tangent.multinomial[t] * derivative;
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

    void product_at_rest() {
        const auto& t = tangent_[0];
        std::fill_n(b_[0], count_, T{});
        if constexpr (n == 2) {
            add_cross(t[0], t[1], 1, b_[0]);
        } else {
            std::fill_n(normal_[0], normals_, Vec<n, T>{});
            add_cross(t[0], t[1], normal_[0]);
            add_dot(normal_[0], t[2], 1, b_[0]);
        }
    }

    void products_along() {
        const auto& from = tangent_[0];
        const auto& to = tangent_[1];
        for (T* b : b_) std::fill_n(b, count_, T{});
        if constexpr (n == 2) {
            add_cross(from[0], from[1], 1, b_[0]);
            add_cross(from[0], to[1], 0.5, b_[1]);
            add_cross(to[0], from[1], 0.5, b_[1]);
            add_cross(to[0], to[1], 1, b_[2]);
        } else {
            for (Vec<n, T>* normal : normal_) std::fill_n(normal, normals_, Vec<n, T>{});
            add_cross(from[0], from[1], normal_[0]);
            add_cross(from[0], to[1], normal_[1]);
            add_cross(to[0], from[1], normal_[1]);
            add_cross(to[0], to[1], normal_[2]);
            add_dot(normal_[0], from[2], 1, b_[0]);
            add_dot(normal_[1], from[2], 1.0 / 3, b_[1]);
            add_dot(normal_[0], to[2], 1.0 / 3, b_[1]);
            add_dot(normal_[2], from[2], 1.0 / 3, b_[2]);
            add_dot(normal_[1], to[2], 1.0 / 3, b_[2]);
            add_dot(normal_[2], to[2], 1, b_[3]);
        }
    }
};

}  // namespace almesh
