// Mesh files of other programs that are read, to be written again with other coordinates (patch.hpp). Whether a text is
// of a format is told by its first lines. All throw InputError "path:line: message".
#pragma once
#include <string>
#include <string_view>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Abaqus and CalculiX ("CalculiX CrunchiX user's manual"): solids, or where there are none, elements in the plane.
// Element sets are groups, surfaces of element sides are boundaries; where there is neither a surface nor a set of
// faces, so is a node set that has all nodes of some outer faces, but not of all. Other keywords are passed over.
// Refused: solids of other types, several parts or instances, nodes and elements that are generated.
bool looks_like_inp(std::string_view text);
RawMesh parse_inp(std::string_view text, const std::string& path);

}  // namespace almesh
