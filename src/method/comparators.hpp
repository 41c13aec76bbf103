// Other ways to move a mesh, to be compared with the augmented Lagrangian method: those that set the nodes of the
// boundary on their targets, at once or in load increments, and find positions for the nodes inside.
//
//   harmonic        the displacement is extended inside as a harmonic function (harmonic.cpp)
//   elasticity      as that of an elastic solid, stiffer where elements are small (elasticity.cpp)
//   fixed_boundary  the distortion is minimised with the boundary fixed (fixed_boundary.cpp)
//   incremental     the same, load increment by load increment (incremental.cpp)
//   untangle        the same with a regularised distortion, which inverted elements may have (untangle.cpp)
//
// penalty.cpp is a schedule of the augmented Lagrangian loop. All of them end with an AlResult, so that the same
// certificate, report and files follow. In it an iteration is a load increment, and `newton_iterations` counts
// Newton steps or linear solves.
#pragma once
#include <functional>
#include <vector>

#include "method/continuation.hpp"
#include "method/functional.hpp"
#include "method/linear_extension.hpp"

namespace almesh {

// Whether the method sets the boundary on its target: all but the augmented Lagrangian one and penalty.
bool sets_boundary(MovingMethod method);

// x: node_count x dim, the ideal mesh on entry; on return the mesh that the method came to, which is inverted where the
// status is `inverted`, or `invalid_start` of fixed_boundary. increments: how many of the load. observe_stage: called
// after each load increment but the last, whose Newton steps are observed. Adds to newton.time.
AlResult move_with_boundary(const Level& level, Newton& newton, const MethodParams& params, int increments,
                            std::vector<double>& x, const AlObserver& observer = {},
                            const StageObserver& observe_stage = {});

// One run of such a method, as its parts see it.
struct BoundaryMove {
    const Level& level;
    Newton& newton;
    const MethodParams& params;
    LinearExtension extension;
    std::vector<char> fixed;  // per node: whether it is on the boundary
    double omega = 0;        // tolerance of |grad E| inside, for Newton's method
    std::function<void(const NewtonStep&)> observe_step = {};

    BoundaryMove(const Level& level_, Newton& newton_, const MethodParams& params_);

    // For a load increment; the Newton steps of the last one are observed, those of others loosely converged.
    void prepare(bool last, double part, const AlObserver& observer);
    // x with the boundary nodes at `targets`, nodes of the constraint x dim.
    std::vector<double> with_boundary(const std::vector<double>& targets, std::vector<double> x) const;
    // The same with the displacement extended inside; counts its solve in `steps`, whose status tells where it failed:
    // the nodes inside then stay.
    std::vector<double> extended(StiffnessAt stiffness, const std::vector<double>& targets,
                                 const std::vector<double>& x, NewtonResult& steps);
    bool is_valid(const std::vector<double>& x) const;  // certified everywhere in every element
    int inverted(const std::vector<double>& x) const;   // elements that are so at a quadrature point
    // The first valid mesh with the boundary at `targets` of: x with the displacement extended by elasticity, as a
    // harmonic function, not at all; where none is, the one of them with the fewest inverted elements.
    std::vector<double> best_start(const std::vector<double>& targets, const std::vector<double>& x,
                                   NewtonResult& steps);
    AugmentedFunctional functional() const;             // the distortion, the boundary fixed
    // Newton's method on it, from x; adds to what `sum` counts.
    void minimise(const NewtonParams& wanted, std::vector<double>& x, NewtonResult& sum);
};

// What came of one load increment; `solved` counts all its Newton steps and linear solves.
struct PartResult {
    Status status = Status::converged;
    NewtonResult solved = {};
};

// Each takes the boundary of x to `targets`.
PartResult minimise_inside(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x);
PartResult minimise_or_stay(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x);
PartResult untangle(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x);

// Newton's method to the tolerance omega, from x, which is valid.
void minimise_with_boundary_fixed(BoundaryMove& move, std::vector<double>& x, PartResult& result);
Stiffness harmonic_stiffness(double jacobian);
Stiffness elastic_stiffness(double jacobian);

}  // namespace almesh
