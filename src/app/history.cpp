#include "app/history.hpp"

#include <cmath>

#include "base/text.hpp"

namespace almesh {
namespace {

std::string joined(const std::vector<std::string>& cells) {
    std::string line = cells[0];
    for (std::size_t k = 1; k < cells.size(); ++k) line += "," + cells[k];
    return line + "\n";
}

// Why the step is shorter than one.
std::string cut_reason(const NewtonStep& step) {
    if (step.cuts_inverted && step.cuts_decrease) return "inverted element; insufficient decrease";
    if (step.cuts_inverted) return "inverted element";
    return step.cuts_decrease ? "insufficient decrease" : "none";
}

}  // namespace

History::History(int dim, double length) : dim_(dim), length_(length) {
    text_ = joined({"kind", "al_iteration", "newton_iteration", "energy", "gradient_norm", "constraint_norm",
                    "projected_constraint_norm", "mu", "omega", "epsilon", "relative_quality", "max_distortion",
                    "newton_iterations", "newton_status", "update", "step_length", "cuts_inverted", "cuts_decrease",
                    "cut_reason", "hessian", "solver", "fallback", "linear_iterations", "ilu_shift",
                    "pocket_nodes", "pocket_steps", "nodes", "seconds"});
}

void History::add(const AlIteration& row) {
    if (row.iteration == 0) {  // nothing was minimised yet
        text_ += joined({"al", "0", "", "", "", to_text(row.constraint_norm * length_),
                         to_text(row.projected_constraint_norm * length_), "", "", "", to_text(row.relative_quality),
                         to_text(row.max_distortion), "", "", "", "", "", "", "", "", "", "", "", "", "", "", "",
                         to_text(row.seconds)});
        return;
    }
    add("al", row, row.newton_iterations, to_string(row.update), "");
}

void History::add(const CoarseStage& stage) {
    const char* const next = stage.status == AlStatus::converged ? "finer mesh" : "dropped";
    add("coarse", stage.last, stage.newton_iterations, next, std::to_string(stage.nodes));
}

void History::add(const std::string& kind, const AlIteration& row, int newton_iterations, const std::string& update,
                  const std::string& nodes) {
    const double energy = std::pow(length_, dim_);
    text_ += joined({kind, std::to_string(row.iteration), "", to_text(row.energy * energy),
                     to_text(row.gradient_norm * energy / length_), to_text(row.constraint_norm * length_),
                     to_text(row.projected_constraint_norm * length_), to_text(row.mu * energy / (length_ * length_)),
                     to_text(row.omega * energy / length_), to_text(row.epsilon * length_ * length_),
                     to_text(row.relative_quality), to_text(row.max_distortion), std::to_string(newton_iterations),
                     to_string(row.newton_status), update, "", "", "", "", "", "", "", "", "", "", "", nodes,
                     to_text(row.seconds)});
}

void History::add(int al_iteration, const NewtonStep& step) {
    ++newton_steps_;
    const double energy = std::pow(length_, dim_);
    text_ += joined({"newton", std::to_string(al_iteration), std::to_string(step.iteration),
                     to_text(step.energy * energy), to_text(step.gradient_norm * energy / length_), "", "", "", "", "",
                     "", "", "", "", "",
                     to_text(step.step_length), std::to_string(step.cuts_inverted), std::to_string(step.cuts_decrease),
                     cut_reason(step), to_string(step.hessian), to_string(step.solver),
                     step.fallback == SolveStatus::converged ? "" : to_string(step.fallback),
                     std::to_string(step.linear_iterations), to_text(step.shift), std::to_string(step.pocket_nodes),
                     std::to_string(step.pocket_steps), "", ""});
}

}  // namespace almesh
