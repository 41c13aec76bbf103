#include "report/mesh_quality.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "report/results.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "check/boundary_distance.hpp"
#include "check/infeasible.hpp"
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"

namespace almesh {
namespace {

constexpr int bins = 20;
constexpr double lowest = -1.5;  // of a tetrahedron the scaled Jacobian can be -sqrt(2)

int bin_of(double value) { return value > 0 ? 1 + std::min(bins - 1, static_cast<int>(bins * value)) : 0; }

// The ten of least scaled Jacobian, in a curved mesh of least certified bound. bound, quality: per element.
std::string worst_elements(const Output& out, const Mesh& mesh, const std::vector<double>& bound,
                           const std::vector<double>& quality) {
    const std::vector<double> corner = corner_jacobians(mesh, mesh.x), &value = mesh.degree > 1 ? bound : corner;
    const char* const name = mesh.degree > 1 ? "scaled Jacobian of the straight cell" : "scaled Jacobian";
    std::vector<int> order(quality.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return value[a] < value[b]; });
    order.resize(std::min<std::size_t>(order.size(), 10));
    std::vector<std::string> others(quality.size());
    Fields worst;
    for (const int e : order) {
        others[e] = concat(rounded_down(bound[e], 4), "  ", rounded_down(quality[e], 4));
        worst.push_back(json({{"element", mesh.file.element_id[e]}, {"scaled_jacobian", corner[e]},
                              {"certified_bound", bound[e]}, {"quality", quality[e]}}));
    }
    out.add({{"worst", json(worst)}});
    return list_elements(mesh, order, mesh.x, corner, others, concat(name, ", certified bound, quality 1/eta")).first;
}

}  // namespace

QualityChange quality_change(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& x) {
    const std::string corners = mesh.degree > 1 ? "scaled Jacobian* " : "scaled Jacobian  ";
    if (before.empty())
        return {{corners, "scaled_jacobian", corner_jacobians(mesh, x)},
                {"quality 1/eta", "quality", mesh_quality(mesh, x).quality}};
    return {{corners + "before", "scaled_jacobian_before", corner_jacobians(mesh, before)},
            {"                 after", "scaled_jacobian_after", corner_jacobians(mesh, x)},
            {"quality 1/eta    before", "quality_before", mesh_quality(mesh, before).quality},
            {"                 after", "quality_after", mesh_quality(mesh, x).quality}};
}

std::string quality_table(const Output& out, const QualityChange& change, int degree) {
    constexpr std::array bounds = {0.1, 0.2, 0.3, 0.5};
    std::vector<TextColumn> columns = {{"elements", -24}, {"least", 8}, {"mean", 8}, {"<= 0", 7}};
    for (const double bound : bounds) columns.push_back({concat("< ", bound), 7});
    std::vector<Fields> rows;
    for (const QualityMeasure& measure : change) {
        const std::vector<double>& values = measure.values;
        const auto count = [&](const auto& is) { return std::count_if(values.begin(), values.end(), is); };
        const int elements = static_cast<int>(values.size());
        const double mean = deterministic_sum(elements, [&](int e) { return values[e]; }) / elements;
        const double least = *std::min_element(values.begin(), values.end());
        out.add({{measure.column + "_least", least}, {measure.column + "_mean", mean}});
        Fields row = {measure.title, rounded_down(least, 4), fixed(mean, 4), count([](double v) { return v <= 0; })};
        for (const double bound : bounds) row.push_back(count([bound](double value) { return value < bound; }));
        rows.push_back(row);
    }
    return TextTable{columns}.text(rows) +
           (degree > 1 ? "* corners of the straight cells; the certified bound is that of the curved ones\n" : "");
}

std::string quality_csv(const QualityChange& change) {
    Fields heading = {"low", "high"};
    std::vector<Fields> rows;
    for (int b = 0; b <= bins; ++b)
        rows.push_back({b == 0 ? lowest : (b - 1.0) / bins, static_cast<double>(b) / bins});
    for (const QualityMeasure& measure : change) {
        heading.push_back(measure.column);
        std::array<int, bins + 1> counts{};
        for (const double value : measure.values) ++counts[bin_of(value)];
        for (int b = 0; b <= bins; ++b) rows[b].push_back(counts[b]);
    }
    std::string text = csv_row(heading);
    for (const Fields& row : rows) text += csv_row(row);
    return text;
}

bool print_quality(const Output& out, const Mesh& mesh, const std::string& before, const std::vector<double>& came,
                   const std::string& folder) {
    const Certificate certificate = certify(mesh, mesh.x);
    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    print(out, "\nshape quality 1/eta against the regular ", mesh.is_simplicial() ? "simplex" : "cell", "; edges ",
          to_text(shape.min_edge, 4), " to ", to_text(shape.max_edge, 4), "\n", histogram_text(shape),
          "\nworst elements", worst_elements(out, mesh, certificate.certified_bound, shape.quality), "\n");
    if (!before.empty()) {
        const std::vector<BoundaryDistance> distances = boundary_distances(mesh, came, mesh.x);
        Fields rows;
        for (const BoundaryDistance& of : distances)
            rows.push_back(json({{"boundary", mesh.boundaries[of.boundary]}, {"boundary_distance", of.largest},
                                 {"relative_boundary_distance", of.relative_largest}}));
        out.add({{"distances", json(rows)}});
        if (distances.empty()) print(out, "\nall faces are where ", before, " has them\n");
        else print(out, "\n", distance_table(mesh, distances, "those of " + before));
        print(out, "\nbefore: ", before);
    }
    print(out, "\n", quality_table(out, quality_change(mesh, came, mesh.x), mesh.degree),
          certificate.valid ? "certified valid: " : "", "certified bound ",
          rounded_down(certificate.min_certified_bound, 6), "\n");
    print_uncertified(out, mesh, mesh.x, certificate, folder);
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    out.add({{"edge_min", shape.min_edge}, {"edge_max", shape.max_edge},
             {{"certified_bound", "", "1"}, rounded_down(certificate.min_certified_bound, 6)},
             {"invalid_elements", certificate.uncertified.size()},
             {"certified_valid", certificate.valid ? "yes" : "no"},
             {"certified_injective", injectivity.certified ? "yes" : "no"}});
    if (injectivity.certified) print(out, "certified injective: no two elements overlap\n");
    else if (certificate.valid) print(out, "NOT certified injective: ", overlap_text(mesh, injectivity), "\n");
    return injectivity.certified;
}

}  // namespace almesh
