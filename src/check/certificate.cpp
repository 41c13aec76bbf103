// Per element: the Bezier coefficients of det J (element_jacobian.hpp), bounded from below by bisection
// (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013).
#include "check/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "geometry/element_jacobian.hpp"

namespace almesh {
namespace {

constexpr double element_work = 500;  // simple operations for one element, at least

// Of the scaled Jacobian: lower <= minimum <= upper. upper <= 0 proves the element invalid.
struct Bounds {
    double lower, upper;
};

template <int n>
Bounds bound_straight(const int* vertex, const std::vector<double>& x) {
    const double value = straight_scaled_jacobian<n>(vertex, x);
    return {value, value};
}

template <int n>
Bounds bound_curved(const int* node, const std::vector<double>& x, const JacobianBasis& basis,
                    const CertificateParams& params) {
    const double straight = std::abs(determinant(straight_jacobian<n>(node, x)));
    ElementJacobian<n, double> element(basis);
    for (int i = 0; i < basis.position.bernstein.count; ++i)
        std::copy_n(point(x, node[i], n), n, element.position(0)[i].begin());
    element.compute(1);
    const double* const b = element.coefficients(0);
    if (!element.has_frame() || !std::all_of(b, b + basis.jacobian.count, [](double c) { return std::isfinite(c); }))
        return {0, 0};
    const PolynomialMinimum minimum = polynomial_minimum(basis.jacobian, b, params.tolerance, params.max_bisections);
    const double scale = std::max(element.unit() / straight, std::numeric_limits<double>::min());
    return {scale * (minimum.lower - element.rounding()), scale * minimum.upper};
}

}  // namespace

Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    std::optional<JacobianBasis> basis;
    if (mesh.degree > 1) basis.emplace(mesh.dim, mesh.degree);
    std::vector<Bounds> bounds(mesh.element_count());
    with_dimension(mesh.dim, [&](auto n) {
        parallel_for(mesh.element_count(), [&](int e) {
            const int* const node = mesh.element(e);
            bounds[e] = basis ? bound_curved<n>(node, x, *basis, params) : bound_straight<n>(node, x);
        }, element_work);
    });
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

std::string counts_of(const Certificate& certificate) {
    const std::size_t undecided = certificate.undecided, invalid = certificate.uncertified.size() - undecided;
    if (undecided == 0) return counted(invalid, "element") + " proved invalid";
    if (invalid == 0) return counted(undecided, "element") + " undecided";
    return concat(counted(invalid, "element"), " proved invalid, ", undecided, " undecided");
}

}  // namespace almesh
