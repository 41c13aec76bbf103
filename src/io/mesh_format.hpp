// The mesh file formats that can be read: one table. A reader of another format is a file that fills a RawMesh, and a
// row of the table.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/files.hpp"
#include "io/msh.hpp"
#include "io/foreign_cells.hpp"
#include "io/foreign_formats.hpp"
#include "io/su2.hpp"
#include "io/vtk.hpp"
#include "mesh/build.hpp"

namespace almesh {

struct MeshFormat {
    std::string_view name;    // for messages
    std::string_view ending;  // of file names; no two rows have the same
    bool (*recognise)(std::string_view text);  // by its first lines
    RawMesh (*parse)(std::string_view text, const std::string& path);  // throws InputError "path:line: message"
    bool may_be_binary = false;
};

inline constexpr MeshFormat mesh_formats[] = {
    {"Gmsh MSH 1, 2.2, 4.0 and 4.1, ASCII or binary", ".msh", looks_like_msh, parse_msh, true},
    {"SU2", ".su2", looks_like_su2, parse_su2},
    {"legacy VTK", ".vtk", looks_like_vtk, parse_vtk, true},
    {"Abaqus and CalculiX", ".inp", looks_like_inp, parse_inp},
    {"VTU", ".vtu", looks_like_vtu, parse_vtu, true}};

// The format that recognises the text, or else has the file's ending. Throws InputError where there is none.
inline const MeshFormat& find_format(std::span<const MeshFormat> formats, std::string_view text,
                                     const std::string& path) {
    text = without_mark(text);
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
    const MeshFormat& format = find_format(mesh_formats, text, path);
    if (!format.may_be_binary) check_is_text(text, path);
    RawMesh mesh = format.parse(text, path);
    mesh.format.ending = format.ending;
    complete_serendipity(mesh);
    simplify_cells(mesh);
    return mesh;
}

// Of a mesh that was read in a format and has other nodes now: the one to write it in.
inline FileFormat written_anew(const FileFormat& format) {
    return format.ending == ".su2" ? format : written_msh(format);
}

// Of the names of final meshes, which are not those of the VTK files of results.
inline std::string ending_of_final(const FileFormat& format) {
    return (format.ending == ".vtk" ? "-mesh" : "") + std::string(format.ending);
}

// "MSH 4.1, binary".
inline std::string to_string(const FileFormat& format) {
    for (const MeshFormat& row : mesh_formats)
        if (format.ending == row.ending && format.ending != ".msh") return std::string(row.name);
    return concat("MSH ", format.msh_version / 10, ".", format.msh_version % 10,
                  format.binary ? ", binary" : ", ASCII");
}

// The same read from the file.
inline RawMesh read_mesh(const std::string& path) { return parse_mesh(read_file(path), path); }

// The same with the ids that its nodes and elements have in files of another format.
inline RawMesh read_mesh(const std::string& path, const FileFormat& numbered_as) {
    RawMesh mesh = read_mesh(path);
    for (RawNode& node : mesh.nodes) node.id += numbered_as.first_id() - mesh.format.first_id();
    for (RawElement& element : mesh.elements) element.id += numbered_as.first_id() - mesh.format.first_id();
    return mesh;
}

// As it is in the file, with inverted elements if it has any. notes: what was corrected in it.
inline Mesh read_as_it_is(const std::string& path, std::vector<std::string>& notes) {
    return build_mesh(read_mesh(path), notes, Folds::keep);
}

}  // namespace almesh
