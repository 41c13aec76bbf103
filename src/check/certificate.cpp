// With J_s = (x_1 - x_0, ..., x_n - x_0) of the element's vertices and y = J_s^{-1} (x - x_0),
//
//     det J / det J_s = (dy/dxi_0 x dy/dxi_1) . dy/dxi_2     (n = 2: e_z in place of dy/dxi_2)
//
// is a product of polynomials in Bezier form (patch.hpp), bounded by polynomial_minimum()
// (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013).
#include "check/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double element_work = 500;  // simple operations for one element, at least

// Of the scaled Jacobian: lower <= minimum <= upper. upper <= 0 proves the element invalid.
struct Bounds {
    double lower, upper;
};

// The same for all elements of one dimension and degree.
struct JacobianTables {
    PatchBasis basis;
    PatchNormal normal;
    Bernstein jacobian;  // of degree n (p - 1)
    BezierProduct normal_tangent;
    double amplification = 0;  // infinity norm of basis.to_bezier

    JacobianTables(int n, int degree)
        : basis(n, degree), normal(n, degree), jacobian(n, n * (degree - 1)),
          normal_tangent(normal.basis, Bernstein(n, n == 3 ? degree - 1 : 0), jacobian) {
        const int nodes = basis.bernstein.count;
        for (int a = 0; a < nodes; ++a) {
            double sum = 0;
            for (int i = 0; i < nodes; ++i) sum += std::abs(basis.to_bezier[offset(a, nodes, i)]);
            amplification = std::max(amplification, sum);
        }
    }
};

double largest_entry(const Vec<3>& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

Bounds bound_element(const Mesh& mesh, const std::vector<double>& x, int e, const JacobianTables& tables,
                     const CertificateParams& params) {
    const int n = mesh.dim;
    const int* const node = mesh.element(e);
    Mat<3> Js = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // in 2D with e_z as third column
    double squared = 0;                               // |J_s|^2
    for (int k = 0; k < n; ++k)
        for (int a = 0; a < n; ++a) {
            Js[a][k] = point(x, node[k + 1], n)[a] - point(x, node[0], n)[a];
            squared += Js[a][k] * Js[a][k];
        }
    const double det = determinant(Js), rounding = 16 * epsilon * std::pow(squared, 0.5 * n);
    if (!(std::abs(det) > rounding) || !std::isfinite(det)) return {0, 0};
    const double sign = det > 0 ? 1 : -1;
    if (mesh.degree == 1) return {sign, sign};

    // y = J_s^{-1} (x - x_0) of the nodes, J_s^{-1} = C^T / det J_s; the vertices without rounding.
    std::vector<Vec<3>> y = positions(mesh, x, node, mesh.element_nodes());
    const Vec<3> x0 = y[0];
    const Mat<3> C = cofactor(Js);
    double inverse_norm = 0, farthest = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) inverse_norm = std::max(inverse_norm, std::abs(C[a][b] / det));
    for (Vec<3>& position : y) {
        const Vec<3> d = position - x0;
        farthest = std::max(farthest, largest_entry(d));
        for (int a = 0; a < 3; ++a) position[a] = C[0][a] * d[0] / det + C[1][a] * d[1] / det + C[2][a] * d[2] / det;
    }
    for (int k = 0; k < n; ++k) {
        y[k + 1] = {};
        y[k + 1][k] = 1;
    }
    const Patch patch = make_patch(tables.basis, y);

    const std::vector<Vec<3>> tangent[3] = {tables.normal.tangent(patch, 0), tables.normal.tangent(patch, 1),
                                            tables.normal.tangent(patch, 2)};
    std::vector<double> jacobian = tables.normal_tangent.multiply(
        tables.normal.tangent_tangent.multiply(tangent[0], tangent[1], cross<double>), tangent[2], dot<double>);
    for (double& coefficient : jacobian) {
        coefficient *= sign;
        if (!std::isfinite(coefficient)) return {0, 0};
    }
    const PolynomialMinimum minimum =
        polynomial_minimum(tables.jacobian, jacobian.data(), params.tolerance, params.max_bisections);

    // First-order effect of errors of a few units in the last place of y on a sum of n! products of n entries.
    const double entry_error = 8 * epsilon * n * inverse_norm * farthest * tables.amplification * 2 * mesh.degree;
    double largest = 1;  // of the derivatives
    for (const std::vector<Vec<3>>& coefficients : tangent)
        for (const Vec<3>& t : coefficients) largest = std::max(largest, largest_entry(t));
    const double margin = mesh.cell().inverse_volume * n * entry_error * std::pow(largest, n - 1);
    return {minimum.lower - margin, minimum.upper};
}

}  // namespace

Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    const JacobianTables tables(mesh.dim, mesh.degree);
    std::vector<Bounds> bounds(mesh.element_count());
    parallel_for(mesh.element_count(), [&](int e) { bounds[e] = bound_element(mesh, x, e, tables, params); },
                 element_work);
    Certificate certificate{1, true, 0, {}, {}};
    std::vector<double>& lower = certificate.lower_bound;
    std::vector<int>& uncertified = certificate.uncertified;
    for (int e = 0; e < mesh.element_count(); ++e) {
        lower.push_back(bounds[e].lower);
        if (bounds[e].lower > 0) continue;
        uncertified.push_back(e);
        certificate.undecided += bounds[e].upper > 0;
    }
    if (!lower.empty()) certificate.min_scaled_jacobian = *std::min_element(lower.begin(), lower.end());
    certificate.valid = uncertified.empty();
    std::stable_sort(uncertified.begin(), uncertified.end(), [&](int a, int b) { return lower[a] < lower[b]; });
    return certificate;
}

}  // namespace almesh
