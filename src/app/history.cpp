#include "app/history.hpp"

#include <array>

#include "base/text.hpp"
#include "method/continuation.hpp"

namespace almesh {
namespace {

// What a cell is taken from: a row of kind `al`, of `coarse` where stage is not null ...
struct AlRow {
    const AlIteration& it;
    const CoarseStage* stage;
    Units units;
};

// ... or one of kind `newton`.
struct NewtonRow {
    int al_iteration;
    const NewtonStep& step;
    Units units;
};

struct Column {
    const char *name, *meaning;
    // nullptr: the cell is empty.
    std::string (*of_al)(const AlRow&);
    std::string (*of_newton)(const NewtonRow&);
    bool at_start = false;  // also in row 0, before anything was minimised
};

std::string text(int count) { return std::to_string(count); }
std::string text(double value) { return to_text(value); }
std::string text(const char* word) { return word; }

const char* reason_of_cut(const NewtonStep& step) {
    if (step.cuts_inverted && step.cuts_decrease) return "inverted element; insufficient decrease";
    if (step.cuts_inverted) return "inverted element";
    return step.cuts_decrease ? "insufficient decrease" : "none";
}

const char* next_of(const CoarseStage& stage) { return stage.status == AlStatus::converged ? "finer mesh" : "dropped"; }

using Al = const AlRow&;
using Nw = const NewtonRow&;
constexpr bool at_start = true;

constexpr auto columns = std::to_array<Column>({
    {"kind", "al: augmented Lagrangian iteration; newton: step of its subproblem; coarse: all of a coarser mesh",
     [](Al r) { return text(r.stage ? "coarse" : "al"); }, [](Nw) { return text("newton"); }, at_start},
    {"al_iteration", "number of the augmented Lagrangian iteration; 0: the mesh at the start",
     [](Al r) { return text(r.it.iteration); }, [](Nw r) { return text(r.al_iteration); }, at_start},
    {"newton_iteration", "number of the step in its subproblem", nullptr, [](Nw r) { return text(r.step.iteration); }},
    {"energy", "E (Eq. 6), after the step", [](Al r) { return text(r.units.energy(r.it.energy)); },
     [](Nw r) { return text(r.units.energy(r.step.energy)); }},
    {"gradient_norm", "|grad E|, after the step", [](Al r) { return text(r.units.gradient(r.it.gradient_norm)); },
     [](Nw r) { return text(r.units.gradient(r.step.gradient_norm)); }},
    {"constraint_norm", "|c_D|", [](Al r) { return text(r.units.distance(r.it.constraint_norm)); }, nullptr, at_start},
    {"projected_constraint_norm", "|P c_D|, on which convergence is judged",
     [](Al r) { return text(r.units.distance(r.it.projected_constraint_norm)); }, nullptr, at_start},
    {"mu", "penalty of the subproblem", [](Al r) { return text(r.units.penalty(r.it.mu)); }, nullptr},
    {"omega", "tolerance of |grad E| in the subproblem", [](Al r) { return text(r.units.gradient(r.it.omega)); },
     nullptr},
    {"epsilon", "tolerance of |P c_D|^2 that decides between the updates",
     [](Al r) { return std::isfinite(r.it.epsilon) ? text(r.units.squared_distance(r.it.epsilon)) : ""; }, nullptr},
    {"relative_quality", "q", [](Al r) { return text(r.it.relative_quality); }, nullptr, at_start},
    {"max_distortion", "largest eta", [](Al r) { return text(r.it.max_distortion); }, nullptr, at_start},
    {"newton_iterations", "Newton steps of the subproblem, or on the coarser mesh",
     [](Al r) { return text(r.stage ? r.stage->newton_iterations : r.it.newton_iterations); }, nullptr},
    {"newton_status", "how the subproblem ended", [](Al r) { return text(to_string(r.it.newton_status)); }, nullptr},
    {"update", "what was updated then: lambda, mu; coarse: whether the next mesh starts from it",
     [](Al r) { return text(r.stage ? next_of(*r.stage) : to_string(r.it.update)); }, nullptr},
    {"step_length", "of the line search", nullptr, [](Nw r) { return text(r.step.step_length); }},
    {"cuts_inverted", "trial lengths refused because an element was inverted", nullptr,
     [](Nw r) { return text(r.step.cuts_inverted); }},
    {"cuts_decrease", "trial lengths refused because E did not decrease enough", nullptr,
     [](Nw r) { return text(r.step.cuts_decrease); }},
    {"cut_reason", "the two in words", nullptr, [](Nw r) { return text(reason_of_cut(r.step)); }},
    {"hessian", "which Hessian the direction is from", nullptr, [](Nw r) { return text(to_string(r.step.hessian)); }},
    {"solver", "which linear solver", nullptr, [](Nw r) { return text(to_string(r.step.solver)); }},
    {"fallback", "how an iterative solver failed before Cholesky took over", nullptr,
     [](Nw r) { return text(r.step.fallback ? to_string(*r.step.fallback) : ""); }},
    {"linear_iterations", "of cg or gmres", nullptr, [](Nw r) { return text(r.step.linear_iterations); }},
    {"ilu_shift", "ILU(0) is of the matrix with its diagonal blocks times 1 + ilu_shift", nullptr,
     [](Nw r) { return text(r.step.ilu_shift); }},
    {"local_nodes", "nodes of the local elimination after the step", nullptr,
     [](Nw r) { return text(r.step.local.nodes); }},
    {"local_steps", "Newton steps of it", nullptr, [](Nw r) { return text(r.step.local.steps); }},
    {"nodes", "of the coarser mesh", [](Al r) { return r.stage ? text(r.stage->nodes) : ""; }, nullptr},
    {"seconds", "since the iterations began; of a coarse row all of that mesh", [](Al r) { return text(r.it.seconds); },
     nullptr, at_start},
});

// One line of the file; cell(column) gives its text.
template <class Cell>
std::string line(const Cell& cell) {
    std::string cells;
    for (const Column& column : columns) cells += cell(column) + ',';
    cells.back() = '\n';
    return cells;
}

std::string line(const AlRow& row) {
    return line([&](const Column& column) {
        const bool has_cell = row.it.iteration > 0 || row.stage || column.at_start;
        return column.of_al && has_cell ? column.of_al(row) : std::string();
    });
}

}  // namespace

History::History(int dim, double length) : units_{dim, length} {
    text_ = line([](const Column& column) { return std::string(column.name); });
}

void History::add(const AlIteration& row) { text_ += line(AlRow{row, nullptr, units_}); }

void History::add(const CoarseStage& stage) { text_ += line(AlRow{stage.last, &stage, units_}); }

void History::add(int al_iteration, const NewtonStep& step) {
    ++newton_steps_;
    const NewtonRow row = {al_iteration, step, units_};
    text_ += line([&](const Column& column) { return column.of_newton ? column.of_newton(row) : std::string(); });
}

std::string columns_table() {
    std::string table;
    for (const Column& column : columns) table += table_row({column.name, column.meaning}, {27, 73});
    return table;
}

}  // namespace almesh
