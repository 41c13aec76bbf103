// history.csv: one row per augmented Lagrangian iteration (kind `al`, row 0 the initial mesh) and, before it, one per
// Newton iteration of its subproblem (kind `newton`), in the order they happened. Columns that a kind does not have are
// empty.
#pragma once
#include <string>

#include "optimize/augmented_lagrangian.hpp"

namespace almesh {

class History {
   public:
    // Lengths in rows are multiplied by `length`, energies by length^dim: the run's unit to the mesh's.
    History(int dim, double length);
    void add(const AlIteration& row);
    void add(int al_iteration, const NewtonStep& step);
    const std::string& csv() const { return text_; }
    int newton_steps() const { return newton_steps_; }

   private:
    int dim_;
    double length_;
    std::string text_;
    int newton_steps_ = 0;
};

}  // namespace almesh
