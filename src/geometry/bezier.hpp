// Polynomials on a simplex in Bernstein-Bezier form,
//
//     q(l) = sum_a c_a B_a(l),   B_a(l) = d! / (a_0! ... a_m!) l_0^a_0 ... l_m^a_m,   |a| = d,
//
// l the barycentric coordinates. The B_a are positive and sum to one, so min c_a <= q <= max c_a, the corner
// coefficients are values of q, and bisection by de Casteljau's averages closes the gap between the two quadratically
// (Farin, Curves and Surfaces for CAGD, 2002, ch. 17; for the Jacobian of elements: Johnen, Remacle, Geuzaine,
// J. Comput. Phys. 233, 2013).
#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

struct Bernstein {
    int dim, degree, count;
    std::vector<MultiIndex> index;    // count multi-indices in Gmsh's order: the corners come first
    std::vector<double> multinomial;  // count: d! / (a_0! ... a_m!)

    Bernstein(int dim, int degree);

    int place(const MultiIndex& a) const { return place_.at(a); }  // of a coefficient

    // Coefficients of the same polynomial on the two halves that the midpoint of the edge of the corners a < b cuts
    // the simplex into; the midpoint replaces corner b in near_a and corner a in near_b. c, near_a, near_b: count
    // coefficients, double or Vec<3>.
    template <class T>
    void bisect(int a, int b, const T* c, T* near_a, T* near_b) const {
        std::copy(c, c + count, near_a);
        std::copy(c, c + count, near_b);
        for (const std::vector<int>& row : rows_[edge(a, b)]) {
            // near_b holds the averages of the current step; their first one belongs to near_a.
            for (std::size_t step = 1; step < row.size(); ++step) {
                for (std::size_t s = 0; s < row.size() - step; ++s)
                    near_b[row[s]] = 0.5 * (near_b[row[s]] + near_b[row[s + 1]]);
                near_a[row[step]] = near_b[row[0]];
            }
        }
    }

private:
    std::map<MultiIndex, int> place_;

    int edge(int a, int b) const { return a * (dim + 1) + b; }

    // [edge(a, b)]: the rows of coefficients that differ along it only, as places from corner a to corner b.
    std::vector<std::vector<std::vector<int>>> rows_;
};

// For each index a of degree `degree`, the places of a + e_0, .., a + e_dim among those of degree + 1: the coefficients
// that de Casteljau's step averages, and whose differences are the derivatives. simplex_node_count x (dim + 1).
std::vector<int> raised_places(int dim, int degree);

// count x count matrix M: the coefficients of the polynomial with nodal values v are c = M v. Each Lagrange function
// is a product of linear factors (p l_k - j (l_0 + ... + l_m)) / (j + 1) and is expanded in them without rounding (the
// numerators are integers below 2^53 for p <= 10); no system is solved.
std::vector<double> bezier_of_lagrange(const LagrangeBasis& basis);

// Products of polynomials. In the scaled form c_a * multinomial_a they are convolutions: all terms have weight one, so
// that a product is as accurate as its factors at any degree.
struct BezierProduct {
    std::vector<double> left, right, result;  // multinomials of the factors and of the product
    std::vector<int> place;                   // left x right: where each product of two terms goes

    BezierProduct(const Bernstein& a, const Bernstein& b, const Bernstein& product);

    // Bezier coefficients of the product from those of the factors. times(a_i, b_j) multiplies numbers, or is the dot
    // or cross product of vectors.
    template <class A, class B, class Times>
    auto multiply(const std::vector<A>& a, std::vector<B> b, const Times& times) const {
        for (std::size_t j = 0; j < b.size(); ++j) b[j] = right[j] * b[j];
        std::vector<decltype(times(a[0], b[0]))> product(result.size());
        auto to = place.begin();
        for (std::size_t i = 0; i < a.size(); ++i) {
            const A a_i = left[i] * a[i];
            for (const B& b_j : b) {
                product[*to] = product[*to] + times(a_i, b_j);
                ++to;
            }
        }
        for (std::size_t k = 0; k < product.size(); ++k) product[k] = 1 / result[k] * product[k];
        return product;
    }
};

// The corners a < b of a simplex that are farthest apart. corner: dim + 1 points or more, of any number of coordinates.
template <class Points>
std::array<int, 2> longest_edge(const Points& corner, int dim) {
    std::array<int, 2> longest = {0, 1};
    double best = 0;
    for (int a = 0; a <= dim; ++a)
        for (int b = a + 1; b <= dim; ++b) {
            double squared = 0;
            for (std::size_t k = 0; k < corner[a].size(); ++k) {
                const double d = corner[a][k] - corner[b][k];
                squared += d * d;
            }
            if (squared > best) {
                best = squared;
                longest = {a, b};
            }
        }
    return longest;
}

// A point of a simplex: dim + 1 numbers that add up to one, the rest 0.
using Barycentric = std::array<double, 4>;

// lower <= min q <= upper = q(at). tight: the two agree to the tolerance asked for.
struct PolynomialMinimum {
    double lower, upper;
    bool tight;
    Barycentric at;
};

// Best-first longest-edge bisection until upper - lower <= tolerance * upper (where upper <= 0: tolerance *
// max(1, |upper|); the polynomial is taken to be of order one), or after max_bisections. c: count, finite.
PolynomialMinimum polynomial_minimum(const Bernstein& basis, const double* c, double tolerance, int max_bisections);

// The same until it is known whether q > bound everywhere: lower > bound, or upper <= bound; or after max_bisections.
PolynomialMinimum compare_with(const Bernstein& basis, const double* c, double bound, int max_bisections);

}  // namespace almesh
