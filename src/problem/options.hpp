// What can be chosen for a problem and its solution: numbers and kinds, no paths and no texts. A deck has them as keys
// of the same names (deck/deck_keys.cpp says what each means).
#pragma once
#include <limits>
#include <optional>

#include "constraint/target.hpp"
#include "energy/options.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/periodic.hpp"
#include "method/schedule.hpp"
#include "method/step_control.hpp"

namespace almesh {

constexpr int most_refinements = 8;

enum class Start { automatic, identity, coarse, file };
enum class LocalRepair { automatic, no, yes };
enum class SurfaceKind { automatic, keep, slide, straighten };
// What may not fall in a mesh that is improved. automatic: the certified bound of curved cells, the scaled Jacobian at
// the corners of straight ones.
enum class Guard { automatic, scaled_jacobian, certified_bound };
enum class Split { never, automatic, around };

enum class IdealKind {
    automatic,  // straight, but given where the straight-sided form is not valid and the mesh of the file is certified
    straight,   // the straight-sided form of the mesh, as in the paper
    given,      // the mesh as it is in the file, with its curved elements
    // The mesh of the file may have inverted elements (improve.hpp), and the ideal elements are
    regular,    // regular cells of the size of the elements around,
    size,       // regular cells with edges of a length that a formula gives,
    mesh        // or those of another mesh with the same elements
};

// Whether the mesh is improved: its ideal elements are not those of the first mesh.
inline bool is_improved(IdealKind ideal) { return ideal >= IdealKind::regular; }

// Parameters of the method stand in its own structs. An empty optional is `auto`.
struct ProblemOptions {
    int degree = 0;
    int refine = 0;
    TargetKind target = TargetKind::nodal;
    SharedNodes::Rule shared_nodes = SharedNodes::refuse;
    DistortionParams distortion;  // but for weight_exponent and power:
    std::optional<double> weight_exponent;
    std::optional<int> power;
    AugmentedLagrangianParams method;
    IdealKind ideal = IdealKind::automatic;
    Start start = Start::automatic;
    Continuation continuation = Continuation::automatic;
    LocalRepair local_repair = LocalRepair::automatic;
    double min_certified_bound = 0.02;
    double feature_angle = 30;  // degrees
    double surface_tolerance = 1e-3;  // of the local edge, of a mesh that is improved,
    bool needs_tolerance = false;     // which has not converged beyond it,
    bool needs_objective = false;     // and is the minimiser of the objective
    bool stops_valid = false;         // or ends when the mesh is valid
    Guard guard = Guard::automatic;
    std::optional<double> size_change;  // 0: sizes are free
    SurfaceKind surface = SurfaceKind::automatic;
    Split split = Split::never;
    std::optional<double> length_scale;
    LinearSolverParams linear;
    Forcing forcing = Forcing::automatic;
    bool in_time = false;  // the problem is moved to other times (move_target())
};

// With what is `auto` made definite.
inline DistortionParams distortion_of(const ProblemOptions& options) {  // but for curved_ideal
    DistortionParams params = options.distortion;
    const bool minimax = params.objective == Objective::minimax;
    const double usual = minimax ? 0 : options.method.algorithm == Algorithm::adaptive ? 0.5 : 1;
    params.weight_exponent = options.weight_exponent.value_or(usual);
    if (!minimax) params.power.p = options.power.value_or(params.power.p);
    return params;
}

// More than to solve systems is done with a mesh's Hessian where it is moved in time, and where it has pairs.
inline LinearSolverParams linear_of(const ProblemOptions& options, const PeriodicPairs& pairs) {
    LinearSolverParams params = options.linear;
    if (options.in_time || !pairs.pairs.empty()) params.half_from_blocks = std::numeric_limits<double>::infinity();
    return params;
}

// automatic only with algorithm = adaptive
inline Continuation continuation_of(const ProblemOptions& options) {
    const bool of_paper =
        options.continuation == Continuation::automatic && options.method.algorithm != Algorithm::adaptive;
    return of_paper ? Continuation::never : options.continuation;
}

}  // namespace almesh
