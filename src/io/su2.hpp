// SU2's native mesh format, ASCII (SU2 documentation, "Mesh File"): cells with markers, in one zone or
// several. Those of a degree above 1 are for its high-order solver.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Whether a text begins like an SU2 mesh: lines KEYWORD= VALUE or comments, up to a keyword of the mesh.
bool looks_like_su2(std::string_view text);

// Node and element ids are SU2's numbers, from 0, those of the next zone after those of one. A marker is a physical
// group of its name, "2:wall" where several zones have it; of several zones each is a group "zone-2" of elements, too.
// The keywords of what the file says besides the mesh are in `sections`. Throws InputError "path:line: message": other element types,
// numbers out of range, wrong counts, the end of the file before that of a section.
RawMesh parse_su2(std::string_view text, const std::string& path);

// x: node_count x dim positions. Nodes and elements are numbered from 0 in the mesh's order, in one zone. Markers are
// those of the file, or its groups of faces on the boundary and inside; faces in no group, points and curves of
// tetrahedra, and nodes without an element have no place in SU2.
void write_su2(const std::string& path, const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
