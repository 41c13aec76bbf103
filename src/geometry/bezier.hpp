// Polynomials in Bernstein-Bezier form, on a simplex
//
//     q(l) = sum_a c_a B_a(l),   B_a(l) = d! / (a_0! ... a_m!) l_0^a_0 ... l_m^a_m,   |a| = d,
//
// l the barycentric coordinates, and on a product of simplices the products of the B_a of its factors, each of a degree
// of its own. The B_a are positive and sum to one, so min c_a <= q <= max c_a, the corner coefficients are values of q,
// and bisection by de Casteljau's averages closes the gap between the two quadratically (Farin, Curves and Surfaces for
// CAGD, 2002, ch. 17; for the Jacobian of elements: Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013).
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/cells.hpp"

namespace almesh {

struct LagrangeBasis;

struct Bernstein {
    int dim, degree, count;               // degree: the highest of a factor
    std::array<int, 3> factors, degrees;  // dimensions of the simplices, 0: no more, and the degree in each
    std::vector<MultiIndex> index;        // count concatenated multi-indices: on a simplex in Gmsh's order
    std::vector<double> multinomial;      // count: d! / (a_0! ... a_m!), the product of those of the factors

    // Its coefficient, and for each factor the entry of its index that is not 0. Corners that are one are named once.
    struct Corner {
        int place;
        std::vector<int> entries;
    };
    std::vector<Corner> corners;

    Bernstein(int dim, int degree);
    Bernstein(const std::array<int, 3>& factors, const std::array<int, 3>& degrees);

    int place(const MultiIndex& a) const;  // of a coefficient
    int entries(int factor) const { return factor == 0 || factors[factor] > 0 ? factors[factor] + 1 : 0; }

    // Coefficients of the same polynomial on the two halves that the midpoint of the edge of the corners a < b cuts
    // the simplex into, or one factor: a and b are entries of its multi-index. The midpoint replaces corner b in near_a
    // and corner a in near_b. c, near_a, near_b: count coefficients, double or Vec<3>.
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
    // Of each factor: the place of a multi-index a in its own form, at
    // a_1 + (d + 1) a_2 + (d + 1)^2 a_3.
    std::array<std::vector<int>, 3> place_in_factor_;

    int key(int factor, const int* a) const;  // there
    int edge(int a, int b) const { return a * static_cast<int>(MultiIndex().size()) + b; }

    // [edge(a, b)]: the rows of coefficients that differ along it only, as places from corner a to corner b.
    std::vector<std::vector<std::vector<int>>> rows_;
};

// For each index a of degree `degree`, the places of a + e_0, .., a + e_dim among those of degree + 1: the coefficients
// that de Casteljau's step averages, and whose differences are the derivatives. simplex_node_count x (dim + 1).
std::vector<int> raised_places(int dim, int degree);

// The form of functions of degree p on a cell: of degree p in each factor, those of a pyramid (cells.hpp) on the cube.
Bernstein position_form(const CellType& cell, int degree);

// Matrix M, position_form().count x basis.count: the coefficients of the polynomial with nodal values v are c = M v.
// On a simplex each Lagrange function is a product of linear factors (p l_k - j (l_0 + ... + l_m)) / (j + 1) and is
// expanded in them without rounding (the numerators are integers below 2^53 for p <= 10); no system is solved. On a
// product of simplices it is the product of theirs. On a pyramid layer k of the coefficients, of degree m = p - k in a
// and in b, is raised to degree p: c_j = sum_i binomial(m, i) binomial(p - m, j - i) / binomial(p, j) c_i.
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

// The corners a < b of one of these simplices that are farthest apart. corner: those of one simplex after the other,
// dim + 1 points each or more, of any number of coordinates.
template <class Points>
std::array<int, 2> longest_edge(const Points& corner, const std::array<int, 3>& dims) {
    std::array<int, 2> longest = {0, 1};
    double best = 0;
    int first = 0;
    for (const int dim : dims) {
        for (int a = first; a <= first + dim; ++a)
            for (int b = a + 1; b <= first + dim; ++b) {
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
        first += dim + 1;
    }
    return longest;
}

// A point of a product of simplices: dim + 1 numbers for each, which add up to one; the rest 0.
using Barycentric = std::array<double, 6>;

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
