// The table a run prints: a row per augmented Lagrangian iteration and, on a terminal, one line that follows the Newton
// iterations and is overwritten.
#pragma once
#include <cstdio>
#include <string>

#include "app/units.hpp"

namespace almesh {

struct AlIteration;
struct CoarseStage;
struct NewtonStep;

class Terminal {
public:
    // length: the run's unit, in units of the mesh file; norms are printed in those of the file.
    Terminal(std::FILE* out, int dim, double length);

    void header();
    void row(const CoarseStage& stage);
    void row(const AlIteration& iteration);
    void live(int al_iteration, const NewtonStep& step);  // prints nothing where out is no terminal

private:
    std::FILE* out_;
    bool is_terminal_;
    Units units_;
    void row(const AlIteration& it, const char* update, int newton_iterations, const std::string& note);
    void clear_live_line();
};

}  // namespace almesh
