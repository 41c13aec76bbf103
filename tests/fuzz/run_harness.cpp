#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "fuzz/harness.hpp"
#include "fuzz/independent_check.hpp"
#include "fuzz/random_deck.hpp"
#include "fuzz/small_mesh.hpp"

namespace almesh::fuzz {
namespace {

using Motions = std::map<std::string, RandomMotion>;

const RandomMotion& motion_of(const Motions& motions, const std::string& boundary) {
    const auto found = motions.find(boundary);
    return found == motions.end() ? motions.at("rest") : found->second;
}

Point position(const RawMesh& raw, int node, int dim) {
    const double* const x = raw.nodes[node].x;
    return {x[0], x[1], dim == 3 ? x[2] : 0};
}

// What rounding is relative to.
double largest_coordinate(const RawMesh& raw) {
    double largest = 0;
    for (const RawNode& node : raw.nodes)
        for (double x : node.x) largest = std::max(largest, std::abs(x));
    return largest;
}

// The run's files, and what it was asked for.
struct FinishedRun {
    const RawMesh& before;
    const RawMesh& after;
    const Motions& motions;
    Elements old_elements{before}, new_elements{after};
    double tolerance = 0;  // of positions
};

// Every node of the input's boundary that the final mesh has too, by its id.
void check_nodes(const FinishedRun& run) {
    std::map<long long, int> node_of_id;
    for (std::size_t i = 0; i < run.after.nodes.size(); ++i)
        node_of_id[run.after.nodes[i].id] = static_cast<int>(i);
    // Others than vertices get new ids where the degree changes.
    const bool vertices_only = run.old_elements.degree != run.new_elements.degree;
    for (const Elements::Side& side : run.old_elements.sides) {
        const RandomMotion& motion = motion_of(run.motions, side.boundary);
        if (!motion.place) continue;
        for (std::size_t k = 0; k < (vertices_only ? run.old_elements.dim : side.node.size()); ++k) {
            const long long id = run.before.nodes[side.node[k]].id;
            const auto found = node_of_id.find(id);
            demand(found != node_of_id.end(), "the final mesh has no node ", id);
            const Point target = motion.place(position(run.before, side.node[k], run.old_elements.dim));
            const double off = distance(position(run.after, found->second, run.old_elements.dim), {target});
            demand(off <= run.tolerance, "node ", id, " is ", off, " off its target, allowed are ", run.tolerance);
        }
    }
}

// Of a straight mesh: every node on the final boundary, those of refinement and of a higher degree included, is on one
// of the faces that the motion makes of the input's.
void check_faces(const FinishedRun& run) {
    std::map<std::string, std::vector<std::vector<Point>>> targets;
    for (const Elements::Side& side : run.old_elements.sides) {
        const RandomMotion& motion = motion_of(run.motions, side.boundary);
        if (!motion.place) continue;
        auto& face = targets[side.boundary].emplace_back();
        for (int k = 0; k < run.old_elements.dim; ++k)
            face.push_back(motion.place(position(run.before, side.node[k], run.old_elements.dim)));
    }
    for (const Elements::Side& side : run.new_elements.sides) {
        if (!targets.contains(side.boundary)) continue;
        for (int node : side.node) {
            double off = INFINITY;
            for (const auto& face : targets.at(side.boundary))
                off = std::min<double>(off, distance(position(run.after, node, run.old_elements.dim), face));
            demand(off <= run.tolerance, "node ", run.after.nodes[node].id, " is ", off, " off the boundary `",
                   side.boundary, "`, allowed are ", run.tolerance);
        }
    }
}

void check_result(const std::string& mesh_path, const std::string& folder, const Motions& motions,
                  const std::map<std::string, std::string>& settings) {
    const std::string msh = folder + "/final.msh", su2 = folder + "/final.su2";
    const bool has_msh = std::filesystem::exists(msh);
    demand(has_msh || std::filesystem::exists(su2), "no final mesh");
    const RawMesh before = read_mesh(mesh_path), after = read_mesh(has_msh ? msh : su2);
    FinishedRun run = {before, after, motions};
    const std::string fault = fault_of(run.new_elements, false);
    demand(fault.empty(), "certified, but ", fault);

    // Off their targets by no more than the summary says, which is little unless the deck sets other tolerances, or
    // the elements cannot follow a motion that is not affine.
    if (settings.contains("surface") && settings.at("surface") == "slide") return;
    const auto summary = test::summary_of(folder);
    if (test::number(summary, "straight_faces") > 0) return;  // flatter than they came, anywhere up to straight
    const double size = largest_coordinate(before) + largest_coordinate(after),
                 error = test::number(summary, "max_boundary_error");
    run.tolerance = 1.001 * (error + test::number(summary, "largest_slide")) + 1e-12 * size;
    bool usual = true;
    for (const char* const key : {"epsilon_star", "wall_tolerance", "length_scale"})
        usual = usual && !settings.contains(key);
    for (const auto& [boundary, motion] : motions) usual = usual && motion.place;
    demand(!usual || error <= 1e-3 * size, "max_boundary_error = ", error);
    const bool same_ids = has_msh && before.format.ending == ".msh" &&
                          (!settings.contains("refine") || settings.at("refine") == "0");
    if (same_ids) check_nodes(run);
    if (run.old_elements.degree == 1) check_faces(run);
}

}  // namespace

void fuzz_run(std::string_view bytes) {
    Choices choose(bytes);
    const Mesh mesh = small_mesh(choose);
    const Motions motions = random_motions(choose, mesh);
    const auto settings = random_settings(choose, mesh);
    const test::TemporaryFolder& folder = work_folder();
    const std::string mesh_path = folder.write("run.mesh", damaged(text_of_mesh(mesh), choose)),
                      output = folder.path("results");
    std::string deck = concat("mesh = run.mesh\noutput = ", output, "\nthreads = 1\nmax_seconds = 0.1\n");
    for (const auto& [boundary, motion] : motions) deck += concat("boundary ", boundary, " = ", motion.text, "\n");
    for (const auto& [key, value] : settings) deck += concat(key, " = ", value, "\n");
    std::filesystem::remove_all(output);
    const std::string deck_path = folder.write("run.deck", deck);
    try {
        test::Outcome outcome = outcome_of({deck_path});
        if (const std::string so_far = output + "/so-far.msh"; std::filesystem::exists(so_far)) {
            const std::string start = folder.write("start.msh", damaged(test::text_of(so_far), choose));
            outcome = outcome_of({deck_path, "start=" + start});
        }
        if (outcome.code == 0) check_result(mesh_path, output, motions, settings);
    } catch (const Violation& violation) {
        throw Violation(concat(violation.what(), "\n", deck));
    }
}

}  // namespace almesh::fuzz
