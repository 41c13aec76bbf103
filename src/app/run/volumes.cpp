// Groups of elements in a run: what they came to.
#include "app/run/solve.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/text.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/part.hpp"

namespace almesh {

namespace {

// Of the whole's positions, x, those of the nodes of a part that has its chosen elements in the same order.
std::vector<double> of_part(const Mesh& part, const Mesh& whole, const std::vector<int>& elements,
                            const std::vector<double>& x) {
    std::vector<double> result(part.x.size());
    for (int e = 0; e < part.element_count(); ++e)
        for (int i = 0; i < part.element_nodes(e); ++i)
            std::copy_n(point(x, whole.element(elements[e])[i], whole.dim), whole.dim,
                        point(result, part.element(e)[i], whole.dim));
    return result;
}

}  // namespace

void print_volumes(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const std::vector<GroupCells> volumes = volume_groups(mesh);
    if (volumes.size() < 2) return;
    std::size_t width = 6;
    for (const GroupCells& volume : volumes) width = std::max(width, volume.name.size());
    std::fprintf(out, "%-*s  elements     energy         q    max eta  scaled Jacobian\n", static_cast<int>(width),
                 "volume");
    DistortionParams params = distortion_of(deck);
    params.curved_ideal = problem.is_own_ideal;
    for (const GroupCells& volume : volumes) {
        std::vector<char> chosen(mesh.element_count(), 0);
        double least = 1;
        for (const int e : volume.cells) {
            chosen[e] = 1;
            least = std::min(least, solution.certificate.lower_bound[e]);
        }
        const Mesh part = part_of(mesh, chosen, "rest");
        const std::vector<double> x = of_part(part, mesh, volume.cells, solution.x);
        params.regular.clear();
        if (!problem.regular.empty())
            for (const int e : volume.cells) params.regular.push_back(problem.regular[e]);
        const auto energy = make_energy(part, of_part(part, mesh, volume.cells, problem.ideal()), params);
        const DistortionStatistics found = energy->statistics(x);
        std::fprintf(out, "%-*s  %8zu  %9.3e  %8.6f  %9.4g  >= %s\n", static_cast<int>(width), volume.name.c_str(),
                     volume.cells.size(), energy->energy(x), found.relative_quality, found.max_distortion,
                     rounded_down(least, 4).c_str());
    }
}

}  // namespace almesh
