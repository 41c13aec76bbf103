#include "report/quality_change.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"

namespace almesh {
namespace {

constexpr int bins = 20;
constexpr double lowest = -1.5;  // of a tetrahedron the scaled Jacobian can be -sqrt(2)
constexpr std::array<const char*, 2> times = {"before", "after"};

std::array<int, bins + 1> histogram(const std::vector<double>& values) {
    std::array<int, bins + 1> counts{};
    for (const double value : values) ++counts[value > 0 ? 1 + std::min(bins - 1, static_cast<int>(bins * value)) : 0];
    return counts;
}

}  // namespace

QualityChange quality_change(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& x) {
    return {{{{"scaled Jacobian", "scaled_jacobian", {corner_jacobians(mesh, before), corner_jacobians(mesh, x)}},
              {"quality 1/eta", "quality", {mesh_quality(mesh, before).quality, mesh_quality(mesh, x).quality}}}}};
}

void print_quality_change(std::FILE* out, const QualityChange& change) {
    constexpr std::array bounds = {0.1, 0.2, 0.3, 0.5};
    std::fprintf(out, "%-24s  %8s  %8s  %7s", "elements", "least", "mean", "<= 0");
    for (const double bound : bounds) std::fprintf(out, "  %7s", concat("< ", bound).c_str());
    for (const auto& [title, column, of] : change.measures)
        for (int k = 0; k < 2; ++k) {
            const std::vector<double>& values = of[k];
            const auto count = static_cast<int>(values.size());
            const auto below = [&](const auto& is) {
                std::fprintf(out, "  %7d", static_cast<int>(std::count_if(values.begin(), values.end(), is)));
            };
            const double sum = deterministic_sum(count, [&](int e) { return values[e]; });
            std::fprintf(out, "\n%-17s%-7s  %8s  %8.4f", k == 0 ? title : "", times[k],
                         rounded_down(*std::min_element(values.begin(), values.end()), 4).c_str(), sum / count);
            below([](double value) { return value <= 0; });
            for (const double bound : bounds) below([bound](double value) { return value < bound; });
        }
    std::fprintf(out, "\n");
}

std::string quality_csv(const QualityChange& change) {
    std::string text = "low,high";
    std::vector<std::array<int, bins + 1>> columns;
    for (const auto& [title, column, of] : change.measures)
        for (int k = 0; k < 2; ++k) {
            text += concat(",", column, "_", times[k]);
            columns.push_back(histogram(of[k]));
        }
    for (int b = 0; b <= bins; ++b) {
        text += concat("\n", b == 0 ? lowest : (b - 1.0) / bins, ",", static_cast<double>(b) / bins);
        for (const auto& counts : columns) text += concat(",", counts[b]);
    }
    return text + "\n";
}

}  // namespace almesh
