#include "report/quality_change.hpp"

#include <algorithm>
#include <array>

#include "base/parallel.hpp"
#include "base/table.hpp"
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
    return TextTable(columns).text(rows);
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

}  // namespace almesh
