// Groups of elements in a run: what they came to.
#include "app/run/solve.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/table.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/part.hpp"

namespace almesh {

void print_volumes(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const std::vector<GroupCells> volumes = volume_groups(mesh);
    if (volumes.size() < 2) return;
    std::vector<Cells> rows;
    DistortionParams params = distortion_of(deck);
    params.curved_ideal = problem.is_own_ideal;
    for (const GroupCells& volume : volumes) {
        std::vector<char> chosen(mesh.element_count(), 0);
        double least = 1;
        for (const int e : volume.cells) {
            chosen[e] = 1;
            least = std::min(least, solution.certificate.lower_bound[e]);
        }
        const MeshPart part = part_of(mesh, chosen, "rest");
        const std::vector<double> x = part.restricted(solution.x);
        params.regular.clear();
        if (!problem.regular.empty())
            for (const int e : volume.cells) params.regular.push_back(problem.regular[e]);
        const auto energy = make_energy(part, part.restricted(problem.ideal()), params);
        const DistortionStatistics found = energy->statistics(x);
        rows.push_back({volume.name, volume.cells.size(), scientific(energy->energy(x), 3),
                        fixed(found.relative_quality, 6), to_text(found.max_distortion, 4),
                        ">= " + rounded_down(least, 4)});
    }
    const TextTable table({{"volume", -6}, {"elements", 8}, {"energy", 9}, {"q", 8}, {"max eta", 9},
                           {"scaled Jacobian"}});
    print(out, table.text(rows));
}

}  // namespace almesh
