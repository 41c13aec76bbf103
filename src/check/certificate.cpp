// Per element: the Bezier coefficients of det J (element_jacobian.hpp), bounded from below by bisection
// (Johnen, Remacle, Geuzaine, J. Comput. Phys. 233, 2013); a batch of elements at once, one per lane.
#include "check/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "geometry/element_jacobian.hpp"

namespace almesh {
namespace {

constexpr double element_work = 500;   // simple operations for one element, at least
constexpr double plainly_valid = 0.1;  // scaled determinant

// Of the scaled determinant: lower <= minimum <= upper. upper <= 0 proves the element invalid.
struct Bounds {
    double lower, upper;
};

template <int n>
struct GroupBounds {
    const Mesh& mesh;
    const CellType& cell;
    const std::vector<double>& x;
    const CertificateParams& params;
    std::vector<Bounds>& bounds;
    // Of the elements, and of the straight-sided ones on their vertices.
    JacobianBasis basis{cell, mesh.degree}, straight{cell, 1};

    // Of some of its elements. sharp: by bisection; else by the coefficients alone.
    void bound(const std::vector<int>& elements, bool sharp) {
        if (cell.is_simplex() && mesh.degree == 1)
            return parallel_for(static_cast<int>(elements.size()), [&](int k) {
                const double value = straight_scaled_determinant<n>(mesh.element(elements[k]), x);
                bounds[elements[k]] = {value, value};
            }, element_work);
        const int count = static_cast<int>(elements.size());
        parallel_for_uneven((count + lanes - 1) / lanes, [&](int batch) {
            const int first = batch * lanes;
            bound_batch(&elements[first], std::min(lanes, count - first), sharp);
        }, element_work * lanes);
    }

    // The determinant of the straight-sided elements, of other cells than simplices its mean.
    Lanes straight_determinant(const int* const* node) const {
        if (!cell.is_simplex()) {
            ElementJacobian<n, Lanes> elements(straight);
            compute(elements, node, cell.vertices);
            return mean_determinant(elements, straight);
        }
        return abs(determinant(straight_jacobian<n>(node, x)));
    }

    // Of straight-sided elements. In a pyramid they have no layers, over which the mean would be weighted.
    static Lanes mean_determinant(const ElementJacobian<n, Lanes>& elements, const JacobianBasis& of) {
        Lanes sum{};
        for (int a = 0; a < of.jacobian.count; ++a) sum += elements.coefficients(0)[a];
        return abs(elements.unit() / of.jacobian.count * sum);
    }

    void compute(ElementJacobian<n, Lanes>& elements, const int* const* node, int nodes) const {
        for (int i = 0; i < nodes; ++i) elements.position(0)[i] = gathered<n>(node, i, x);
        elements.compute(1);
    }

    void bound_batch(const int* element, int count, bool sharp) {
        const int* node[lanes];
        for (int l = 0; l < lanes; ++l) node[l] = mesh.element(element[std::min(l, count - 1)]);
        const Lanes of_vertices = mesh.degree > 1 ? straight_determinant(node) : Lanes{};
        ElementJacobian<n, Lanes> elements(basis);
        compute(elements, node, basis.position.nodes);
        const Lanes* const b = elements.coefficients(0);
        Lanes lower = b[0], upper = in_all_lanes(std::numeric_limits<double>::infinity()), sum{};
        for (int a = 0; a < basis.jacobian.count; ++a) {
            lower = select(b[a] < lower, b[a], lower);
            sum += b[a];
        }
        for (const Bernstein::Corner& corner : basis.jacobian.corners)
            upper = select(b[corner.place] < upper, b[corner.place], upper);
        const Lanes mean = mesh.degree > 1 ? of_vertices : mean_determinant(elements, basis);
        const Lanes scale = max(elements.unit() / mean, in_all_lanes(std::numeric_limits<double>::min()));
        const Lanes rounding = elements.rounding();
        const LaneBits has_frame = elements.has_frame();
        for (int l = 0; l < count; ++l) {
            Bounds& of = bounds[element[l]] = {0, 0};
            if (!has_frame[l] || !std::isfinite(sum[l])) continue;
            of = sharp ? sharp_bounds(b, l) : Bounds{lower[l], upper[l]};
            of = {scale[l] * (of.lower - rounding[l]), scale[l] * of.upper};
        }
    }

    Bounds sharp_bounds(const Lanes* b, int lane) const {
        thread_local std::vector<double> c;
        c.clear();
        for (int a = 0; a < basis.jacobian.count; ++a) c.push_back(b[a][lane]);
        const PolynomialMinimum minimum =
            polynomial_minimum(basis.jacobian, c.data(), params.tolerance, params.max_bisections);
        return {minimum.lower, minimum.upper};
    }
};

// First pass: bisection for simplices, the coefficients alone for other cells. Second pass: bisection for the others
// that the first neither proves plainly valid nor excludes as the worst element.
template <int n>
void bound_all(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params,
               std::vector<Bounds>& bounds) {
    for (const bool sharp : {false, true}) {
        double least = std::numeric_limits<double>::infinity();
        for (const Bounds& of : bounds) least = std::min(least, of.upper);
        for (const ElementGroup& group : mesh.element_groups()) {
            if (sharp && group.cell->is_simplex()) continue;
            std::vector<int> elements;
            for (int e = group.first; e < group.first + group.count; ++e) {
                const Bounds& of = bounds[e];
                const bool is_open = of.upper - of.lower > params.tolerance * std::abs(of.upper);
                if (!sharp || (is_open && (of.lower < plainly_valid || of.lower < least))) elements.push_back(e);
            }
            if (elements.empty()) continue;
            GroupBounds<n>{mesh, *group.cell, x, params, bounds}.bound(elements, sharp || group.cell->is_simplex());
        }
    }
}

}  // namespace

Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    std::vector<Bounds> bounds(mesh.element_count());
    with_dimension(mesh.dim, [&](auto n) { bound_all<n()>(mesh, x, params, bounds); });
    Certificate certificate{1, true, 0, {}, {}};
    std::vector<double>& lower = certificate.certified_bound;
    std::vector<int>& uncertified = certificate.uncertified;
    for (int e = 0; e < mesh.element_count(); ++e) {
        lower.push_back(bounds[e].lower);
        if (bounds[e].lower > 0) continue;
        uncertified.push_back(e);
        certificate.undecided += bounds[e].upper > 0;
    }
    if (!lower.empty()) certificate.min_certified_bound = *std::min_element(lower.begin(), lower.end());
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
