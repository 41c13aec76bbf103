// Faces that do not match: a quadrilateral of one element beside triangles of others.
#pragma once
#include "mesh/build_boundary.hpp"

namespace almesh {

// Throws InputError, naming both elements, where a boundary face is a triangle on three vertices of a quadrilateral one:
// the two sides of a face inside the domain, which seem to be boundaries as they do not match.
// Cost: O(faces log faces), none where all faces are of one type.
void refuse_hanging_faces(const MeshBuild& build);

}  // namespace almesh
