// The mesh file formats that can be read: one table. A reader of another format is a file that fills a RawMesh, and a
// row of the table.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/files.hpp"
#include "io/msh.hpp"
#include "io/su2.hpp"

namespace almesh {

struct MeshFormat {
    std::string_view name;    // for messages
    std::string_view ending;  // of file names: ".msh"
    bool (*recognise)(std::string_view text);  // by its first lines
    RawMesh (*parse)(std::string_view text, const std::string& path);  // throws InputError "path:line: message"
};

inline constexpr MeshFormat mesh_formats[] = {{"Gmsh MSH 2.2 and 4.1, ASCII", ".msh", looks_like_msh, parse_msh},
                                              {"SU2", ".su2", looks_like_su2, parse_su2}};

// The format that recognises the text, or else has the file's ending. Throws InputError where there is none.
inline const MeshFormat& find_format(std::span<const MeshFormat> formats, std::string_view text,
                                     const std::string& path) {
    for (const MeshFormat& format : formats)
        if (format.recognise(text)) return format;
    std::string readable;
    for (const MeshFormat& format : formats) {
        if (path.ends_with(format.ending)) return format;
        ((readable += readable.empty() ? "" : "; ") += format.name) += " (*" + std::string(format.ending) + ")";
    }
    throw InputError(path,
                     ": not a mesh file of a known format, by its first lines or its name; readable are: ", readable);
}

// The mesh in the text of the file `path`; throws InputError.
inline RawMesh parse_mesh(std::string_view text, const std::string& path) {
    return find_format(mesh_formats, text, path).parse(text, path);
}

// The same read from the file.
inline RawMesh read_mesh(const std::string& path) { return parse_mesh(read_text_file(path), path); }

}  // namespace almesh
