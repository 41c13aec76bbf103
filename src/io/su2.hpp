// SU2's native mesh format, ASCII (SU2 documentation, "Mesh File"): linear triangles and tetrahedra with markers.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Whether a text begins like an SU2 mesh: its first line that is not a comment is a keyword with `=`.
bool looks_like_su2(std::string_view text);

// Node and element ids are SU2's numbers plus one. Throws InputError "path:line: message": other element types, several
// zones, numbers out of range, wrong counts, the end of the file before that of a section.
RawMesh parse_su2(std::string_view text, const std::string& path);

// x: node_count x dim positions. The mesh is linear. Nodes and elements are numbered from 0 in the mesh's order,
// markers are its boundaries and the tagged faces inside it; points and curves of tetrahedra have no place in SU2.
void write_su2(const std::string& path, const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
