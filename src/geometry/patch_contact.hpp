// Whether two polynomial patches cross: curves in the plane, triangles in space. Touching, at a shared corner or
// anywhere else, is not crossing; nor is overlapping in a common plane.
#pragma once
#include "geometry/patch.hpp"

namespace almesh {

enum class Contact { apart, crossing, undecided };

// Undecided: patches so nearly touching along a line that a few thousand bisections do not tell.
Contact patch_contact(const Bernstein& basis, const Patch& a, const Patch& b);

}  // namespace almesh
