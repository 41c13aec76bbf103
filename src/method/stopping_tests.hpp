// When Newton's method ends, besides at |grad E| <= omega.
//
// Out of reach, of functionals without multipliers: a mesh that meets the target has the energy of its distortion
// alone, which is not less than the minimum of E. Where that minimum is above `largest_energy` and nine tenths of it
// are penalty, only meshes of no use could meet the target on this way. The minimum counts as found to 0.1 % once a
// full step gains less than that. What the penalty makes of the best approximation error is in every E, and not counted.
//
// Attainable accuracy: with a large penalty, |grad E| cannot fall below some 1e-16 mu, and once the decrease that a
// step promises is below the rounding error of E, energies can no longer be compared (line_search.hpp). From then on
// the iteration goes on only while each step halves |grad E|.
//
// Futile steps: nodes hang where the surface along which they slide has a kink, or elements are jammed, and several
// steps in a row are next to none and gain nothing.
//
// Invisible steps: where nodes slide and nothing else holds the mesh, E hardly changes along some directions. A disc
// turns, and in 2D all conformal maps of it onto itself keep eta. After three full steps in a row, or twelve short
// ones, that together gain less than can be seen, the multipliers change first; once the constraint holds, Algorithm 1
// goes on without this test.
//
// Local minimisations (local_elimination.hpp) need no minimum: their last step is one that gains too little for
// another, or takes them beyond the work that they may do.
#pragma once
#include <optional>
#include <vector>

#include "method/newton.hpp"

namespace almesh {

// After a step of this length that took E from energy_before to energy; distortion: its part of E now.
bool is_out_of_reach(double largest_energy, double energy_before, double energy, double step_length,
                     double distortion);

// by_rounding: what the line search says of the step that took |grad E| from g_before to g.
bool at_attainable_accuracy(bool by_rounding, double g_before, double g, double omega);

class StoppingTests {
public:
    explicit StoppingTests(const NewtonParams& params) : params_(params) {}

    // Whether the step from `before` to `at` is the last of a local minimisation.
    bool is_last(const NewtonResult& before, const NewtonResult& at) const;
    // Whether a minimisation ends, and how: before a step from the iterate `at`,
    std::optional<Status> before_step(const NewtonResult& at) const;
    // and after one from `before` to `at`, or none.
    std::optional<Status> after_step(const NewtonStep& step, const NewtonResult& before, const NewtonResult& at,
                                     const Functional& E, const std::vector<double>& x);

private:
    const NewtonParams& params_;
    int futile_steps_ = 0;  // in a row
    double invisible_gain_ = 0, invisible_length_ = 0;  // of the steps since the last visible gain
};

}  // namespace almesh
