// Where rounding ends Newton's method.
//
// With a large penalty, |grad E| cannot fall below some 1e-16 mu, and once the decrease that a step promises is below
// the rounding error of E, energies can no longer be compared (line_search.hpp). From then on the iteration goes on
// only while each step halves |grad E|; else |grad E| is as small as it gets.
#pragma once

namespace almesh {

// by_rounding: what the line search says of the step that took |grad E| from g_before to g.
inline bool at_rounding_floor(bool by_rounding, double g_before, double g, double omega) {
    return by_rounding && g > 0.5 * g_before && g > omega;
}

}  // namespace almesh
