// A smooth piece of surface through a point, of which only points around it are known: what a mesh has of a CAD
// surface. The faces of the mesh meet at angles there; nodes that slide a little must not.
#pragma once
#include <memory>
#include <vector>

#include "constraint/surface.hpp"

namespace almesh {

// The graph of a polynomial of degree up to 4 over the plane through `centre` with the given normal, zero at the centre
// and nearest to the points around it in weighted least squares. Null where these are too few for degree 2 or lie on
// fewer lines.
std::unique_ptr<Surface> fit_height_patch(int dim, const Vec<3>& centre, const Vec<3>& normal,
                                          const std::vector<Vec<3>>& points);

}  // namespace almesh
