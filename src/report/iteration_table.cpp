#include "report/iteration_table.hpp"

#include <unistd.h>

#include <array>

#include "base/table.hpp"
#include "problem/solve.hpp"

namespace almesh {
namespace {

// What a cell is taken from: a row of kind `al`, or of `coarse` or `part` where stage is not null ...
struct AlRow {
    const AlIteration& it;
    const Stage* stage;
    const std::string& run;
};

// ... or one of kind `newton`.
struct NewtonRow {
    int al_iteration;
    const NewtonStep& step;
    const std::string& run;
};

using Al = const AlRow&;
using Nw = const NewtonRow&;

struct Column : Named {
    // nullptr: the cell is empty.
    std::string (*of_al)(Al) = nullptr;
    std::string (*of_newton)(Nw) = nullptr;
    bool at_start = false;  // also in row 0, before anything was minimised
};

template <auto member>
std::string al(Al row) {
    return concat(row.it.*member);
}

template <auto member>
std::string newton(Nw row) {
    return concat(row.step.*member);
}

std::string reason_of_cut(Nw row) {
    if (row.step.cuts_inverted && row.step.cuts_decrease) return "inverted element; insufficient decrease";
    if (row.step.cuts_inverted) return "inverted element";
    return row.step.cuts_decrease ? "insufficient decrease" : "none";
}

const char* kind(const Stage& stage) {
    if (!stage.part.empty()) return "local";
    return stage.power ? "power" : stage.fraction < 1 ? "part" : "coarse";
}

std::string update(Al row) {
    if (!row.stage) return to_string(row.it.update);
    if (row.stage->status != Status::converged) return "dropped";
    if (!row.stage->part.empty()) return "kept";
    if (row.stage->power) return "next power";
    return row.stage->fraction < 1 ? "next part" : "finer mesh";
}

using It = AlIteration;
using Step = NewtonStep;
constexpr bool at_start = true;

constexpr auto columns = std::to_array<Column>({
    {{"kind", "al: an augmented Lagrangian iteration; newton: a step of its minimisation; coarse: the whole solution "
              "on a coarser mesh; part: that of a part of the motion; power: that with an earlier power; local: that "
              "of a part of the mesh"},
     [](Al r) { return std::string(r.stage ? kind(*r.stage) : "al"); },
     [](Nw) { return std::string("newton"); }, at_start},
    {{"al_iteration", "number of the augmented Lagrangian iteration; 0: the mesh at the start", "count"},
     al<&It::iteration>, [](Nw r) { return concat(r.al_iteration); }, at_start},
    {{"newton_iteration", "number of the step in its minimisation", "count"}, nullptr, newton<&Step::iteration>},
    {{"energy", "E (Eq. 6), after the step", "length^n"}, al<&It::energy>, newton<&Step::energy>},
    {{"gradient_norm", "|grad E|, after the step", "length^(n - 1)"},
     al<&It::gradient_norm>, newton<&Step::gradient_norm>},
    {{"constraint_norm", "|c_D|", "length"}, al<&It::constraint_norm>, nullptr, at_start},
    {{"projected_constraint_norm", "|P c_D|, on which convergence is judged", "length"},
     al<&It::projected_constraint_norm>, nullptr, at_start},
    {{"mu", "penalty of the minimisation", "length^(n - 2)"}, al<&It::mu>},
    {{"omega", "tolerance of |grad E| in the minimisation", "length^(n - 1)"}, al<&It::omega>},
    {{"epsilon", "tolerance of |P c_D|^2: below it lambda is updated, above it mu", "length^2"},
     [](Al r) { return std::isfinite(r.it.epsilon) ? concat(r.it.epsilon) : ""; }},
    {{"relative_quality", "q", "1"}, al<&It::relative_quality>, nullptr, at_start},
    {{"max_distortion", "largest eta", "1"}, al<&It::max_distortion>, nullptr, at_start},
    {{"newton_iterations", "Newton steps of the row: of the minimisation, coarser mesh, part or power", "count"},
     al<&It::newton_iterations>},
    {{"newton_status", "how the minimisation ended"}, al<&It::newton_status>},
    {{"update", "what was updated afterwards: lambda, mu; local: whether it was kept; coarse, part, power: "
      "whether the next row starts from it"},
     update},
    {{"step_length", "step length t of the line search", "1"}, nullptr, newton<&Step::step_length>},
    {{"cuts_inverted", "trial lengths refused because an element was inverted", "count"},
     nullptr, newton<&Step::cuts_inverted>},
    {{"cuts_decrease", "trial lengths refused because E did not decrease enough", "count"},
     nullptr, newton<&Step::cuts_decrease>},
    {{"cut_reason", "why trial lengths were refused, in words"}, nullptr, reason_of_cut},
    {{"hessian", "Hessian from which the direction was computed"}, nullptr, newton<&Step::hessian>},
    {{"solver", "linear solver"}, nullptr, newton<&Step::solver>},
    {{"fallback", "how an iterative solver failed before Cholesky took over"},
     nullptr, [](Nw r) { return r.step.fallback ? concat(*r.step.fallback) : ""; }},
    {{"preconditioner", "preconditioner of cg or gmres: ilu0, ssor or pmg"}, nullptr, [](Nw r) {
         const PreconditionerKind kind = r.step.preconditioner;
         return kind == PreconditionerKind::automatic ? std::string() : concat(kind);
     }},
    {{"linear_iterations", "iterations of cg or gmres", "count"}, nullptr, newton<&Step::linear_iterations>},
    {{"ilu_shift", "the diagonal blocks were multiplied by 1 + ilu_shift before ILU(0)", "1"},
     nullptr, newton<&Step::ilu_shift>},
    {{"local_nodes", "nodes of the local eliminations after the step", "count"},
     nullptr, [](Nw r) { return concat(r.step.local.nodes); }},
    {{"local_steps", "Newton steps of these eliminations", "count"},
     nullptr, [](Nw r) { return concat(r.step.local.steps); }},
    {{"nodes", "coarse, part, power, local: nodes of the mesh, or of the part of it", "count"},
     [](Al r) { return r.stage ? concat(r.stage->nodes) : ""; }},
    {{"fraction", "part: the fraction of the motion at its end", "1"},
     [](Al r) { return r.stage && r.stage->fraction < 1 ? concat(r.stage->fraction) : ""; }},
    {{"power", "power: exponent of eta - 1", "count"},
     [](Al r) { return r.stage && r.stage->power ? concat(r.stage->power) : ""; }},
    {{"relative_boundary_error", "largest distance of a boundary node from its target, in heights of the cells at it",
      "1"}, al<&It::relative_boundary_error>, nullptr, at_start},
    {{"run", "id of the run, the same in all of its files"},
     [](Al r) { return r.run; }, [](Nw r) { return r.run; }, at_start},
    {{"seconds", "seconds since the iterations began; coarse, part, power, local: seconds that the row took", "s"},
     al<&It::seconds>, nullptr, at_start},
});

// One line of the file; text_of(column) gives the text of its cell.
template <class Text>
Fields line(const Text& text_of) {
    Fields cells;
    for (const Column& column : columns) cells.emplace_back(column, text_of(column));
    return cells;
}

Fields line(Al row) {
    return line([&](const Column& column) {
        const bool has_cell = row.it.iteration > 0 || row.stage || column.at_start;
        return column.of_al && has_cell ? column.of_al(row) : std::string();
    });
}

constexpr const char* clear_line = "\r\033[K";

const TextTable shown{{{"AL", 3}, {"|c_D|", 9}, {"|grad E|", 9}, {"q", 8}, {"max eta", 9}, {"mu", 8}, {"update", -9},
                       {"Newton", 6}, {"time", 8}}};

}  // namespace

IterationTable::IterationTable(const Output& out, const Units& units, const std::string& run, bool is_shown)
    : out_(out), is_shown_(is_shown), is_terminal_(is_shown && isatty(fileno(out)) != 0), units_(units), run_(run) {
    if (is_shown_) print(out_, shown.heading());
}

void IterationTable::add(const Stage& stage) {
    AlIteration row = units_.of(stage.last);
    row.newton_iterations = stage.newton_iterations;
    keep(line(AlRow{row, &stage, run_}));
    const char* const used = stage.status == Status::converged ? "" : ", not used";
    std::string what = "  ";
    if (!stage.part.empty()) what += stage.part;
    else if (stage.power) what += concat("(eta - 1)^", stage.power);
    else if (stage.fraction < 1) what += to_text(stage.fraction, 3) + " of the motion";
    else what += concat(stage.nodes, " nodes");
    show(row, kind(stage), what + used);
}

void IterationTable::add(const AlIteration& it) {
    const AlIteration row = units_.of(it);
    keep(line(AlRow{row, nullptr, run_}));
    show(row, row.iteration > 0 ? to_string(row.update) : nullptr, "");
}

void IterationTable::add(int al_iteration, const NewtonStep& it) {
    const NewtonStep step = units_.of(it);
    fallbacks += step.fallback.has_value();
    keep(line([row = NewtonRow{al_iteration, step, run_}](const Column& column) {
        return column.of_newton ? column.of_newton(row) : std::string();
    }));
    if (!is_terminal_) return;
    print(out_, clear_line, padded(concat(al_iteration), 3), "  Newton ", step.iteration, "  |grad E| ",
          scientific(step.gradient_norm, 2), "  step ", to_text(step.step_length, 2), "  (", to_string(step.hessian),
          ")");
    std::fflush(out_);
}

SolveObserver IterationTable::observer() {
    SolveObserver observer;
    observer.iteration = [this](const AlIteration& row) { add(row); };
    observer.newton_step = [this](int al_iteration, const NewtonStep& step) { add(al_iteration, step); };
    observer.stage = [this](const Stage& stage) { add(stage); };
    return observer;
}

void IterationTable::keep(const Fields& row) {
    rows_ += csv_row(row);
    out_.tell("iteration", row);
}

void IterationTable::show(const AlIteration& row, const char* update, const std::string& note) {
    if (!is_shown_) return;
    const auto after = [&](const std::string& cell) { return update ? cell : "-"; };  // a minimisation
    const Fields cells = {row.iteration, scientific(row.constraint_norm, 3), after(scientific(row.gradient_norm, 2)),
                         fixed(row.relative_quality, 6), to_text(row.max_distortion, 4), after(scientific(row.mu, 2)),
                         update ? update : "-", after(concat(row.newton_iterations)), fixed(row.seconds, 2) + "s"};
    print(out_, is_terminal_ ? clear_line : "", shown.line(cells, note));
    std::fflush(out_);
}

std::string history_heading() {
    return csv_heading(line([](const Column&) { return std::string(); }));
}

std::vector<Named> history_columns() { return {columns.begin(), columns.end()}; }

}  // namespace almesh
