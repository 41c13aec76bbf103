// Gmsh mesh files, MSH 1 to 2.2, 4.0 and 4.1, ASCII and binary; 2.2 in ASCII is written (Gmsh reference manual, "MSH
// file format"): the cells of the table of cells, of Lagrange degree 1 to 7.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

// Whether a text begins like a Gmsh mesh file.
bool looks_like_msh(std::string_view text);

// Reads the contents of the file `path`, binary ones in either order of bytes. Tolerated: blank lines and blanks at
// line ends, CR LF, any number of element tags, parameters of nodes (left out). Sections of other kinds are passed over.
// Throws InputError "path:line: message", of a binary file "path: $Nodes, byte 812: message": other element types,
// other versions, ids that repeat or are not there, numbers that are not finite, wrong counts, the
// end of the file before that of a section. Cost: one pass over the text; memory: a small multiple of it, whatever the
// counts in it say.
RawMesh parse_msh(std::string_view text, const std::string& path);

// The mesh as MSH 2.2 in text, with the ids, tags, names and kept cells of the input and the positions x (node_count x
// dim) in place of mesh.x; a 2D mesh in the plane of the file. Coordinates are the shortest decimals that read back to
// the same bits (17 digits at most). An element of several physical groups stands there once for each.
std::string msh_text(const Mesh& mesh, const std::vector<double>& x);

// The same to a file. Throws InputError where it cannot be written.
void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x);

}  // namespace almesh
