// Reader of Gmsh mesh files, MSH 2.2 and 4.1, ASCII (Gmsh reference manual, "MSH file format"): points, lines,
// triangles and tetrahedra of Lagrange degree 1 to 7 as they stand in the file. build_mesh() makes a Mesh of them.
//
// Tolerated: blank lines and blanks at line ends, CR LF, any number of element tags, sections of other kinds (skipped).
// Refused with file and line: other element types, binary and partitioned meshes, other versions, ids that repeat or
// are not there, numbers that are no finite numbers, counts that do not hold.
// Cost: one pass over the text, and one sort where ids do not ascend; memory: a small multiple of the text, whatever
// the counts in it say.
#pragma once
#include <string>
#include <string_view>

#include "mesh/raw_mesh.hpp"

namespace almesh {

RawMesh read_msh(const std::string& path);                          // throws InputError
RawMesh parse_msh(std::string_view text, const std::string& path);  // the same for text read from `path`

}  // namespace almesh
