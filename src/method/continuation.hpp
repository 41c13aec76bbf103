// Continuation: a problem that is too far for Newton's method is solved in stages, each from the solution of the one
// before (Allgower & Georg, Numerical Continuation Methods). What changes from stage to stage is
//
//   the load    the fraction of the motion of the boundary, for Algorithm 1 (minimise_in_increments() below) and
//               with the boundary set on its target (set_boundary.hpp), by one rule, climb()
//   the power   of eta - 1 in the objective (p_norm.hpp)
//   the level   the mesh, then its degree (levels.hpp)
//
// Why the load: a large penalty sets the boundary on its target at once, before the mesh inside has turned with it.
// Where a boundary turns far, the mesh may then wind around it to the left on one side and to the right on the other,
// and no valid mesh leads from there to the solution. At the fraction t of the motion (motion.hpp: at_fraction()) the
// boundary has turned by that part of its angle, so the mesh stays in the homotopy class of the motion.
//
// automatic   in increments of at most 90 degrees, by the shorter way; a motion that turns by less at once, and in
//             halves where that fails
// never       at once
// always      in increments of at most 90 degrees, also for turns beyond 180: rotate 270 and rotate -90 are different
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "method/augmented_lagrangian.hpp"

namespace almesh {

// The problem on one mesh. Never moved: energy and constraint may refer to the mesh.
struct Level {
    Mesh mesh;
    std::vector<double> ideal;  // node_count x dim
    std::unique_ptr<DistortionEnergy> energy;
    std::unique_ptr<Constraint> constraint;

    // For load increments: the constraint at a fraction of the motion, in (0, 1), or nullptr where boundaries that
    // share nodes do not agree there; the largest angle by which it turns a boundary, in degrees. Without the first,
    // there are no increments.
    std::function<std::unique_ptr<Constraint>(double fraction)> constraint_at = {};
    double turn = 0;

    bool is_worth_little = false;  // a coarser mesh: solved at once, in few steps
    PeriodicPairs pairs = {};

    bool is_valid(const std::vector<double>& x) const;  // certified everywhere in every element
    std::vector<char> on_boundary() const;              // per node: whether the constraint acts on it
    // x with the nodes of the constraint at `targets`, these x dim.
    std::vector<double> with_boundary(const std::vector<double>& targets, std::vector<double> x) const;
};

// The result of one stage: a row of the report.
struct Stage {
    int nodes = 0;
    Status status = Status::converged;  // else the next stage does not start from this one
    AlIteration last;  // its last iteration; seconds: with making the mesh, its target and the pattern of its matrix
    int newton_iterations = 0;
    double fraction = 1;  // of the motion
    int power = 0;        // of eta - 1, where it is one of several (p_norm.hpp)
    std::string part = {};  // a part of the mesh, solved alone: its place and its boundary
};

using StageObserver = std::function<void(const Stage&)>;

// Where a run stands, besides its mesh: the loops keep it up to date, and go on from it after the run was stopped or
// killed (deck/so_far.hpp).
struct Standing {
    double fraction = 0;         // up to which load increments are solved; 1: the whole motion is being solved
    int power = 0;               // the power being solved; 0: none yet
    bool is_last_power = false;  // higher powers are not worth their cost
    double eta_before = 0;       // the largest eta when this power began
    double mu = 0;               // of Algorithm 1 for the whole motion, in units of |1|^2; 0: that of the schedule,
    std::vector<double> lambda;  // and its multipliers; empty: zero
    std::vector<double> x;       // to resume from, where an increment or a power began; empty: the iterate
    int attempt = -1;            // at curving the mesh in parts (curving.hpp), from 0; -1: as a whole
    double gradient_norm = 0;          // of these parts: the largest |grad E| at the end of one,
    std::vector<char> straight, freed;  // per element: whether it is still straightened; per node: whether it slides
};

// How the method is run on every mesh.
struct MethodParams {
    AugmentedLagrangianParams schedule;
    LinearSolverParams linear;
    Forcing forcing = Forcing::automatic;
    Continuation continuation = Continuation::automatic;
    bool is_start = false;  // the solution only starts a finer mesh: given up if its first subproblem stalls
    std::shared_ptr<Standing> standing = std::make_shared<Standing>();
    bool goes_on = false;  // a resumed run: x is its mesh
    // Called with every iterate, of coarser meshes too.
    std::function<void(const Level&, const std::vector<double>& x)> observe_iterate = {};
};

// Part of the way on which a number is raised: the load, or the time of a frame.
struct Increment {
    double from, to, size;  // to: from + size, but for rounding, and for the last one
    bool is_last;
};

enum class StageEnd { solved, failed, over };  // over: of the whole way

// Solves the increments up to `end`, of the given size, one after the other. One that fails is tried again with half
// the size, unless that is below the least one; then, and where solve() says so, it is over.
template <class Solve>
void climb(double from, double end, double size, double least, const Solve& solve) {
    while (from < end && size >= least) {
        const bool is_last = from + size >= end - 0.5 * least;
        const double to = is_last ? end : from + size;
        const StageEnd found = solve(Increment{from, to, size, is_last});
        if (found == StageEnd::over) return;
        if (found == StageEnd::solved) from = to;
        else size *= 0.5;
    }
}

// Tolerances for a solution that only starts the next stage, relative to the motion m, which is |P c_D| of the ideal
// mesh: |grad E| may be of_gradient m L^(n - 2), with L^n the volume.
AugmentedLagrangianParams loosened(AugmentedLagrangianParams params, const Level& level, double of_gradient = 0.03);

// Algorithm 1 on the level, from x (node_count x dim) and the given start, with load increments as params say; with
// them it starts anew from the ideal mesh, but where it goes on. The result is that of the last run of Algorithm 1,
// with all Newton steps of those before it in earlier_newton_iterations; of an increment that is not the last, its
// distances are those from the whole motion's target. observe_stage: called after each increment but the last.
AlResult minimise_in_increments(const Level& level, Newton& newton, const MethodParams& params, std::vector<double>& x,
                                const AlStart& start, const AlObserver& observer = {},
                                const StageObserver& observe_stage = {});

}  // namespace almesh
