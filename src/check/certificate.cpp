// With J_s = (x_1 - x_0, ..., x_n - x_0) of the element's vertices and y = J_s^{-1} (x - x_0),
//
//     det J / det J_s = det dy/dxi,   dy_i/dxi_j = p sum_a (b_{a + e_j} - b_{a + e_0}) B_a,   |a| = p - 1,
//
// expanded by its first row into products of polynomials in Bezier form and bounded by polynomial_minimum()
// (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013).
#include "check/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "geometry/bezier.hpp"

namespace almesh {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int block_elements = 64;    // elements that share one workspace
constexpr double element_work = 500;  // simple operations for one element, at least

enum class Validity { valid, invalid, undecided };

struct Bound {
    double lower;
    Validity validity;
};

// The same for all elements of one dimension and degree.
struct JacobianTables {
    int nodes;
    Bernstein gradient, minor, jacobian;  // degrees p - 1, 2 (p - 1), n (p - 1)
    BezierProduct gradient_gradient, minor_gradient;
    std::vector<int> shifted;       // gradient.count x (n + 1): place of a + e_k among the degree-p coefficients
    std::vector<double> to_bezier;  // nodes x nodes
    double amplification;           // infinity norm of to_bezier

    JacobianTables(int dim, int degree)
        : gradient(dim, degree - 1), minor(dim, 2 * (degree - 1)), jacobian(dim, dim * (degree - 1)),
          gradient_gradient(gradient, gradient, minor), minor_gradient(minor, gradient, jacobian),
          shifted(raised_places(dim, degree - 1)) {
        const LagrangeBasis basis(dim, degree);
        nodes = basis.count;
        to_bezier = bezier_of_lagrange(basis);
        amplification = 0;
        for (int a = 0; a < nodes; ++a) {
            double sum = 0;
            for (int i = 0; i < nodes; ++i) sum += std::abs(to_bezier[offset(a, nodes, i)]);
            amplification = std::max(amplification, sum);
        }
    }
};

struct Workspace {
    std::vector<double> y, control;    // nodes x n: the element in reference coordinates, nodal and Bezier
    std::vector<double> J;             // n x n x gradient.count, scaled coefficients of dy_i/dxi_j
    std::vector<double> minor, value;  // scaled minor; coefficients of the scaled Jacobian
    double largest_term;               // upper bound of the terms whose sums are the entries of y
};

// Sets work.y. Returns the sign of det J_s, 0 where it is of the order of rounding or not finite.
template <int n>
int to_reference(const Mesh& mesh, const std::vector<double>& x, int e, int nodes, Workspace& work) {
    const int* const node = mesh.element(e);
    const auto from_vertex_0 = [&](int i) {
        Vec<n> d;
        for (int a = 0; a < n; ++a) d[a] = point(x, node[i], n)[a] - point(x, node[0], n)[a];
        return d;
    };
    Mat<n> Js;
    for (int k = 0; k < n; ++k) {
        const Vec<n> edge = from_vertex_0(k + 1);
        for (int a = 0; a < n; ++a) Js[a][k] = edge[a];
    }
    const double det = determinant(Js);
    const Mat<n> C = cofactor(Js);
    const double rounding = 16 * epsilon * std::pow(frobenius_squared<n>(Js), 0.5 * n);
    if (!(std::abs(det) > rounding) || !std::isfinite(det)) return 0;

    work.y.assign(offset(nodes, n), 0.0);
    double inverse_norm = 0, farthest = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) inverse_norm = std::max(inverse_norm, std::abs(C[a][b] / det));
    for (int i = 0; i < nodes; ++i) {
        const Vec<n> d = from_vertex_0(i);
        for (int a = 0; a < n; ++a) {
            farthest = std::max(farthest, std::abs(d[a]));
            for (int b = 0; b < n; ++b) work.y[i * n + a] += C[b][a] * d[b] / det;
        }
    }
    for (int k = 0; k <= n; ++k)  // the vertices without rounding
        for (int a = 0; a < n; ++a) work.y[k * n + a] = k == a + 1;
    work.largest_term = n * inverse_norm * farthest;
    return det > 0 ? 1 : -1;
}

// Sets work.J; returns the largest coefficient of dy/dxi.
template <int n>
double differentiate(const JacobianTables& tables, int degree, Workspace& work) {
    work.control.assign(work.y.size(), 0.0);
    for (int a = 0; a < tables.nodes; ++a)
        for (int i = 0; i < tables.nodes; ++i) {
            const double m = tables.to_bezier[offset(a, tables.nodes, i)];
            for (int c = 0; c < n; ++c) work.control[a * n + c] += m * work.y[i * n + c];
        }
    const int count = tables.gradient.count;
    double largest = 0;
    for (int a = 0; a < count; ++a) {
        const int* const shifted = &tables.shifted[offset(a, n + 1)];
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double v = degree * (work.control[shifted[j + 1] * n + i] - work.control[shifted[0] * n + i]);
                largest = std::max(largest, std::abs(v));
                work.J[(i * n + j) * count + a] = v * tables.gradient.multinomial[a];
            }
    }
    return largest;
}

// sign * det of the polynomials work.J, by its first row.
template <int n>
void expand_determinant(const JacobianTables& tables, double sign, Workspace& work) {
    const auto J = [&](int i, int j) { return &work.J[(i * n + j) * tables.gradient.count]; };
    std::fill(work.value.begin(), work.value.end(), 0.0);
    if constexpr (n == 2) {
        tables.gradient_gradient.add(sign, J(0, 0), J(1, 1), work.value.data());
        tables.gradient_gradient.add(-sign, J(0, 1), J(1, 0), work.value.data());
    } else {
        for (int j = 0; j < 3; ++j) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            std::fill(work.minor.begin(), work.minor.end(), 0.0);
            tables.gradient_gradient.add(1, J(1, j1), J(2, j2), work.minor.data());
            tables.gradient_gradient.add(-1, J(1, j2), J(2, j1), work.minor.data());
            tables.minor_gradient.add(sign, work.minor.data(), J(0, j), work.value.data());
        }
    }
    for (int a = 0; a < tables.jacobian.count; ++a) work.value[a] /= tables.jacobian.multinomial[a];
}

template <int n>
Bound bound_element(const Mesh& mesh, const std::vector<double>& x, int e, const JacobianTables& tables,
                    const CertificateParams& params, Workspace& work) {
    const int sign = to_reference<n>(mesh, x, e, tables.nodes, work);
    if (sign == 0) return {0, Validity::invalid};
    if (mesh.degree == 1) return {static_cast<double>(sign), sign > 0 ? Validity::valid : Validity::invalid};
    const double largest = differentiate<n>(tables, mesh.degree, work);
    expand_determinant<n>(tables, sign, work);
    for (double v : work.value)
        if (!std::isfinite(v)) return {0, Validity::invalid};
    // First-order effect of errors of a few units in the last place of y on a sum of n! products of n entries.
    const double entry_error = 8 * epsilon * work.largest_term * tables.amplification * 2 * mesh.degree;
    const double margin = (n == 2 ? 2 : 6) * n * entry_error * std::pow(std::max(largest, 1.0), n - 1);
    const PolynomialMinimum minimum =
        polynomial_minimum(tables.jacobian, work.value.data(), params.tolerance, params.max_bisections);
    const double lower = minimum.lower - margin;
    if (minimum.upper <= 0) return {lower, Validity::invalid};
    return {lower, lower > 0 ? Validity::valid : Validity::undecided};
}

template <int n>
std::vector<Bound> bound_elements(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    const JacobianTables tables(n, mesh.degree);
    const int count = mesh.element_count();
    std::vector<Bound> bounds(count);
    parallel_for((count + block_elements - 1) / block_elements, [&](int block) {
        Workspace work;
        work.J.resize(offset(n * n, tables.gradient.count));
        work.minor.resize(tables.minor.count);
        work.value.resize(tables.jacobian.count);
        for (int e = block * block_elements; e < std::min(count, (block + 1) * block_elements); ++e)
            bounds[e] = bound_element<n>(mesh, x, e, tables, params, work);
    }, element_work * block_elements);
    return bounds;
}

}  // namespace

Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    std::vector<Bound> bounds;
    with_dimension(mesh.dim, [&](auto n) { bounds = bound_elements<n()>(mesh, x, params); });
    Certificate certificate{1, true, 0, {}, {}};
    std::vector<double>& lower = certificate.lower_bound;
    std::vector<int>& uncertified = certificate.uncertified;
    for (int e = 0; e < mesh.element_count(); ++e) {
        lower.push_back(bounds[e].lower);
        if (bounds[e].validity != Validity::valid) uncertified.push_back(e);
        certificate.undecided += bounds[e].validity == Validity::undecided;
    }
    if (!lower.empty()) certificate.min_scaled_jacobian = *std::min_element(lower.begin(), lower.end());
    certificate.valid = uncertified.empty();
    std::stable_sort(uncertified.begin(), uncertified.end(), [&](int a, int b) { return lower[a] < lower[b]; });
    return certificate;
}

}  // namespace almesh
