#include "app/results.hpp"

#include <sys/resource.h>

#include <cmath>

#include "app/version.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/wall_distance.hpp"
#include "io/msh_writer.hpp"
#include "io/vtk.hpp"

namespace almesh {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

double peak_memory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return static_cast<double>(usage.ru_maxrss) / (1024 * 1024);
#else
    return static_cast<double>(usage.ru_maxrss) / 1024;
#endif
}

std::string short_number(double value, int digits) {
    std::string text;
    append(text, value, digits);
    return text;
}

Pairs provenance(const Deck& deck, const Problem& problem) {
    return {{"program", version()}, {"commit", commit()}, {"deck", deck.name}, {"mesh_hash", problem.mesh_hash}};
}

std::string title(const Deck& deck, const char* what) {
    return (deck.title.empty() ? deck.name : deck.title) + ", " + what;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& value : values) value *= factor;
    return values;
}

VtkFormat format_of(const Deck& deck) { return deck.vtk == VtkOutput::binary ? VtkFormat::binary : VtkFormat::ascii; }

void write_volume(const Deck& deck, const Problem& problem, const char* what, const std::vector<double>& x,
                  const std::vector<double>& distortion, const std::vector<double>* scaled_jacobian) {
    const Mesh& mesh = problem.mesh;
    std::vector<VtkArray> point_data, cell_data = {{"distortion", 1, distortion}};
    if (!deck.wall.empty())
        point_data.push_back({"wall_distance", 1,
                              scaled(wall_distance(mesh, x, mesh.boundary_index(deck.wall)), problem.length)});
    std::vector<double> quality(distortion.size()), id(distortion.size());
    for (std::size_t e = 0; e < distortion.size(); ++e) {
        quality[e] = 1 / distortion[e];
        id[e] = static_cast<double>(mesh.element_id[e]);
    }
    cell_data.push_back({"quality", 1, std::move(quality)});
    if (scaled_jacobian) cell_data.push_back({"min_scaled_jacobian", 1, *scaled_jacobian});
    cell_data.push_back({"element_id", 1, std::move(id)});
    write_vtk(deck.output + "/" + what + ".vtk",
              {title(deck, what), mesh.dim, mesh.degree, scaled(x, problem.length), mesh.elements, mesh.dim,
               std::move(point_data), std::move(cell_data), provenance(deck, problem)},
              format_of(deck));
}

// Boundary faces on the trace nodes, with the multipliers and the projected constraint.
void write_boundary(const Deck& deck, const Problem& problem, const BoundaryConstraint& constraint,
                    const Solution& solution) {
    const Mesh& mesh = problem.mesh;
    const int dim = mesh.dim, count = static_cast<int>(constraint.nodes().size());
    std::vector<int> trace(mesh.nodes(), -1), cells;
    std::vector<double> x, magnitude, boundary;
    for (int t = 0; t < count; ++t) {
        trace[constraint.nodes()[t]] = t;
        double squared = 0;
        for (int a = 0; a < dim; ++a) {
            x.push_back(solution.x[static_cast<std::size_t>(constraint.nodes()[t]) * dim + a] * problem.length);
            squared += std::pow(solution.al.lambda[static_cast<std::size_t>(t) * dim + a], 2);
        }
        magnitude.push_back(std::sqrt(squared));
    }
    for (int node : mesh.faces) cells.push_back(trace[node]);
    for (int b : mesh.face_boundary) boundary.push_back(b);
    const double lambda_unit = std::pow(problem.length, 0.5 * dim);  // of energy / ((u, v) c), see constraint.hpp
    const double constraint_unit = std::pow(problem.length, 2 - 0.5 * dim);
    std::vector<VtkArray> point_data = {
        {"multipliers", dim, scaled(solution.al.lambda, lambda_unit)},
        {"multiplier_magnitude", 1, scaled(magnitude, lambda_unit)},
        {"constraint", dim, scaled(constraint.projected_constraint(solution.x), constraint_unit)}};
    write_vtk(deck.output + "/boundary.vtk",
              {title(deck, "boundary"), dim, mesh.degree, std::move(x), std::move(cells), dim - 1,
               std::move(point_data), {{"boundary", 1, std::move(boundary)}}, provenance(deck, problem)},
              format_of(deck));
}

std::string lines(const Pairs& pairs) {
    std::string text;
    for (const auto& [key, value] : pairs) text += key + " = " + value + "\n";
    return text;
}

}  // namespace

Summary summarise(const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh;
    const AlIteration& last = solution.al.iterations.back();
    const double length = problem.length;
    return {{"status", to_string(solution.al.status)},
            {"dimension", std::to_string(mesh.dim)},
            {"degree", std::to_string(mesh.degree)},
            {"nodes", std::to_string(mesh.nodes())},
            {"elements", std::to_string(mesh.element_count())},
            {"al_iterations", std::to_string(solution.al.iterations.size() - 1)},
            {"newton_iterations", std::to_string(solution.al.newton_iterations)},
            {"coarse_newton_iterations", std::to_string(solution.coarse_newton_iterations)},
            {"linear_iterations", std::to_string(solution.al.linear_iterations)},
            {"pocket_steps", std::to_string(solution.al.pocket_steps)},
            {"constraint_norm", short_number(last.constraint_norm * length, 6)},
            {"projected_constraint_norm", short_number(last.projected_constraint_norm * length, 6)},
            {"max_boundary_error", short_number(solution.max_boundary_error * length, 6)},
            {"gradient_norm", short_number(last.gradient_norm * std::pow(length, mesh.dim - 1), 6)},
            {"relative_quality", short_number(last.relative_quality, 7)},
            {"max_distortion", short_number(last.max_distortion, 7)},
            {"min_scaled_jacobian", short_number(solution.certificate.min_scaled_jacobian, 6)},
            {"certified_valid", solution.certificate.valid ? "yes" : "no"},
            {"time_run", short_number(solution.phases.run, 4)},
            {"time_setup", short_number(solution.phases.setup, 4)},
            {"time_coarse", short_number(solution.phases.coarse, 4)},
            {"time_certify", short_number(solution.phases.certify, 4)},
            {"time_write", short_number(solution.phases.write, 4)},
            {"time_total", short_number(solution.time.total, 4)},
            {"time_assembly", short_number(solution.time.assembly, 4)},
            {"time_linear", short_number(solution.time.linear, 4)},
            {"time_line_search", short_number(solution.time.line_search, 4)},
            {"time_pockets", short_number(solution.time.pockets, 4)},
            {"threads", std::to_string(max_threads())},
            {"peak_memory_mb", short_number(peak_memory_mb(), 4)}};
}

void write_deck(const Deck& deck, const Problem& problem) {
    std::string text = "# " + version() + ", commit " + commit() + "\n# compiled by " + compiler() + "\n# threads " +
                       std::to_string(max_threads()) + ", mesh hash " + problem.mesh_hash + "\n";
    for (const std::string& note : problem.notes) text += "# note: " + note + "\n";
    write_file(deck.output + "/deck.txt", text + "\n" + resolved(deck));
}

void write_initial(const Deck& deck, const Problem& problem) {
    if (deck.vtk == VtkOutput::none) return;
    const std::vector<double> undistorted(problem.mesh.element_count(), 1.0);
    write_volume(deck, problem, "initial", problem.ideal, undistorted, nullptr);
}

void write_results(const Deck& deck, const Problem& problem, const BoundaryConstraint& constraint,
                   const Solution& solution) {
    write_msh(deck.output + "/final.msh", problem.mesh, scaled(solution.x, problem.length));
    if (deck.vtk == VtkOutput::none) return;
    write_volume(deck, problem, "final", solution.x, solution.al.distortion.element_max,
                 &solution.certificate.lower_bound);
    write_boundary(deck, problem, constraint, solution);
}

void write_summary(const Deck& deck, const Summary& summary) {
    write_file(deck.output + "/summary.txt", lines(summary));
}

}  // namespace almesh
