// Gmsh mesh files, MSH 2.2 and 4.1, ASCII and binary, and MSH 1 and 4.0, which are read only (Gmsh reference manual,
// "MSH file format"): the cells of the table of cells, of Lagrange degree 1 to 7.
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

// The mesh in a version and in text or bytes, with the ids, tags, names, entities and kept cells of the input and the
// positions x (node_count x dim) in place of mesh.x; a 2D mesh at z = 0. Coordinates in text are the shortest decimals
// that read back to the same bits (17 digits at most). In MSH 2.2 an element has the first of its physical tags. Throws
// InputError where check_ids_fit() does. Without a format: in that of mesh.file, as far as it is written.
std::string msh_text(const Mesh& mesh, const std::vector<double>& x, const FileFormat& format);
std::string msh_text(const Mesh& mesh, const std::vector<double>& x);

// The same to a file. Throws InputError where it cannot be written.
void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x, const FileFormat& format);
void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x);

// MSH in the version of a mesh that comes from a file of that format, or in the next one that is written: 2.2 or 4.1.
FileFormat written_msh(const FileFormat& format);

// Throws InputError where an id is beyond the int that binary files before MSH 4.1 have for it.
void check_ids_fit(const Mesh& mesh, const FileFormat& format);

}  // namespace almesh
