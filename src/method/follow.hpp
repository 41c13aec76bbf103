// Following the motion of the boundary: the problem is solved for parts of the motion, one after the other, each from
// the solution of the one before.
//
// A large penalty sets the boundary in its place at once, before the mesh inside has turned with it. Where a boundary
// turns far, the mesh may then wind around it to the left on one side and to the right on the other, and no valid mesh
// leads from there to the solution. At the fraction t of the motion (motion.hpp: at_fraction()) the boundary has turned
// by that part of its angle, so the mesh is wound as the motion winds it.
//
// automatic   in parts of at most 90 degrees, by the shorter way; a motion that turns by less at once, and in halves
//             where that fails, unless the target is out of reach
// never       at once
// always      in parts of at most 90 degrees, also for turns beyond 180: rotate 270 and rotate -90 are different meshes
#pragma once
#include <functional>
#include <memory>
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

    // For following the motion: the constraint at a fraction of it, in (0, 1), or nullptr where boundaries that share
    // nodes do not agree there; the largest angle by which it turns a boundary, in degrees. Without the first, the
    // motion is not followed.
    std::function<std::unique_ptr<Constraint>(double fraction)> constraint_at = {};
    double turn = 0;

    bool is_worth_little = false;  // among coarser meshes: tried at once, in a few steps
};

// What the method came to on a coarser mesh, for a part of the motion, or with one of several powers: a row of the
// report.
struct Stage {
    int nodes = 0;
    AlStatus status = AlStatus::converged;  // where it is not, what follows does not start from here
    AlIteration last;  // its last iteration; seconds: with making the mesh, its target and the pattern of its matrix
    int newton_iterations = 0;
    double fraction = 1;  // of the motion
    int power = 0;        // of eta - 1, where it is one of several (worst.hpp)
};

using StageObserver = std::function<void(const Stage&)>;

// How the method is run on every mesh.
struct MethodParams {
    AugmentedLagrangianParams schedule;
    LinearSolverParams linear;
    Forcing forcing = Forcing::automatic;
    Follow follow = Follow::automatic;
};

// Tolerances for a solution that is only a start of the next: relative to the motion, whose size is |c_D| of the ideal
// mesh; |grad E| scales like L^(n - 1) times motion / L, of which of_gradient is allowed.
AugmentedLagrangianParams loosened(AugmentedLagrangianParams params, const Level& level, double of_gradient = 0.03);

// Algorithm 1 on the level, from x (node_count x dim) and the given start, following the motion as params say; then it
// starts anew from the ideal mesh. The result is that of the last run of Algorithm 1, with all Newton steps of those
// before it in followed_newton_iterations; of an interrupted part, its distances are those from the whole motion's
// target. observe_part: called after each part of the motion but the last.
AlResult minimise_following(const Level& level, Newton& newton, const MethodParams& params, std::vector<double>& x,
                            const AlStart& start, const AlObserver& observer = {},
                            const StageObserver& observe_part = {});

}  // namespace almesh
