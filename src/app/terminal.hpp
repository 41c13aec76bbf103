// The table a run prints: a row per augmented Lagrangian iteration and, on a terminal, one line that follows the Newton
// iterations and is overwritten.
#pragma once
#include <cstdio>
#include <string>

#include "method/coarse_stage.hpp"

namespace almesh {

class Terminal {
public:
    // length: the run's unit in units of the mesh; norms are printed in those of the mesh.
    Terminal(std::FILE* out, int dim, double length);

    void header();
    void row(const CoarseStage& stage);
    void row(const AlIteration& iteration);
    void live(int al_iteration, const NewtonStep& step);  // nothing where out is no terminal

private:
    std::FILE* out_;
    bool is_terminal_;
    double length_, gradient_unit_, mu_unit_;
    void clear_live_line();
};

}  // namespace almesh
