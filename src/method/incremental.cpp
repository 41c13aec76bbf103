// The boundary moved in parts, the distortion minimised over the nodes inside after each (fixed_boundary.cpp).
//
// A part whose start is inverted is halved, and where that does not help either the run ends with the last valid mesh
// (the paper's references 3, 13 and 23 proceed so).
#include "method/comparators.hpp"

namespace almesh {

PartResult minimise_or_stay(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    std::vector<double> moved = x;
    const PartResult result = minimise_inside(move, targets, moved);
    if (result.status != Status::invalid_start) x = std::move(moved);
    return result;
}

}  // namespace almesh
