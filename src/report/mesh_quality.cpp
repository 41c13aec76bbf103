#include "report/mesh_quality.hpp"

#include <algorithm>
#include <array>

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

}  // namespace

QualityChange quality_change(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& x) {
    return {{"scaled Jacobian  before", "scaled_jacobian_before", corner_jacobians(mesh, before)},
            {"                 after", "scaled_jacobian_after", corner_jacobians(mesh, x)},
            {"quality 1/eta    before", "quality_before", mesh_quality(mesh, before).quality},
            {"                 after", "quality_after", mesh_quality(mesh, x).quality}};
}

std::string quality_table(const QualityChange& change) {
    constexpr std::array bounds = {0.1, 0.2, 0.3, 0.5};
    std::vector<TextColumn> columns = {{"elements", -24}, {"least", 8}, {"mean", 8}, {"<= 0", 7}};
    for (const double bound : bounds) columns.push_back({concat("< ", bound), 7});
    std::vector<Cells> rows;
    for (const QualityMeasure& measure : change) {
        const std::vector<double>& values = measure.values;
        const auto count = [&](const auto& is) { return std::count_if(values.begin(), values.end(), is); };
        const int elements = static_cast<int>(values.size());
        const double sum = deterministic_sum(elements, [&](int e) { return values[e]; });
        Cells row = {measure.title, rounded_down(*std::min_element(values.begin(), values.end()), 4),
                     fixed(sum / elements, 4), count([](double value) { return value <= 0; })};
        for (const double bound : bounds) row.push_back(count([bound](double value) { return value < bound; }));
        rows.push_back(row);
    }
    return TextTable{columns}.text(rows);
}

std::string quality_csv(const QualityChange& change) {
    Cells heading = {"low", "high"};
    std::vector<Cells> rows;
    for (int b = 0; b <= bins; ++b)
        rows.push_back({b == 0 ? lowest : (b - 1.0) / bins, static_cast<double>(b) / bins});
    for (const QualityMeasure& measure : change) {
        heading.push_back(measure.column);
        std::array<int, bins + 1> counts{};
        for (const double value : measure.values) ++counts[bin_of(value)];
        for (int b = 0; b <= bins; ++b) rows[b].push_back(counts[b]);
    }
    std::string text = csv_row(heading);
    for (const Cells& row : rows) text += csv_row(row);
    return text;
}

bool print_quality(std::FILE* out, const Mesh& mesh, const std::string& before, const std::vector<double>& came,
                   const std::string& folder) {
    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    print(out, "\nshape quality 1/eta against the regular ", mesh.is_simplicial() ? "simplex" : "cell", ": min ",
          to_text(shape.min, 4), ", mean ", to_text(shape.mean, 4), "; edges ", to_text(shape.min_edge, 4), " to ",
          to_text(shape.max_edge, 4), "\n", histogram_text(shape), "\nworst elements (id, centre, quality):",
          list_invalid(mesh, shape.worst, mesh.x, shape.quality).first, "\n");

    if (!before.empty()) {
        const std::vector<BoundaryDistance> distances = boundary_distances(mesh, came, mesh.x);
        if (distances.empty()) print(out, "\nall faces are where ", before, " has them\n");
        else print(out, "\n", distance_table(mesh, distances, "those of " + before));
        print(out, "\nbefore: ", before, "\n", quality_table(quality_change(mesh, came, mesh.x)));
    }

    const Certificate certificate = certify(mesh, mesh.x);
    print(out, "\nscaled Jacobian >= ", rounded_down(certificate.min_scaled_jacobian, 6), " everywhere",
          certificate.valid ? ": all elements certified valid\n" : "\n");
    print_uncertified(out, mesh, mesh.x, certificate, folder);
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    if (injectivity.certified) print(out, "certified injective: no two elements overlap\n");
    else if (certificate.valid) print(out, "NOT certified injective: ", overlap_text(mesh, injectivity), "\n");
    return injectivity.certified;
}

}  // namespace almesh
