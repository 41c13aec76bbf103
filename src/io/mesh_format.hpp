// The mesh file formats that can be read: one table. A reader of another format is a file that fills a RawMesh, and a
// row of the table.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "mesh/raw_mesh.hpp"

namespace almesh {

struct MeshFormat {
    std::string_view name;    // for messages
    std::string_view ending;  // of file names: ".msh"
    bool (*recognise)(std::string_view text);  // by its first lines
    RawMesh (*parse)(std::string_view text, const std::string& path);  // throws InputError "path:line: message"
};

std::span<const MeshFormat> mesh_formats();

// The format that recognises the text, or else has the file's ending. Throws InputError where there is none.
const MeshFormat& find_format(std::span<const MeshFormat> formats, std::string_view text, const std::string& path);

RawMesh read_mesh(const std::string& path);                          // throws InputError
RawMesh parse_mesh(std::string_view text, const std::string& path);  // the same of text read from `path`

}  // namespace almesh
