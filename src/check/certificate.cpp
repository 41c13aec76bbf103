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
#include "mesh/sub_simplices.hpp"

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

// Of simplex `part` of an element. straight: the determinant of the straight element.
template <int n>
Bounds bound_curved(const int* node, const std::vector<double>& x, double straight, const SubSimplices& cut, int part,
                    const JacobianBasis& basis, const CertificateParams& params) {
    ElementJacobian<n, double> element(basis);
    const auto position = [&](int i) {
        Vec<n> at;
        std::copy_n(point(x, node[i], n), n, at.begin());
        return at;
    };
    if (cut.count() > 1) cut.place<n, double>(part, position, element.position(0));
    else
        for (int i = 0; i < cut.nodes; ++i) element.position(0)[i] = position(i);
    element.compute(1);
    const double* const b = element.coefficients(0);
    if (!element.has_frame() || !std::all_of(b, b + basis.jacobian.count, [](double c) { return std::isfinite(c); }))
        return {0, 0};
    const PolynomialMinimum minimum = polynomial_minimum(basis.jacobian, b, params.tolerance, params.max_bisections);
    const double scale = std::max(element.unit() / straight, std::numeric_limits<double>::min());
    return {scale * (minimum.lower - element.rounding()), scale * minimum.upper};
}

// The elements of a group. Other cells than simplices are cut into some (SubSimplices).
template <int n>
void bound_group(const Mesh& mesh, const ElementGroup& group, const std::vector<double>& x,
                 const CertificateParams& params, std::vector<Bounds>& bounds) {
    const bool is_simplex = group.cell->is_simplex();
    const SubSimplices cut(*group.cell, mesh.degree);
    std::optional<JacobianBasis> basis;
    if (cut.degree > 1) basis.emplace(n, cut.degree);
    parallel_for(group.count, [&](int k) {
        const int e = group.first + k;
        const int* const node = mesh.element(e);
        if (!basis) {
            bounds[e] = bound_straight<n>(node, x);
            return;
        }
        const double straight = std::abs(is_simplex ? determinant(straight_jacobian<n>(node, x)) : volume(mesh, x, e));
        for (int part = 0; part < cut.count(); ++part) {
            const Bounds of = bound_curved<n>(node, x, straight, cut, part, *basis, params);
            const Bounds before = part == 0 ? of : bounds[e];
            bounds[e] = {std::min(before.lower, of.lower), std::min(before.upper, of.upper)};
        }
    }, element_work);
}

}  // namespace

Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    std::vector<Bounds> bounds(mesh.element_count());
    for (const ElementGroup& group : mesh.element_groups())
        with_dimension(mesh.dim, [&](auto n) { bound_group<n()>(mesh, group, x, params, bounds); });
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
