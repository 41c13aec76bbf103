// history.csv: one row per augmented Lagrangian iteration (kind `al`, row 0 the mesh at the start) and, before it, one
// per Newton iteration of its subproblem (kind `newton`), in the order they happened; first of all one per coarser mesh
// (kind `coarse`: its last iteration, all its Newton steps). Columns that a kind does not have are empty.
#pragma once
#include <string>

#include "method/coarse_stage.hpp"

namespace almesh {

class History {
public:
    // Lengths in rows are multiplied by `length`, energies by length^dim: the run's unit to the mesh's.
    History(int dim, double length);
    void add(const CoarseStage& stage);
    void add(const AlIteration& row);
    void add(int al_iteration, const NewtonStep& step);
    const std::string& csv() const { return text_; }
    int newton_steps() const { return newton_steps_; }

private:
    int dim_;
    double length_;
    std::string text_;
    void add(const std::string& kind, const AlIteration& row, int newton_iterations, const std::string& update,
             const std::string& nodes);
    int newton_steps_ = 0;
};

}  // namespace almesh
