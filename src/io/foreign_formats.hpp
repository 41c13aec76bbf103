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

// VTK's XML files of unstructured grids, as VTK, ParaView, meshio and pyvista write them: numbers as text, in base64 or
// appended, as they are or compressed by zlib. Ids are VTK's numbers plus one. An array of whole numbers of the cells,
// such as `material`, makes the group "material 5" of the cells that have 5 there, where it has at most 256 different
// ones. Refused: other kinds of grids, several pieces with points, other compressions.
bool looks_like_vtu(std::string_view text);
RawMesh parse_vtu(std::string_view text, const std::string& path);

// Surfaces alone, along which a boundary slides: STL, as text or binary, whatever its first word is, and OBJ, polygons
// of which become triangles around their first vertex, and lines of which serve in 2D. Groups: of OBJ, and the named
// solids of STL as text. Each corner of an STL is a node of its own (mesh/surface_mesh.hpp).
bool looks_like_stl(std::string_view text);
RawMesh parse_stl(std::string_view text, const std::string& path);
bool looks_like_obj(std::string_view text);
RawMesh parse_obj(std::string_view text, const std::string& path);

}  // namespace almesh
