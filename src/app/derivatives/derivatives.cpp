// dJ/dg and dJ/da of the mesh that a run ends with, or dx by dg and da; a: the deck's constants, through the target,
//
//     dr/da = (45 (r_1 - r_-1) - 9 (r_2 - r_-2) + r_3 - r_-3) / (60 h),   r_k = r(x; a + k h),
//
// of the sixth order: its error is about 1e-12, and no more than 1e-9, or it is refused, by how far it is from that of
// the fourth order (r_3 - 6 r_2 + 18 r_1 - 10 r_0 - 3 r_-1) / (12 h), which kinks do not escape.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <unordered_map>

#include "app/commands.hpp"
#include "deck/make_problem.hpp"
#include "problem/node_targets.hpp"
#include "report/results.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/table.hpp"
#include "linalg/vector_ops.hpp"
#include "method/derivative.hpp"

namespace almesh {
namespace {

using Values = std::vector<double>;  // nodes x dim

// Of the mesh, or of its boundaries.
std::vector<char> chosen_nodes(const Mesh& mesh, bool all) {
    std::vector<char> chosen(mesh.nodes(), all);
    for (const int node : mesh.faces) chosen[node] = 1;
    return chosen;
}

// A row for each node of the mesh, or of its boundaries.
Values read_values(const Mesh& mesh, const std::string& path, bool all) {
    const std::vector<char> chosen = chosen_nodes(mesh, all);
    std::unordered_map<long long, int> nodes;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (chosen[i]) nodes[mesh.file.node_id[i]] = i;
    Values values(mesh.x.size(), 0.0);
    std::vector<char> known;
    read_node_rows(mesh, path, nodes, all ? "in the mesh" : "on a boundary", values, known);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (chosen[i] && !known[i])
            throw InputError(path, ": node ", mesh.file.node_id[i], " has no row: each node ",
                             all ? "of the mesh" : "of a boundary", " needs one, if only of zeros");
    return values;
}

void write_values(const std::string& path, const Mesh& mesh, const Values& values, bool all) {
    const std::vector<char> chosen = chosen_nodes(mesh, all);
    std::string text = mesh.dim == 2 ? "node,x,y\n" : "node,x,y,z\n";
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (!chosen[i]) continue;
        Fields row = {mesh.file.node_id[i]};
        row.insert(row.end(), point(values, i, mesh.dim), point(values, i, mesh.dim) + mesh.dim);
        text += csv_row(row);
    }
    write_file(path, text);
}

// r and D'f of the target with another value of the constant.
BoundaryChange residual_at(const Deck& deck, const Problem& problem, const Derivative& derivative,
                           const std::string& constant, double value) {
    const std::string setting = concat("let ", constant, "=", value);
    Deck at = deck;
    at.boundaries = parse_deck(resolved(deck), deck.output + "/deck.txt", {setting}).boundaries;
    Problem other = make_problem(at);
    if (other.target.kind != problem.target.kind || straight_faces(other) != straight_faces(problem))
        throw InputError("other nodes are freed, or other faces made straight, at ", setting);
    set_constraint(at, other);
    return derivative.residual(*other.level->constraint);
}

// Of the boundary by the constant. Steps h: of its value, or of a hundredth where that is less, of 1 or of the mesh.
BoundaryChange change_by(const Deck& deck, const Problem& problem, const Derivative& derivative,
                         const Constant& constant) {
    using Weights = std::array<double, 7>;
    constexpr double accuracy = 1e-9, steps[] = {1e-2, 1e-3, 1e-4};
    std::string why = "the target, or a surface along which nodes slide, is not smooth there";
    for (const double unit : {1.0, problem.frame.length}) for (const double step : steps) try {
            const double h = step * std::max(std::abs(constant.value), 1e-2 * unit);
            const Values zero(problem.mesh().x.size(), 0.0);
            BoundaryChange slope{zero, zero};
            Values error = zero;  // slope less that of the fourth order
            for (int k = -3; k <= 3; ++k) {
                const BoundaryChange at =
                    k == 0 ? derivative.residual(*problem.level->constraint)
                           : residual_at(deck, problem, derivative, constant.name, constant.value + k * h);
                const double sixth = Weights{-1, 9, -45, 0, 45, -9, 1}[k + 3] / (60 * h);
                axpy(sixth, at.shift, slope.shift);
                axpy(sixth, at.force, slope.force);
                axpy(Weights{-1, 9, -30, 50, -45, 21, -4}[k + 3] / (60 * h), at.shift, error);
            }
            if (norm_inf(error) <= accuracy * norm_inf(slope.shift)) return derivative.change(slope);
        } catch (const Error& refused) {
            why = refused.what();
        }
    throw Error(ExitCode::not_converged, concat("no derivative by ", constant.name, ": ", why));
}

// The values of a file divided by `unit`, a power of two near the largest, so that no product of them overflows.
struct Column {
    std::string name;
    Values values;
    double unit = 1;

    Column(std::string of_file, Values in_file) : name(std::move(of_file)), values(std::move(in_file)) {
        if (const double largest = norm_inf(values); largest > 0) unit = std::ldexp(1.0, std::ilogb(largest));
        for (double& v : values) v /= unit;
    }
};

// The derivative `what` in this unit.
double times_unit(double derivative, double unit, const std::string& what) {
    if (std::isfinite(derivative * unit)) return derivative * unit;
    throw Error(ExitCode::not_converged, concat("the derivative ", what, " is beyond the largest number, ",
                                                rounded_down(std::numeric_limits<double>::max(), 3)));
}

Values times_unit(Values derivative, double unit, const std::string& what) {
    for (double& v : derivative) v = times_unit(v, unit, what);
    return derivative;
}

// Returns what the terminal is told.
std::string write_adjoint(const Output& out, const Deck& deck, const Problem& problem, Derivative& derivative,
                          const std::vector<Column>& functions) {
    std::vector<BoundaryChange> slopes;
    std::string told;
    Fields heading = {"constant", "value"}, found;
    for (const Column& J : functions) {
        slopes.push_back(derivative.adjoint(J.values));
        write_values(deck.output + "/adjoint-" + J.name + ".csv", problem.mesh(),
                     times_unit(slopes.back().shift, J.unit, concat("of ", J.name, " by positions")), false);
        heading.emplace_back(J.name);
    }
    std::string table = csv_row(heading);
    for (const Constant& constant : deck.constants) {
        const BoundaryChange change = change_by(deck, problem, derivative, constant);
        Fields row = {constant.name, constant.value};
        for (std::size_t j = 0; j < functions.size(); ++j) {
            const double by_target = dot(slopes[j].shift, change.shift) + dot(slopes[j].force, change.force);
            const double slope = times_unit(problem.frame.length * by_target, functions[j].unit,
                                            concat("of ", functions[j].name, " by ", constant.name));
            row.emplace_back(slope);
            found.push_back(json({{"function", functions[j].name}, {"constant", constant.name}, {"slope", slope}}));
            told += concat("d ", functions[j].name, " / d ", constant.name, " = ", slope, "\n");
        }
        table += csv_row(row);
    }
    if (!deck.constants.empty()) write_file(deck.output + "/adjoint-constants.csv", table);
    out.add({{"derivatives", json(found)}});
    return told;
}

void write_tangent(const Deck& deck, const Problem& problem, Derivative& derivative,
                   const std::vector<Column>& velocities) {
    const auto write = [&](const std::string& name, const BoundaryChange& change, double unit) {
        const Values dx = times_unit(derivative.tangent(change), unit, concat("of the mesh by ", name));
        write_values(deck.output + "/tangent-" + name + ".csv", problem.mesh(), dx, true);
    };
    for (const Column& g : velocities) write(g.name, {g.values, Values(g.values.size(), 0.0)}, g.unit);
    for (const Constant& constant : deck.constants)
        write(constant.name, change_by(deck, problem, derivative, constant), problem.frame.length);
}

}  // namespace

ExitCode differentiate(const std::vector<std::string>& arguments, const Output& out) {
    const std::string& command = arguments[0];
    const bool adjoint = command == "adjoint";
    std::vector<std::string> files, settings;
    for (std::size_t i = 2; i < arguments.size(); ++i)
        (arguments[i].find('=') == std::string::npos ? files : settings).push_back(arguments[i]);
    if (arguments.size() < 2 || (adjoint && files.empty()))
        throw UsageError(command, " takes a deck and files of vectors at nodes: almesh ", command,
                         adjoint ? " DECK dJ-dx.csv [...] [key=value ...]" : " DECK [dg.csv ...] [key=value ...]");
    Deck deck = read_deck(arguments[1], settings);
    deck.linear.half_from_blocks = std::numeric_limits<double>::infinity();  // the Hessian takes part in products
    if (files.empty() && deck.constants.empty())
        throw UsageError(command, ": nothing to differentiate by: give files of velocities of the boundary, or the "
                         "deck constants, `let NAME = NUMBER`");
    if (!deck.frames.empty()) throw UsageError(command, ": many frames have no derivative: give the deck one time");
    if (deck.method.moving != MovingMethod::augmented_lagrangian)
        throw UsageError(command, ": only meshes of method = augmented_lagrangian have derivatives");

    std::vector<Column> columns;
    std::string told;
    const auto begins = [&](const Problem& problem) {
        for (const std::string& file : files) {
            const std::string name = std::filesystem::path(file).stem().string();
            if (find_row(columns, name) || find_row(deck.constants, name))
                throw UsageError(file, ": another file or a constant has the name ", name, ", which results get");
            columns.emplace_back(name, read_values(problem.mesh(), file, adjoint));
        }
    };
    const auto solved = [&](const Problem& problem, Solution& solution) {
        if (problem.curves_in_place)
            throw Error(ExitCode::not_converged,
                        "no derivative: the mesh was made valid by parts, and is no minimum of one functional");
        Level& level = *problem.level;
        Derivative derivative(level.mesh, *level.energy, *level.constraint, deck.linear);
        derivative.polish(solution.x);
        measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
        if (adjoint) told = write_adjoint(out, deck, problem, derivative, columns);
        else write_tangent(deck, problem, derivative, columns);
    };
    const ExitCode ended = run(deck, out, {begins, solved});
    if (ended == ExitCode::not_converged)
        throw Error(ended, concat(arguments[1], ": no derivative: the run did not converge"));
    print(out, told, "derivatives in ", deck.output, "/", command, "-*.csv\n");
    return ended;
}

}  // namespace almesh
