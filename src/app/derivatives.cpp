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
#include <optional>
#include <unordered_map>

#include "app/commands.hpp"
#include "app/deck.hpp"
#include "app/node_targets.hpp"
#include "app/problem.hpp"
#include "app/results.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "linalg/vector_ops.hpp"
#include "method/derivative.hpp"

namespace almesh {
namespace {

using Values = std::vector<double>;

struct Column {
    std::string name;
    Values value;  // nodes x dim
};

// Nodes that are not free.
std::vector<char> held_nodes(const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    std::vector<char> held(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (problem.target.hold_of_node(mesh, f, k) != BoundaryHold::free) held[mesh.faces[k]] = 1;
    });
    return held;
}

// A row for each node of the mesh; of the tangent, of boundaries that are not free.
Column read_column(const Problem& problem, const std::string& path, bool adjoint) {
    const Mesh& mesh = problem.mesh();
    const std::vector<char> chosen = adjoint ? std::vector<char>(mesh.nodes(), 1) : held_nodes(problem);
    const std::string place = adjoint ? "in the mesh" : "on a boundary that has a motion";
    std::unordered_map<long long, int> nodes;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (chosen[i]) nodes[mesh.file.node_id[i]] = i;
    Column column{std::filesystem::path(path).stem().string(), Values(mesh.x.size(), 0.0)};
    std::vector<char> known;
    read_node_rows(mesh, path, nodes, place, column.value, known);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (chosen[i] && !known[i])
            throw InputError(path, ": node ", mesh.file.node_id[i], ", which is ", place, ", has no row; of ",
                             nodes.size(), " there are ", std::count(known.begin(), known.end(), 1),
                             ". Give zeros where there is nothing");
    return column;
}

void write_column(const Deck& deck, const Mesh& mesh, const std::vector<char>& chosen, const std::string& name,
                  const Values& value) {
    std::string text = mesh.dim == 2 ? "node,x,y\n" : "node,x,y,z\n";
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (!chosen[i]) continue;
        text += std::to_string(mesh.file.node_id[i]);
        for (int a = 0; a < mesh.dim; ++a) text += "," + to_text(value[offset(i, mesh.dim, a)]);
        text += "\n";
    }
    write_file(deck.output + "/" + name + ".csv", text);
}

// r and D'f of the target with another value of the constant.
BoundaryChange residual_at(const Deck& deck, const Problem& problem, const Derivative& derivative,
                           const Constant& constant, double value) {
    Deck at = deck;
    const std::string setting = concat("let ", constant.name, "=", value);
    at.boundaries = parse_deck(resolved(deck), deck.output + "/deck.txt", {setting}).boundaries;
    Problem other = make_problem(at);
    if (other.target.freed != problem.target.freed || other.target.straight != problem.target.straight)
        throw InputError("other nodes are freed, or other faces made straight, at ", setting);
    set_constraint(at, other);
    return derivative.residual(*other.level->constraint);
}

// Of the boundary by the constant. Steps h: of its value, or of a hundredth where that is less.
BoundaryChange change_by(const Deck& deck, const Problem& problem, const Derivative& derivative,
                         const Constant& constant) {
    constexpr double accuracy = 1e-9, steps[] = {1e-2, 1e-3, 1e-4};
    const BoundaryChange here = derivative.residual(*problem.level->constraint);
    std::string why;
    for (const double step : steps) try {
            const double h = step * std::max(std::abs(constant.value), 1e-2);
            std::vector<BoundaryChange> at;  // a - 3 h, ..., a + 3 h
            for (int k = -3; k <= 3; ++k)
                at.push_back(k == 0 ? here : residual_at(deck, problem, derivative, constant, constant.value + k * h));
            const auto differences = [&](Values BoundaryChange::*const field, const std::array<double, 7>& weight) {
                Values sum(here.shift.size(), 0.0);
                for (int k = 0; k < 7; ++k) axpy(weight[k] / (60 * h), at[k].*field, sum);
                return sum;
            };
            const auto slope = [&](Values BoundaryChange::*const field) {
                return differences(field, {-1, 9, -45, 0, 45, -9, 1});
            };
            const auto difference_from_biased = [&](Values BoundaryChange::*const field) {  // of these formulas
                return norm_inf(differences(field, {-1, 9, -30, 50, -45, 21, -4}));
            };
            const BoundaryChange change{slope(&BoundaryChange::shift), slope(&BoundaryChange::force)};
            const double shift = norm_inf(change.shift), force = std::max(norm_inf(change.force), norm_inf(here.force));
            if (difference_from_biased(&BoundaryChange::shift) <= accuracy * shift &&
                difference_from_biased(&BoundaryChange::force) <= accuracy * std::max(1.0, shift) * force)
                return derivative.change(change);
            why = "the target, or a surface along which nodes slide, is not smooth there";
        } catch (const Error& refused) {
            why = refused.what();
        }
    throw Error(ExitCode::not_converged, concat("no derivative by ", constant.name, ": ", why));
}

// Of a run, once it has converged.
class Differentiation {
public:
    Differentiation(const Deck& deck, bool adjoint, const std::vector<std::string>& files)
        : deck_(deck), adjoint_(adjoint), files_(files) {}

    std::string told;  // for the terminal

    void read(const Problem& problem) {
        for (const std::string& file : files_) {
            columns_.push_back(read_column(problem, file, adjoint_));
            const auto is_same = [&](const Column& other) { return other.name == columns_.back().name; };
            if (std::count_if(columns_.begin(), columns_.end(), is_same) > 1 ||
                find_row(deck_.constants, columns_.back().name))
                throw UsageError(file, ": another file or a constant has the name ", columns_.back().name,
                                 ", by which results are called");
        }
    }

    std::string solved(const Problem& problem, Solution& solution) {
        if (problem.curves_in_place)
            return "no derivative: the mesh was made valid by parts, and is no minimum of one functional";
        Level& level = *problem.level;
        Derivative derivative(level.mesh, *level.energy, *level.constraint, deck_.linear);
        if (const std::string why = derivative.settle(solution.x); !why.empty()) return "no derivative: " + why;
        measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
        try {
            if (adjoint_) write_adjoint(problem, derivative);
            else write_tangent(problem, derivative);
        } catch (const Error& error) {
            return error.what();
        }
        return derivative.failure();
    }

private:
    const Deck& deck_;
    bool adjoint_;
    const std::vector<std::string>& files_;
    std::vector<Column> columns_;

    void write_adjoint(const Problem& problem, Derivative& derivative) {
        std::vector<BoundaryChange> changes, gradients;
        for (const Constant& constant : deck_.constants)
            changes.push_back(change_by(deck_, problem, derivative, constant));
        std::string table = "constant,value";
        for (const Column& column : columns_) {
            gradients.push_back(derivative.adjoint(column.value));
            if (!derivative.failure().empty()) return;
            write_column(deck_, problem.mesh(), held_nodes(problem), "adjoint-" + column.name, gradients.back().shift);
            table += "," + column.name;
        }
        for (std::size_t a = 0; a < changes.size(); ++a) {
            table += concat("\n", deck_.constants[a].name, ",", deck_.constants[a].value);
            for (std::size_t j = 0; j < columns_.size(); ++j) {
                const double slope = problem.frame.length * (dot(gradients[j].shift, changes[a].shift) +
                                                             dot(gradients[j].force, changes[a].force));
                table += "," + to_text(slope);
                told += concat("d ", columns_[j].name, " / d ", deck_.constants[a].name, " = ", slope, "\n");
            }
        }
        write_file(deck_.output + "/adjoint-constants.csv", table + "\n");
    }

    void write_tangent(const Problem& problem, Derivative& derivative) {
        const auto write = [&](const std::string& name, const BoundaryChange& change, double unit) {
            Values dx = derivative.tangent(change);
            scale(static_cast<int>(dx.size()), unit, dx.data());
            if (!derivative.failure().empty()) return;
            write_column(deck_, problem.mesh(), std::vector<char>(problem.mesh().nodes(), 1), "tangent-" + name, dx);
        };
        for (const Column& column : columns_) write(column.name, {column.value, Values(column.value.size(), 0.0)}, 1);
        for (const Constant& constant : deck_.constants)
            write(constant.name, change_by(deck_, problem, derivative, constant), problem.frame.length);
    }
};

}  // namespace

ExitCode differentiate(const std::vector<std::string>& arguments, std::FILE* out) {
    const bool adjoint = arguments[0] == "adjoint";
    std::vector<std::string> files, settings;
    for (std::size_t i = 2; i < arguments.size(); ++i)
        (arguments[i].find('=') == std::string::npos ? files : settings).push_back(arguments[i]);
    if (arguments.size() < 2 || (adjoint && files.empty()))
        throw UsageError(arguments[0], " takes a deck and files of vectors at nodes: almesh ", arguments[0],
                         adjoint ? " DECK dJ-dx.csv [...] [key=value ...]" : " DECK [dg.csv ...] [key=value ...]");
    const Deck deck = read_deck(arguments[1], settings);
    if (!adjoint && files.empty() && deck.constants.empty())
        throw UsageError("tangent: nothing to differentiate by: give files of velocities of the boundary, or the deck "
                         "constants, `let NAME = NUMBER`");
    if (!deck.frames.empty()) throw UsageError(arguments[0], ": many frames have no derivative: give it one time");
    if (deck.method.moving != MovingMethod::augmented_lagrangian)
        throw UsageError(arguments[0], ": only meshes of method = augmented_lagrangian have derivatives");
    Differentiation differentiation(deck, adjoint, files);
    const ExitCode ended = run(deck, out, {[&](const Problem& problem) { differentiation.read(problem); },
                                           [&](const Problem& problem, Solution& solution) {
                                               return differentiation.solved(problem, solution);
                                           }});
    if (ended == ExitCode::not_converged)
        throw Error(ended, concat(arguments[1], ": no derivative: the run did not converge"));
    std::fputs(differentiation.told.c_str(), out);
    std::fprintf(out, "derivatives in %s/%s-*.csv\n", deck.output.c_str(), arguments[0].c_str());
    return ended;
}

}  // namespace almesh
