#include "app/summary.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/problem.hpp"
#include "app/results.hpp"
#include "app/units.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

// A finished run, as the rows of the table see it.
struct Run {
    const Mesh& mesh;
    const Solution& solution;
    const AlResult& al;
    const AlIteration& last;
    const PhaseTimes& phases;
    const Timings& time;
    Units units;
};

double peak_memory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return static_cast<double>(usage.ru_maxrss) / (1024 * 1024);
#else
    return static_cast<double>(usage.ru_maxrss) / 1024;
#endif
}

std::string text(const char* word) { return word; }
std::string text(long long count) { return std::to_string(count); }
std::string text(double value, int digits) {
    std::string shown;
    append(shown, value, digits);
    return shown;
}

enum class Kind { word, count, decimal };

struct Quantity {
    const char* name;
    Kind kind;
    const char* meaning;
    std::string (*value)(const Run&);
};

using enum Kind;
using R = const Run&;

constexpr auto quantities = std::to_array<Quantity>({
    {"status", word, "converged, or why the method ended", [](R r) { return text(to_string(r.al.status)); }},
    {"dimension", count, "2 or 3", [](R r) { return text(r.mesh.dim); }},
    {"degree", count, "polynomial degree of the elements", [](R r) { return text(r.mesh.degree); }},
    {"nodes", count, "nodes of the mesh, after refinement and degree raising",
     [](R r) { return text(r.mesh.nodes()); }},
    {"elements", count, "triangles or tetrahedra", [](R r) { return text(r.mesh.element_count()); }},
    {"al_iterations", count, "augmented Lagrangian iterations",
     [](R r) { return text(static_cast<long long>(r.al.iterations.size()) - 1); }},
    {"newton_iterations", count, "Newton steps of all subproblems", [](R r) { return text(r.al.newton_iterations); }},
    {"coarse_newton_iterations", count, "Newton steps on coarser meshes, not among newton_iterations",
     [](R r) { return text(r.solution.coarse_newton_iterations); }},
    {"linear_iterations", count, "iterations of cg or gmres in all Newton steps",
     [](R r) { return text(r.al.linear_iterations); }},
    {"local_steps", count, "Newton steps of local eliminations, over a few nodes",
     [](R r) { return text(r.al.local_steps); }},
    {"constraint_norm", decimal, "|c_D|, distance of the boundary from its target (Eq. 6)",
     [](R r) { return text(r.units.distance(r.last.constraint_norm), 6); }},
    {"projected_constraint_norm", decimal, "|P c_D|, its part in the trace space, on which convergence is judged",
     [](R r) { return text(r.units.distance(r.last.projected_constraint_norm), 6); }},
    {"max_boundary_error", decimal, "largest distance of a boundary point from its target",
     [](R r) { return text(r.units.distance(r.solution.max_boundary_error), 6); }},
    {"gradient_norm", decimal, "|grad E| at the end",
     [](R r) { return text(r.units.gradient(r.last.gradient_norm), 6); }},
    {"relative_quality", decimal, "q, L2 norm of 1 over that of eta; 1 is undistorted",
     [](R r) { return text(r.last.relative_quality, 7); }},
    {"max_distortion", decimal, "largest eta over all quadrature points",
     [](R r) { return text(r.last.max_distortion, 7); }},
    {"min_scaled_jacobian", decimal, "lower bound of the scaled Jacobian over all elements, everywhere in them",
     [](R r) { return text(r.solution.certificate.min_scaled_jacobian, 6); }},
    {"certified_valid", word, "yes where det J > 0 is proved in every element, else no",
     [](R r) { return text(r.solution.certificate.valid ? "yes" : "no"); }},
    {"time_run", decimal, "seconds of the whole run", [](R r) { return text(r.phases.run, 4); }},
    {"time_setup", decimal, "mesh, target and its checks, pattern and ordering of the matrix",
     [](R r) { return text(r.phases.setup, 4); }},
    {"time_coarse", decimal, "coarser meshes, part of time_total", [](R r) { return text(r.phases.coarse, 4); }},
    {"time_certify", decimal, "certificate and largest boundary error", [](R r) { return text(r.phases.certify, 4); }},
    {"time_write", decimal, "mesh and VTK files", [](R r) { return text(r.phases.write, 4); }},
    {"time_total", decimal, "iterations on all meshes; the next four are parts of it",
     [](R r) { return text(r.time.total, 4); }},
    {"time_assembly", decimal, "gradients and Hessians", [](R r) { return text(r.time.assembly, 4); }},
    {"time_linear", decimal, "linear solves", [](R r) { return text(r.time.linear, 4); }},
    {"time_line_search", decimal, "energies in line searches", [](R r) { return text(r.time.line_search, 4); }},
    {"time_elimination", decimal, "local eliminations", [](R r) { return text(r.time.elimination, 4); }},
    {"threads", count, "threads of the run", [](R) { return text(max_threads()); }},
    {"peak_memory_mb", decimal, "largest memory of the process, MB", [](R) { return text(peak_memory_mb(), 4); }},
});

const Quantity& find_quantity(const std::string& name) {
    for (const Quantity& quantity : quantities)
        if (name == quantity.name) return quantity;
    throw UsageError("the summary has no quantity " + in_backquotes(name) + did_you_mean(name, summary_quantities()));
}

std::string with_form(const std::string& why) {
    return why + ": expected `expect QUANTITY OP VALUE [+- TOLERANCE]`, OP being <=, >= or =";
}

void check_meaning(const Expectation& expectation) {
    const Kind kind = find_quantity(expectation.quantity).kind;
    const bool equal = expectation.relation == "=";
    const std::string quantity = in_backquotes(expectation.quantity);
    if (words(expectation.value).size() != 1) throw UsageError(with_form("one value is needed"));
    if (kind == word) {
        if (!equal || expectation.tolerance > 0) throw UsageError(quantity + " is a word: compare it with = alone");
        return;
    }
    if (!parse_double(expectation.value))
        throw UsageError(in_backquotes(expectation.value) + " is not a number, but " + quantity + " is one");
    if (!equal && expectation.tolerance > 0) throw UsageError(with_form("+- goes with = only"));
    if (equal && kind == decimal && expectation.tolerance == 0)
        throw UsageError(quantity + " is a decimal number: add a tolerance, `= " + expectation.value +
                         " +- TOLERANCE`");
}

bool compare(const Expectation& expectation, const std::string& got) {
    if (find_quantity(expectation.quantity).kind == word) return got == expectation.value;
    const auto expected_number = parse_double(expectation.value), got_number = parse_double(got);
    if (!expected_number || !got_number) return false;
    const double difference = *got_number - *expected_number;
    if (expectation.relation == "<=") return difference <= 0;
    if (expectation.relation == ">=") return difference >= 0;
    // A value exactly a tolerance away in decimals holds: 0.9370 = 0.9365 +- 0.0005.
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(*expected_number);
    return std::abs(difference) <= expectation.tolerance + (expectation.tolerance > 0 ? rounding : 0);
}

// "= 0.9365 +- 0.0005"
std::string condition_text(const Expectation& expectation) {
    const std::string text = expectation.relation + " " + expectation.value;
    return expectation.tolerance > 0 ? text + " +- " + to_text(expectation.tolerance) : text;
}

}  // namespace

Summary summarise(const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const Run run = {mesh, solution, solution.al, solution.al.iterations.back(), solution.phases, solution.time,
                     {mesh.dim, problem.length}};
    Summary summary;
    for (const Quantity& quantity : quantities) summary.emplace_back(quantity.name, quantity.value(run));
    return summary;
}

std::vector<std::string> summary_quantities() {
    std::vector<std::string> names;
    for (const Quantity& quantity : quantities) names.push_back(quantity.name);
    return names;
}

std::string quantities_table() {
    std::string table;
    for (const Quantity& quantity : quantities) table += table_row({quantity.name, quantity.meaning}, {27, 73});
    return table;
}

Expectation parse_expectation(std::string_view text) {
    const auto symbol = text.find_first_of("<>=");
    if (symbol == std::string_view::npos) throw UsageError(with_form("no comparison in " + in_backquotes(text)));
    Expectation expectation;
    expectation.quantity = trim(text.substr(0, symbol));
    find_quantity(expectation.quantity);
    text.remove_prefix(symbol);
    expectation.relation = text.substr(0, text.find_first_not_of("<>="));
    text.remove_prefix(expectation.relation.size());
    if (expectation.relation != "<=" && expectation.relation != ">=" && expectation.relation != "=")
        throw UsageError(with_form(in_backquotes(expectation.relation) + " is no comparison"));
    const auto plus_minus = text.find("+-");
    expectation.value = trim(text.substr(0, plus_minus));
    if (plus_minus != std::string_view::npos) {
        const auto tolerance = parse_double(trim(text.substr(plus_minus + 2)));
        if (!tolerance || *tolerance <= 0) throw UsageError(with_form("+- needs a number > 0"));
        expectation.tolerance = *tolerance;
    }
    check_meaning(expectation);
    return expectation;
}

std::string to_string(const Expectation& expectation) {
    return expectation.quantity + " " + condition_text(expectation);
}

ExpectationResult check(const Expectation& expectation, const Summary& summary) {
    const auto it = std::find_if(summary.begin(), summary.end(),
                                 [&](const auto& entry) { return entry.first == expectation.quantity; });
    ExpectationResult result;
    result.got = it == summary.end() ? "nothing" : it->second;
    result.holds = it != summary.end() && compare(expectation, result.got);
    result.text =
        "expected " + to_string(expectation) + ", got " + result.got + (result.holds ? ": holds" : ": fails");
    return result;
}

std::string expectations_csv(const std::vector<Expectation>& expectations, const Summary& summary) {
    std::string text = "quantity,expected,got,holds\n";
    for (const Expectation& expectation : expectations) {
        const ExpectationResult result = check(expectation, summary);
        text += expectation.quantity + "," + condition_text(expectation) + "," + result.got + "," +
                (result.holds ? "yes" : "no") + "\n";
    }
    return text;
}

}  // namespace almesh
