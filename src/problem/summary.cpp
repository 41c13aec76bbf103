#include "problem/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "problem/problem.hpp"
#include "problem/solution.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/physical_memory.hpp"
#include "base/table.hpp"
#include "check/scaled_jacobian.hpp"

namespace almesh {
namespace {

// A finished run, as the rows of the table see it.
struct Run {
    const Mesh& mesh;
    const Solution& solution;
    const AlResult& al;
    const RunTimes& time;
    AlIteration last;  // in units of the mesh file
    const Diagnosis& at;
    const Problem& problem;
    Units units;
};

using R = const Run&;

constexpr const char* none = "none";

template <int axis>
std::string coordinate(const Run& run) {
    return run.at.kind == DiagnosisKind::none ? none : to_text(run.problem.frame.to_file(run.at.position)[axis], 6);
}

template <auto distance>
std::string largest(const Run& run) {
    double value = 0;
    for (const BoundaryDistance& of : run.solution.distances) value = std::max(value, of.*distance);
    return to_text(value, 6);
}

struct Quantity : Named {
    std::string (*value)(R);
};

constexpr auto quantities = std::to_array<Quantity>({
    {{"status", "converged, or why the method ended"}, [](R r) { return concat(outcome(r.al)); }},
    {{"run", "id in all files of the run; the same settings and files give the same id"},
     [](R r) { return r.problem.run_id; }},
    {{"dimension", "2 or 3", "count"}, [](R r) { return concat(r.mesh.dim); }},
    {{"degree", "polynomial degree of the elements", "count"}, [](R r) { return concat(r.mesh.degree); }},
    {{"nodes", "nodes of the mesh, after refinement and degree raising", "count"},
     [](R r) { return concat(r.mesh.nodes()); }},
    {{"elements", "elements, of all types", "count"}, [](R r) { return concat(r.mesh.element_count()); }},
    {{"al_iterations", "augmented Lagrangian iterations; 1 with a method that sets the boundary", "count"},
     [](R r) { return concat(r.al.iterations.size() - 1); }},
    {{"newton_iterations", "Newton steps of all minimisations", "count"},
     [](R r) { return concat(r.al.newton_iterations); }},
    {{"earlier_newton_iterations",
      "Newton steps in earlier load increments, with earlier powers, and in other parts of a curved mesh or attempts "
      "to improve one; not among newton_iterations", "count"},
     [](R r) { return concat(r.al.earlier_newton_iterations); }},
    {{"coarse_newton_iterations", "Newton steps on coarser meshes, not among newton_iterations", "count"},
     [](R r) { return concat(r.solution.coarse_newton_iterations); }},
    {{"linear_iterations", "iterations of cg or gmres in all Newton steps", "count"},
     [](R r) { return concat(r.al.linear_iterations); }},
    {{"local_steps", "Newton steps of local eliminations, each over a few nodes", "count"},
     [](R r) { return concat(r.al.local_steps); }},
    {{"constraint_norm", "|c_D|, distance of the boundary from its target (Eq. 6)", "length"},
     [](R r) { return to_text(r.last.constraint_norm, 6); }},
    {{"projected_constraint_norm", "|P c_D|, the part of c_D in the trace space, on which convergence is judged",
     "length"}, [](R r) { return to_text(r.last.projected_constraint_norm, 6); }},
    {{"max_boundary_error", "largest distance of a boundary point from its target", "length"},
     [](R r) { return to_text(r.units.distance(r.solution.max_boundary_error), 6); }},
    {{"relative_boundary_error", "largest distance of a boundary node from its target, in heights of the cells at it",
     "1"}, [](R r) { return to_text(r.last.relative_boundary_error, 6); }},
    {{"nodes_off_target",
      "boundary nodes that are not at their targets to the last bit, or not on the surface along which they slide",
     "count"}, [](R r) { return concat(r.solution.nodes_off_target); }},
    {{"nodes_off_motion",
      "boundary nodes that are not where the motions of the deck take them to the last bit, fixed ones not where the "
      "mesh file has them, for whatever reason: target = least_squares, a surface that had to give way, ...", "count"},
     [](R r) { return concat(r.solution.off_motion.nodes); }},
    {{"off_motion", "largest distance of one of the nodes_off_motion from there", "length"},
     [](R r) { return to_text(r.solution.off_motion.largest, 6); }},
    {{"gradient_norm", "|grad E| at the end; none where it is beyond the range of numbers", "length^(n - 1)"},
     [](R r) { return std::isfinite(r.last.gradient_norm) ? to_text(r.last.gradient_norm, 6) : none; }},
    {{"relative_quality", "q, the L2 norm of 1 divided by that of eta; 1: undistorted", "1"},
     [](R r) { return to_text(r.last.relative_quality, 7); }},
    {{"max_distortion", "largest eta over all quadrature points", "1"},
     [](R r) { return to_text(r.last.max_distortion, 7); }},
    {{"size_skew_mean",
      "mean over the elements of the size-skew metric of de Boer and others (2007); 1: an element with its ideal "
      "size and shape", "1"},
     [](R r) { return to_text(r.solution.size_skew.mean, 6); }},
    {{"size_skew_min", "least size-skew metric of an element; 0: an element is inverted", "1"},
     [](R r) { return to_text(r.solution.size_skew.min, 6); }},
    {{"power", "exponent of eta or eta - 1 in the objective at the end", "count"},
     [](R r) { return concat(r.problem.level->energy->power().p); }},
    {{"freed_nodes", "boundary nodes that slide along the surface because no valid mesh has the target there", "count"},
     [](R r) { return concat(r.solution.freed_nodes); }},
    {{"largest_slide", "largest distance of one of the freed_nodes from its target", "length"},
     [](R r) { return to_text(r.solution.off_motion.largest_slide, 6); }},
    {{"surface_distance", "largest distance between a face whose nodes slide and the surface", "length"},
     [](R r) { return to_text(r.units.distance(r.solution.surface_distance), 6); }},
    {{"straight_faces", "faces of the target that were made flat, or flatter than they came", "count"},
     [](R r) { return concat(r.solution.straight_faces); }},
    {{"boundary_distance",
      "largest distance of a face from where the target had the boundary before nodes slid or faces were made flat",
     "length"}, largest<&BoundaryDistance::largest>},
    {{"relative_boundary_distance", "the same distance in units of the longest edge of the face", "1"},
     largest<&BoundaryDistance::relative_largest>},
    {{"split_elements", "elements of the file that the target inverts and nodes inside divide, with split = auto",
     "count"}, [](R r) { return concat(r.problem.split_elements); }},
    {{"periodic_pairs", "pairs of nodes on periodic sides that move as one", "count"},
     [](R r) { return concat(r.problem.pairs.count()); }},
    {{"periodic_mismatch", "largest distance of a node from the image of the other one of its pair", "length"},
     [](R r) { return to_text(r.problem.pairs.mismatch(final_positions(r.problem, r.solution.x)), 6); }},
    {{"refined_elements", "curved elements that were nearly inverted and got a finer quadrature", "count"},
     [](R r) { return concat(r.solution.refined_elements); }},
    {{"scaled_jacobian", "least scaled Jacobian at a corner, where elements are curved of the straight cells", "1"},
     [](R r) { return rounded_down(least_corner_jacobian(r.mesh, final_positions(r.problem, r.solution.x)), 6); }},
    {{"certified_bound", "lower bound of det J over that of the straight element, everywhere in all elements", "1"},
     [](R r) { return rounded_down(r.solution.certificate.min_certified_bound, 6); }},
    {{"invalid_elements", "elements that are not certified valid; inverted ones are counted too", "count"},
     [](R r) { return concat(r.solution.certificate.uncertified.size()); }},
    {{"certified_valid", "yes: det J > 0 is proved everywhere in every element; else no"},
     [](R r) { return concat(r.solution.certificate.valid ? "yes" : "no"); }},
    {{"certified_injective", "yes: it is also proved that no two elements overlap, but for contact_overlap; else no"},
     [](R r) { return concat(r.solution.injectivity.certified ? "yes" : "no"); }},
    {{"contact_overlap", "largest distance, at points of their faces, by which boundaries of the key contact overlap",
     "length"}, [](R r) { return to_text(r.units.distance(r.solution.injectivity.overlap), 6); }},
    {{"diagnosis",
      "why a run did not converge or is not certified: off_target, unbalanced, distorted, invalid or overlap "
      "(outputs/README.md); none, like the next six, after any other run"},
     [](R r) { return concat(r.at.kind); }},
    {{"diagnosis_boundary", "boundary of that node or element, or the one nearest to it"},
     [](R r) { return r.at.boundary < 0 ? std::string(none) : r.mesh.boundaries[r.at.boundary]; }},
    {{"diagnosis_node", "id of the node; none where the cause is an element", "count"},
     [](R r) { return r.at.node < 0 ? std::string(none) : concat(r.mesh.file.node_id[r.at.node]); }},
    {{"diagnosis_element", "id of the element; with a node, of the most distorted element at it", "count"},
     [](R r) { return r.at.element < 0 ? std::string(none) : concat(r.mesh.file.element_id[r.at.element]); }},
    {{"diagnosis_x", "first coordinate of the node, or of the element's centre", "length"}, coordinate<0>},
    {{"diagnosis_y", "second coordinate", "length"}, coordinate<1>},
    {{"diagnosis_z", "third coordinate; 0 in 2D", "length"}, coordinate<2>},
    {{"time_run", "seconds of the whole run", "s"}, [](R r) { return to_text(r.time.run, 4); }},
    {{"time_setup", "seconds for the mesh, the target and its checks, the pattern and ordering of the matrix", "s"},
     [](R r) { return to_text(r.time.setup, 4); }},
    {{"time_coarse", "iterations on coarser meshes, a part of time_total", "s"},
     [](R r) { return to_text(r.time.coarse, 4); }},
    {{"time_certify", "certificate and largest boundary error", "s"}, [](R r) { return to_text(r.time.certify, 4); }},
    {{"time_write", "writing of the mesh and VTK files", "s"}, [](R r) { return to_text(r.time.write, 4); }},
    {{"time_total", "iterations on all meshes; the next four are parts of it", "s"},
     [](R r) { return to_text(r.time.total, 4); }},
    {{"time_assembly", "gradients and Hessians", "s"}, [](R r) { return to_text(r.time.assembly, 4); }},
    {{"time_linear", "linear solves", "s"}, [](R r) { return to_text(r.time.linear, 4); }},
    {{"time_line_search", "energies in line searches", "s"}, [](R r) { return to_text(r.time.line_search, 4); }},
    {{"time_elimination", "local eliminations", "s"}, [](R r) { return to_text(r.time.elimination, 4); }},
    {{"threads", "threads of the run", "count"}, [](R) { return concat(max_threads()); }},
    {{"predicted_memory_mb", "memory that the run was expected to need, before it began, MB", "MB"},
     [](R r) { return to_text(r.solution.predicted_bytes / 1e6, 4); }},
    {{"peak_memory_mb", "largest memory of the process, MB", "MB"},
     [](R) { return to_text(peak_memory() / (1024 * 1024), 4); }},
});

const Quantity& find_quantity(std::string_view name) {
    if (const Quantity* const quantity = find_row(quantities, name)) return *quantity;
    throw UsageError("the summary has no quantity ", in_backquotes(name), did_you_mean(name, names_of(quantities)));
}

template <class... Parts>
[[noreturn]] void refuse(const Parts&... why) {
    throw UsageError(why..., ": expected `expect QUANTITY OP VALUE [+- TOLERANCE]`, OP being <=, >= or =");
}

// That its parts go together.
void check_parts(const Expectation& expectation, std::string_view unit) {
    const bool equal = expectation.relation == "=", tolerant = expectation.tolerance > 0;
    const std::string quantity = in_backquotes(expectation.quantity), &value = expectation.value;
    if (words(value).size() != 1) refuse("one value is needed");
    if (unit.empty() && (!equal || tolerant)) throw UsageError(quantity, " is a word: compare it with = alone");
    if (unit.empty()) return;
    if (!parse_double(value)) throw UsageError(in_backquotes(value), " is not a number, but ", quantity, " is one");
    if (!equal && tolerant) refuse("+- goes with = only");
    if (equal && !tolerant && unit != "count")
        throw UsageError(quantity, " is a decimal number: add a tolerance, `= ", value, " +- TOLERANCE`");
}

bool holds(const Expectation& expectation, const std::string& got) {
    const auto expected_number = parse_double(expectation.value), got_number = parse_double(got);
    if (!*find_quantity(expectation.quantity).unit) return got == expectation.value;
    if (!expected_number || !got_number) return false;
    const double difference = *got_number - *expected_number;
    if (expectation.relation == "<=") return difference <= 0;
    if (expectation.relation == ">=") return difference >= 0;
    // A value exactly a tolerance away in decimals holds: 0.9370 = 0.9365 +- 0.0005.
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(*expected_number);
    return std::abs(difference) <= expectation.tolerance + rounding;
}

// "= 0.9365 +- 0.0005"
std::string condition_text(const Expectation& expectation) {
    const std::string text = expectation.relation + " " + expectation.value;
    return expectation.tolerance > 0 ? text + " +- " + to_text(expectation.tolerance) : text;
}

}  // namespace

AlIteration Units::of(AlIteration row) const {
    row.constraint_norm = distance(row.constraint_norm);
    row.projected_constraint_norm = distance(row.projected_constraint_norm);
    row.energy = energy(row.energy);
    row.gradient_norm = gradient(row.gradient_norm);
    row.mu = penalty(row.mu);
    row.omega = gradient(row.omega);
    row.epsilon = distance(distance(row.epsilon));  // of a squared norm
    return row;
}

NewtonStep Units::of(NewtonStep step) const {
    step.energy = energy(step.energy);
    step.gradient_norm = gradient(step.gradient_norm);
    return step;
}

Summary summarise(const Problem& problem, const Solution& solution) {
    const Units units = {problem.mesh().dim, problem.frame.length};
    const Run run = {problem.mesh(), solution, solution.al, solution.time, units.of(solution.al.iterations.back()),
                     solution.diagnosis, problem, units};
    Summary summary;
    for (const Quantity& of : quantities) summary.emplace_back(of, of.value(run));
    return summary;
}

std::vector<Named> summary_quantities() { return {quantities.begin(), quantities.end()}; }

Expectation parse_expectation(std::string_view text) {
    constexpr const char* relation_symbols = "<>=";
    const auto relation = text.find_first_of(relation_symbols);
    if (relation == std::string_view::npos) refuse("no comparison in ", in_backquotes(text));
    const auto value = std::min(text.find_first_not_of(relation_symbols, relation), text.size());
    const auto plus_minus = std::min(text.find("+-", value), text.size());
    Expectation expectation;
    expectation.quantity = trim(text.substr(0, relation));
    expectation.relation = text.substr(relation, value - relation);
    expectation.value = trim(text.substr(value, plus_minus - value));
    const Quantity& quantity = find_quantity(expectation.quantity);
    if (expectation.relation != "<=" && expectation.relation != ">=" && expectation.relation != "=")
        refuse(in_backquotes(expectation.relation), " is no comparison");
    if (plus_minus < text.size()) {
        expectation.tolerance = parse_double(trim(text.substr(plus_minus + 2))).value_or(0);
        if (expectation.tolerance <= 0) refuse("+- needs a number > 0");
    }
    check_parts(expectation, quantity.unit);
    return expectation;
}

std::string to_string(const Expectation& expectation) {
    return expectation.quantity + " " + condition_text(expectation);
}

ExpectationResult check(const Expectation& expectation, const Summary& summary) {
    const auto* const entry = find_row(summary, expectation.quantity);
    ExpectationResult result;
    result.got = entry ? entry->text : "nothing";
    result.holds = entry && holds(expectation, entry->text);
    result.text = "expected " + to_string(expectation) + ", got " + result.got + (result.holds ? ": holds" : ": fails");
    return result;
}

std::string expectations_csv(const std::vector<Expectation>& expectations, const Summary& summary) {
    std::string text = "quantity,expected,got,holds,run\n";
    const auto* const run = find_row(summary, "run");
    for (const Expectation& expectation : expectations) {
        const ExpectationResult result = check(expectation, summary);
        text += expectation.quantity + "," + condition_text(expectation) + "," + result.got + "," +
                (result.holds ? "yes," : "no,") + (run ? run->text : "") + "\n";
    }
    return text;
}

}  // namespace almesh
