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
#include <vector>

#include "base/small_matrix.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

struct Bernstein {
    int dim, degree, count;
    std::vector<MultiIndex> index;    // count multi-indices in Gmsh's order: the corners come first
    std::vector<double> multinomial;  // count: d! / (a_0! ... a_m!)

    Bernstein(int dim, int degree);

    int find(const MultiIndex& a) const;  // place of a coefficient, or -1

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

// Products of polynomials in the scaled form c_a * multinomial_a, where they are convolutions: all terms have weight
// one, so that a product is as accurate as its factors at any degree.
struct BezierProduct {
    int left, right;         // counts of the factors
    std::vector<int> place;  // left x right: where each product of two terms goes

    BezierProduct(const Bernstein& a, const Bernstein& b, const Bernstein& product);

    // out += factor a b, all scaled.
    void add(double factor, const double* a, const double* b, double* out) const;
};

// lower <= min q <= upper; upper is a value of q. tight: the two agree to the tolerance asked for.
struct PolynomialMinimum {
    double lower, upper;
    bool tight;
};

// Best-first longest-edge bisection until upper - lower <= tolerance * upper (where upper <= 0: tolerance *
// max(1, |upper|); the polynomial is taken to be of order one), or after max_bisections. c: count, finite.
PolynomialMinimum polynomial_minimum(const Bernstein& basis, const double* c, double tolerance, int max_bisections);

}  // namespace almesh
