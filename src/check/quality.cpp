// The Jacobian of the map from the regular cell is F = dx/dxi E^{-1}, E the Jacobian of the regular cell, of a simplex
// its edge vectors in columns; eta = |F|^2 / (n (det F)^{2/n}) at the points of a quadrature rule of exactness 2 p.
#include "check/quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "base/table.hpp"
#include "energy/densities.hpp"
#include "geometry/patch.hpp"
#include "mesh/mesh.hpp"
#include "mesh/quadrature.hpp"
#include "mesh/regular_cell.hpp"

namespace almesh {
namespace {

constexpr int bar_length = 50;  // characters of the longest bar

// At the points of the quadrature: inverse Jacobians of the regular cell.
template <int n>
std::vector<Mat<n>> from_regular(const CellType& cell, const Quadrature& quadrature) {
    const ReferenceElement linear = reference_element(cell, 1, quadrature);
    const std::vector<double> x = regular_cell(cell);
    constexpr int vertices[] = {0, 1, 2, 3, 4, 5, 6, 7};
    std::vector<Mat<n>> inverses;
    for (int q = 0; q < linear.points; ++q) inverses.push_back(inverse<n>(jacobian_at<n>(vertices, x, linear, q)));
    return inverses;
}

// Per element: the least value(jacobian_of, J_0^-1) at its quadrature points, within [0, 1]; jacobian_of(x): dx/dxi
// there, J_0: of the regular cell.
template <int n, class Value>
std::vector<double> least_at_points(const Mesh& mesh, const Value& value) {
    std::vector<double> least(mesh.element_count());
    for (const ElementGroup& group : mesh.element_groups()) {
        const bool is_constant = mesh.degree == 1 && group.cell->is_simplex();  // the Jacobian
        const Quadrature quadrature = cell_quadrature(*group.cell, is_constant ? 1 : 2 * mesh.degree);
        const ReferenceElement reference = reference_element(*group.cell, mesh.degree, quadrature);
        const std::vector<Mat<n>> inverses = from_regular<n>(*group.cell, quadrature);
        parallel_for(group.count, [&](int k) {
            const int e = group.first + k;
            double of_element = 1;
            for (int q = 0; q < reference.points; ++q)
                of_element = std::min(of_element, value([&](const std::vector<double>& x) {
                    return jacobian_at<n>(mesh.element(e), x, reference, q);
                }, inverses[q]));
            least[e] = std::max(of_element, 0.0);
        });
    }
    return least;
}

// 1 / eta, zero for an inverted J.
template <int n>
double shape(const Mat<n>& J, const Mat<n>& from_regular) {
    return 1 / distortion<n>(multiply<n>(J, from_regular), 0);
}

void measure_edges(const Mesh& mesh, const std::vector<double>& x, QualityStatistics& statistics) {
    statistics.min_edge = std::numeric_limits<double>::max();
    statistics.max_edge = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const std::vector<Vec<3>> vertex = positions(mesh, x, mesh.element(e), mesh.cell(e).vertices);
        for (const auto& [i, j] : mesh.cell(e).edges) {
            const double edge = length(vertex[j] - vertex[i]);
            statistics.min_edge = std::min(statistics.min_edge, edge);
            statistics.max_edge = std::max(statistics.max_edge, edge);
        }
    }
}

}  // namespace

QualityStatistics mesh_quality(const Mesh& mesh, const std::vector<double>& x) {
    QualityStatistics statistics{};
    with_dimension(mesh.dim, [&](auto n) {
        statistics.quality = least_at_points<n()>(mesh, [&](const auto& jacobian_of, const Mat<n()>& from_regular) {
            return shape<n()>(jacobian_of(x), from_regular);
        });
    });
    const std::vector<double>& quality = statistics.quality;
    statistics.min = quality.empty() ? 1 : *std::min_element(quality.begin(), quality.end());
    for (double q : quality) ++statistics.histogram[std::min(9, static_cast<int>(10 * q))];
    measure_edges(mesh, x, statistics);
    return statistics;
}

SizeSkew size_skew(const Mesh& mesh, const std::vector<double>& ideal, const std::vector<double>& x) {
    std::vector<double> of;
    with_dimension(mesh.dim, [&](auto n) {
        of = least_at_points<n()>(mesh, [&](const auto& jacobian_of, const Mat<n()>& from_regular) {
            const Mat<n()> J = jacobian_of(x);
            const double ratio = determinant(J) / determinant(jacobian_of(ideal));
            return ratio > 0 ? std::sqrt(std::min(ratio, 1 / ratio)) * shape<n()>(J, from_regular) : 0;
        });
    });
    const int count = mesh.element_count();
    if (count == 0) return {1, 1};
    return {deterministic_sum(count, [&](int e) { return of[e]; }) / count, *std::min_element(of.begin(), of.end())};
}

std::string histogram_text(const QualityStatistics& statistics) {
    const int most = *std::max_element(statistics.histogram.begin(), statistics.histogram.end());
    std::string text;
    for (int k = 0; k < 10; ++k) {
        const int count = statistics.histogram[k];
        // At least one mark for a bin that is not empty, so that a few bad elements are seen.
        const int bar = count == 0 ? 0 : std::max(1, static_cast<int>(1.0 * count / most * bar_length));
        text += concat(fixed(k / 10.0, 1), " - ", fixed((k + 1) / 10.0, 1), " ", padded(concat(count), 9),
                       std::string(bar > 0 ? 2 : 0, ' '), std::string(bar, '#'), "\n");
    }
    return text;
}

}  // namespace almesh
