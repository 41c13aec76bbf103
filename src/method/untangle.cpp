// The boundary set on its targets at once, and the mesh untangled: the distortion is minimised over the nodes inside
// with the regularised determinant sigma_delta of Eq. 3, which is positive for inverted elements too (Escobar and
// others, Comput. Methods Appl. Mech. Eng. 192, 2003), for smaller and smaller delta,
//
//     delta = 0.3, 0.1, 0.03, ...,   from where fixed_boundary.cpp starts,
//
// until the mesh is valid; then without regularisation. det F has no unit, and is 1 in an element that keeps its size.
// Where the mesh is not valid with the least delta, it stays inverted. From 1 on an aircraft that has pitched takes
// many times as long, from 0.1 on a plate that has turned by 180 degrees stays inverted.
#include "base/interrupt.hpp"
#include "method/comparators.hpp"

namespace almesh {
namespace {

constexpr double first_delta = 0.3, least_delta = 1e-6;
constexpr int steps_of_delta = 30;  // Newton steps for one delta

}  // namespace

PartResult untangle(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    PartResult result;
    x = move.best_start(targets, x, result.solved);
    DistortionEnergy& distortion = *move.level.energy;
    for (double delta = first_delta; delta >= least_delta && !move.is_valid(x) && !interrupted(); delta /= 3) {
        distortion.set_delta(delta);
        NewtonParams newton;
        newton.max_iterations = steps_of_delta;
        newton.reduction = 0.01;
        newton.omega_star = move.params.schedule.omega_star;
        move.minimise(newton, x, result.solved);
        distortion.set_delta(0);
    }
    if (move.is_valid(x)) minimise_with_boundary_fixed(move, x, result);
    else result.status = interrupted() ? Status::interrupted : Status::inverted;
    return result;
}

}  // namespace almesh
