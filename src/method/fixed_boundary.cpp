// The boundary set on its targets at once, and the distortion minimised over the nodes inside.
//
// The minimisation needs a valid mesh to start from. Tried are, in this order, the displacement of the boundary
// extended by elasticity, as a harmonic function, and the nodes inside where they are. Where all three are inverted
// there is nothing to minimise, since the energy is infinite: the run ends with the one that has the fewest inverted
// elements.
#include "method/comparators.hpp"

namespace almesh {

std::vector<double> BoundaryMove::best_start(const std::vector<double>& targets, const std::vector<double>& x,
                                             NewtonResult& steps) {
    std::vector<double> best;
    for (const StiffnessAt stiffness : {elastic_stiffness, harmonic_stiffness, StiffnessAt()}) {
        std::vector<double> start = stiffness ? extended(stiffness, targets, x, steps) : with_boundary(targets, x);
        if (is_valid(start)) return start;
        if (best.empty() || inverted(start) < inverted(best)) best = std::move(start);
    }
    return best;
}

PartResult minimise_inside(BoundaryMove& move, const std::vector<double>& targets, std::vector<double>& x) {
    PartResult result;
    x = move.best_start(targets, x, result.solved);
    if (move.is_valid(x)) minimise_with_boundary_fixed(move, x, result);
    else result.status = Status::invalid_start;
    return result;
}

}  // namespace almesh
