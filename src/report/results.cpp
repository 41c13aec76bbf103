#include "report/results.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/version.hpp"
#include "deck/deck_checks.hpp"
#include "deck/make_problem.hpp"
#include "report/iteration_table.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/infeasible.hpp"
#include "check/scaled_jacobian.hpp"
#include "io/mesh_format.hpp"
#include "io/patch.hpp"
#include "io/proof_file.hpp"

namespace almesh {
namespace {

std::vector<std::pair<std::string, std::string>> provenance(const Deck& deck, const Problem& problem) {
    return {{"program", version()}, {"commit", commit()}, {"deck", deck.name}, {"mesh_hash", problem.mesh_hash},
            {"run", problem.run_id}};
}

std::string title(const Deck& deck, const char* what) {
    return (deck.title.empty() ? deck.name : deck.title) + ", " + what;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& value : values) value *= factor;
    return values;
}

// value(i) of each of these nodes or elements.
template <class Value>
VtkArray numbers(const char* name, const std::vector<int>& items, const Value& value) {
    VtkArray array{name, 1, {}};
    for (const int i : items) array.value.push_back(static_cast<double>(value(i)));
    return array;
}

VtkFormat format_of(const Deck& deck) { return deck.vtk == VtkOutput::binary ? VtkFormat::binary : VtkFormat::ascii; }

// x, in the run's frame, and positions, in the file's, are the same points.
void write_volume(const Deck& deck, const Problem& problem, const char* what, const std::vector<double>& x,
                  std::vector<double> positions, const std::vector<double>& distortion,
                  const std::vector<double>* bound, std::vector<VtkArray> point_data = {}) {
    const Mesh& mesh = problem.mesh();
    std::vector<VtkArray> cell_data = {{"distortion", 1, distortion}};
    if (!deck.wall.empty())
        point_data.push_back({"wall_distance", 1,
                              scaled(wall_distance(mesh, x, mesh.boundaries_in(deck.wall)), problem.frame.length)});
    std::vector<int> elements(distortion.size());
    std::iota(elements.begin(), elements.end(), 0);
    cell_data.push_back(numbers("quality", elements, [&](int e) { return 1 / distortion[e]; }));
    cell_data.push_back({"scaled_jacobian", 1, corner_jacobians(mesh, x)});
    if (bound) cell_data.push_back({"certified_bound", 1, *bound});
    cell_data.push_back(numbers("element_id", elements, [&](int e) { return mesh.file.element_id[e]; }));
    write_vtk(deck.output + "/" + what + ".vtk",
              {title(deck, what), mesh.dim, mesh.degree, std::move(positions), mesh.elements, mesh.dim,
               std::move(point_data), std::move(cell_data), provenance(deck, problem), mesh.groups},
              format_of(deck));
}

// Boundary faces on the trace nodes, with the multipliers and the projected constraint.
void write_boundary(const Deck& deck, const Problem& problem, const Solution& solution,
                    const std::vector<double>& positions) {
    const Mesh& mesh = problem.mesh();
    const Constraint& constraint = *problem.level->constraint;
    const std::vector<double> multipliers = constraint.multiplier_field(solution.al.lambda);
    const int dim = mesh.dim, count = static_cast<int>(constraint.nodes().size());
    std::vector<int> trace(mesh.nodes(), -1), cells;
    std::vector<double> x, magnitude, boundary;
    for (int t = 0; t < count; ++t) {
        trace[constraint.nodes()[t]] = t;
        double squared = 0;
        for (int a = 0; a < dim; ++a) {
            x.push_back(positions[offset(constraint.nodes()[t], dim, a)]);
            squared += std::pow(multipliers[offset(t, dim, a)], 2);
        }
        magnitude.push_back(std::sqrt(squared));
    }
    for (int node : mesh.faces) cells.push_back(trace[node]);
    for (int b : mesh.face_boundary) boundary.push_back(b);
    const Units units = {dim, problem.frame.length};
    std::vector<VtkArray> point_data = {
        {"multipliers", dim, scaled(multipliers, units.multiplier(1))},
        {"multiplier_magnitude", 1, scaled(magnitude, units.multiplier(1))},
        {"constraint", dim, scaled(constraint.constraint_field(solution.x), units.constraint(1))}};
    std::vector<VtkArray> cell_data = {{"boundary", 1, std::move(boundary)}};
    if (const std::vector<char> flat = straight_faces(problem); std::find(flat.begin(), flat.end(), 1) != flat.end())
        cell_data.push_back({"flat", 1, {flat.begin(), flat.end()}});
    write_vtk(deck.output + "/boundary.vtk",
              {title(deck, "boundary"), dim, mesh.degree, std::move(x), std::move(cells), dim - 1,
               std::move(point_data), std::move(cell_data), provenance(deck, problem),
               mesh.groups_of_faces},
              format_of(deck));
}

// "iterate-0012" of "iterate-".
std::string numbered(const char* name, int number) {
    const std::string digits = std::to_string(number);
    return name + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

constexpr const char* end_of_series = "\n  ]\n}\n";

std::string row_of_series(const std::string& name, double time) {
    return concat("    {\"name\": \"", name, "\", \"time\": ", time, "}");
}

// The mesh in the formats of the key `final`, where that is its file's one in that text, and as VTK. Returns the first.
std::string write_mesh(const Deck& deck, const Problem& problem, const Solution& solution,
                       const std::vector<double>& positions, const std::string& name,
                       const std::vector<VtkArray>& point_data = {}) {
    const Mesh& mesh = problem.mesh();
    std::string first;
    for (const FileFormat& format : final_formats(deck.final_format, mesh)) {
        const std::string path = concat(deck.output, "/", name, ending_of_final(format));
        write_mesh_as(format, path, mesh, problem.mesh_text, positions);
        if (first.empty()) first = path;
    }
    if (deck.proof && solution.injectivity.certified) {
        std::vector<std::string> notes;
        const ProofFile proof = write_proof(read_as_it_is(first, notes), first, concat(deck.output, "/", name, ".proof"));
        if (!proof.is_written) std::fprintf(stderr, "note: %s: %s\n", first.c_str(), proof.told.c_str());
    }
    if (deck.vtk != VtkOutput::none)
        write_volume(deck, problem, name.c_str(), solution.x, positions, solution.al.distortion.element_max,
                     &solution.certificate.certified_bound, point_data);
    return first;
}

// The elements around the diagnosis, with the way from each node of the boundary to its target.
void write_stop(const Deck& deck, const Problem& problem, const Solution& solution,
                const std::vector<double>& positions) {
    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    const Constraint& constraint = *problem.level->constraint;
    const std::vector<double> targets = constraint.targets(solution.x);
    const std::vector<int> boundary = boundary_of_nodes(mesh, problem.target);
    const Restriction around = neighbourhood(mesh, solution.diagnosis);
    const std::vector<int>&nodes = around.node, &elements = around.element;
    std::vector<const CellType*> types;
    for (const int e : elements) types.push_back(&mesh.cell(e));
    VtkArray to_target{"to_target", dim, {}};
    for (const int i : nodes) {
        const auto trace = std::lower_bound(constraint.nodes().begin(), constraint.nodes().end(), i);
        const bool has_target = trace != constraint.nodes().end() && *trace == i;
        const auto t = static_cast<int>(trace - constraint.nodes().begin());
        for (int a = 0; a < dim; ++a)
            to_target.value.push_back(
                has_target ? problem.frame.length * (targets[offset(t, dim, a)] - point(solution.x, i, dim)[a]) : 0.0);
    }
    write_vtk(deck.output + "/stop.vtk",
              {title(deck, "stop"), dim, mesh.degree, at_nodes(nodes, positions, dim), around.elements, dim,
               {std::move(to_target),
                numbers("node_id", nodes, [&](int i) { return mesh.file.node_id[i]; }),
                numbers("boundary", nodes, [&](int i) { return boundary[i]; }),
                numbers("diagnosis", nodes, [&](int i) { return i == solution.diagnosis.node; })},
               {numbers("distortion", elements, [&](int e) { return solution.al.distortion.element_max[e]; }),
                {"scaled_jacobian", 1, at_nodes(elements, corner_jacobians(mesh, solution.x), 1)},
                numbers("certified_bound", elements, [&](int e) { return solution.certificate.certified_bound[e]; }),
                numbers("element_id", elements, [&](int e) { return mesh.file.element_id[e]; }),
                numbers("diagnosis", elements, [&](int e) { return e == solution.diagnosis.element; })},
               provenance(deck, problem), groups_of(types, mesh.degree)},
              format_of(deck));
}

}  // namespace

void write_mesh_as(const FileFormat& format, const std::string& path, const Mesh& mesh, const std::string& text,
                   const std::vector<double>& positions) {
    if (format == mesh.file.format && mesh.file.can_be_patched())
        write_file(path, patched(text, mesh.file.coordinates, positions));
    else if (format.ending == ".su2") write_su2(path, mesh, positions);
    else write_msh(path, mesh, positions);
}

void write_deck(const Deck& deck, const Problem& problem) {
    std::string text = concat("# ", version(), ", commit ", commit(), "\n# compiled by ", compiler(), "\n# threads ",
                              max_threads(), ", mesh hash ", problem.mesh_hash, ", run ", problem.run_id, "\n");
    for (const std::string& note : problem.notes) text += "# note: " + note + "\n";
    write_file(deck.output + "/deck.txt", text + "\n" + resolved(deck));
}

void write_initial(const Deck& deck, const Problem& problem) {
    if (deck.vtk == VtkOutput::none) return;
    const std::vector<double> undistorted(problem.mesh().element_count(), 1.0);
    write_volume(deck, problem, "initial", problem.ideal(), problem.frame.to_file(problem.ideal(), problem.mesh().dim),
                 undistorted, nullptr);
}

void write_iterate(const Deck& deck, const Problem& problem, int number, const std::vector<double>& x) {
    write_volume(deck, problem, numbered("iterate-", number).c_str(), x, problem.frame.to_file(x, problem.mesh().dim),
                 problem.level->energy->statistics(x).element_max, nullptr);
    std::vector<std::pair<std::string, double>> files;
    for (int k = 0; k <= number; ++k) files.emplace_back(numbered("iterate-", k) + ".vtk", k * deck.iterates);
    write_series(deck.output + "/iterates.vtk.series", files);
}

void write_series(const std::string& path, const std::vector<std::pair<std::string, double>>& files) {
    std::string rows;
    for (const auto& [name, time] : files) rows += (rows.empty() ? "" : ",\n") + row_of_series(name, time);
    write_file(path, concat("{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n", rows, end_of_series));
}

void append_to_series(const std::string& path, const std::string& name, double time) {
    append_to_file(path, ",\n" + row_of_series(name, time), end_of_series);
}

std::string frame_name(int number) { return numbered("frame-", number); }

std::string write_frame(const Deck& deck, const Problem& problem, const Solution& solution, const std::string& name,
                        const std::vector<VtkArray>& point_data) {
    return write_mesh(deck, problem, solution, final_positions(problem, solution.x), name, point_data);
}

void write_results(const Deck& deck, const Problem& problem, const Solution& solution) {
    const std::vector<double> positions = final_positions(problem, solution.x);
    write_mesh(deck, problem, solution, positions, "final");
    if (!solution.off_motion.moved.empty())
        write_file(deck.output + "/moved-nodes.csv", moved_nodes_csv(problem.mesh(), solution.off_motion.moved));
    if (deck.vtk == VtkOutput::none) return;
    write_boundary(deck, problem, solution, positions);
    if (solution.diagnosis.kind != DiagnosisKind::none) write_stop(deck, problem, solution, positions);
}

void write_summary(const Deck& deck, const Summary& summary) {
    std::string lines;
    for (const Field& quantity : summary) lines += quantity.name + " = " + quantity.text + "\n";
    write_file(deck.output + "/summary.txt", lines);
    write_file(deck.output + "/expectations.csv", expectations_csv(deck.expectations, summary));
}

void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate,
                       const std::string& folder, const std::vector<std::string>& why) {
    if (certificate.uncertified.empty()) return;
    const ElementList list = list_elements(mesh, certificate.uncertified, x, certificate.certified_bound, why);
    std::fprintf(out, "NOT certified valid: %s; the worst%s%s\n",
                 counts_of(certificate).c_str(), list.first.c_str(), write_invalid(list, folder).c_str());
}

}  // namespace almesh
