// A target that no valid mesh can reach, told from the first subproblem.
//
// Without multipliers a mesh that meets the target has the energy of its distortion alone, which is not less than the
// minimum of E. Where that minimum is above `largest_energy` and nine tenths of it are penalty, only meshes of no use
// could meet the target, if any. The minimum counts as found to 0.1 % once a full step gains less than that.
#pragma once
#include <limits>

namespace almesh {

struct OutOfReach {
    double largest_energy = std::numeric_limits<double>::infinity();  // infinite: never tested

    // After a step of this length that took E from energy_before to energy; distortion(): its part of E now.
    template <class Distortion>
    bool found(double energy_before, double energy, double step_length, const Distortion& distortion) const {
        return energy > largest_energy && step_length >= 1 && energy_before - energy < 1e-3 * energy &&
               distortion() < 0.1 * energy;
    }
};

}  // namespace almesh
