// Targets that make faces or elements infeasible (check/infeasible.hpp): found and dealt with before solving, as the
// keys `split` and `surface` say.
#pragma once
#include "base/error.hpp"
#include "check/infeasible.hpp"
#include "problem/problem.hpp"

namespace almesh {

// No valid mesh has this target: which elements are infeasible, and what may help.
struct InfeasibleTarget : InputError {
    ElementList list;
    bool sliding_may_help, division_helps;  // as of Infeasible
    bool is_of_elements;                    // no faces are at fault
    bool is_simplicial;
    bool refining_helps;  // once more

    InfeasibleTarget(const ProblemOptions& options, const Problem& problem, const Infeasible& infeasible);
};

// With split = auto, divides infeasible elements of the base mesh by nodes inside, and adds a note. Returns how many; 0
// where there are none. The level and the target are to be made again from the base.
int split_infeasible(const ProblemOptions& options, Problem& problem);

// Frees the nodes around what is infeasible to slide along the surface of the target, and adds a note. Throws
// InfeasibleTarget where that cannot help, or the surface is to be kept.
void free_infeasible(const ProblemOptions& options, Problem& problem);

}  // namespace almesh
