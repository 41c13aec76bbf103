#include "report/terminal.hpp"

#include <algorithm>
#include <cmath>

#include "problem/memory.hpp"
#include "report/mesh_quality.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/part.hpp"

namespace almesh {

void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    if (!deck.title.empty()) print(out, deck.title, "\n");
    print(out, deck.mesh, ": ", mesh.nodes(), " nodes, ", mesh.elements_text(), " of degree ", mesh.degree, ", ",
          mesh.face_count(), " boundary faces; ", counted(static_cast<std::size_t>(max_threads()), "thread"), "\n");
    for (const std::string& note : problem.notes) print(out, "note: ", note, "\n");
    if (!deck.sweeps.empty()) std::fprintf(out, "note: one run, without the lines `sweep`: almesh sweep runs all\n");
    constexpr double worth_telling = 0.5e9;  // bytes
    const LinearSolverParams linear = linear_of(deck, problem.pairs);
    const double bytes = deck.frames.empty() ? predicted_bytes(mesh, linear) : 0;
    const bool half = stores_half(mesh.nodes(), hessian_blocks(mesh), mesh.dim, linear);
    if (bytes > worth_telling)
        std::fprintf(out, "about %.2g GB of memory will be needed%s\n", bytes / 1e9,
                     half ? ", with half of the Hessian in single precision" : "");
    std::fflush(out);
}

void report_improvement(const Output& out, const Deck& deck, const Problem& problem, const Solution& solution) {
    const QualityChange change = quality_change(problem.mesh(), problem.mesh().x, solution.x);
    print(out, quality_table(out, change, problem.mesh().degree));
    write_file(deck.output + "/quality.csv", quality_csv(change));
}

void print_volumes(const Output& out, const Deck& deck, const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const std::vector<GroupCells> volumes = volume_groups(mesh);
    if (volumes.size() < 2) return;
    std::vector<Fields> rows;
    Fields told;
    const Units units = {mesh.dim, problem.frame.length};
    DistortionParams params = distortion_of(deck);
    params.curved_ideal = problem.is_own_ideal;
    for (const GroupCells& volume : volumes) {
        std::vector<char> chosen(mesh.element_count(), 0);
        double least = 1;
        for (const int e : volume.cells) {
            chosen[e] = 1;
            least = std::min(least, solution.certificate.certified_bound[e]);
        }
        const MeshPart part = part_of(mesh, chosen, "rest");
        const std::vector<double> x = part.restricted(solution.x);
        params.regular.clear();
        if (!problem.regular.empty())
            for (const int e : volume.cells) params.regular.push_back(problem.regular[e]);
        const auto energy = make_energy(part, part.restricted(problem.ideal()), params);
        const DistortionStatistics found = energy->statistics(x);
        told.push_back(json({{"group", volume.name}, {"elements", volume.cells.size()},
                             {"energy", units.energy(energy->energy(x))}, {"relative_quality", found.relative_quality},
                             {"max_distortion", found.max_distortion}, {"certified_bound", least}}));
        rows.push_back({volume.name, volume.cells.size(), scientific(energy->energy(x), 3),
                        fixed(found.relative_quality, 6), to_text(found.max_distortion, 4),
                        rounded_down(least, 4)});
    }
    const TextTable table{{{"volume", -6}, {"elements", 8}, {"energy", 9}, {"q", 8}, {"max eta", 9},
                           {"certified bound"}}};
    print(out, table.text(rows));
    out.add({{"volumes", json(told)}});
}

}  // namespace almesh
