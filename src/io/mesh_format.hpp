// The mesh file formats that can be read: one table. A reader of another format is a file that fills a RawMesh, and a
// row of the table.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.hpp"
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
    {"Gmsh MSH 1, 2 to 2.2, 4.0 and 4.1, ASCII or binary", ".msh", looks_like_msh, parse_msh, true},
    {"SU2", ".su2", looks_like_su2, parse_su2},
    {"legacy VTK", ".vtk", looks_like_vtk, parse_vtk, true},
    {"Abaqus and CalculiX", ".inp", looks_like_inp, parse_inp},
    {"VTU", ".vtu", looks_like_vtu, parse_vtu, true}};

// What is read as a surface along which others slide, beside meshes.
inline constexpr MeshFormat surface_formats[] = {{"STL, as text or binary", ".stl", looks_like_stl, parse_stl, true},
                                                 {"Wavefront OBJ", ".obj", looks_like_obj, parse_obj}};

struct RefusedFormat {
    std::string_view begin, word;  // the text begins with the one and has the other
    std::string_view name, advice;
};

namespace refused {

inline constexpr std::string_view hdf5 = "\x89HDF\r\n\x1a\n", gmsh = "gmsh -3 IN -o OUT.msh",
                                  cgns = "gmsh -0 IN -format msh41 -o OUT.msh (Gmsh's own builds)",
                                  meshio = "meshio convert -o gmsh22 IN OUT.msh", exodus = "plot/to_msh.py IN OUT.msh",
                                  paraview = "ParaView: File, Save Data, as legacy VTK",
                                  stl = "STL, a surface without inside (boundaries can slide along it or go onto it)";

}  // namespace refused

// What is not read, and what makes a mesh of it that is. A row comes before those that take all of its kind.
inline constexpr RefusedFormat refused_formats[] = {
    {refused::hdf5, "CGNS", "CGNS", refused::cgns},
    {"", "ADF Database Version", "CGNS", refused::cgns},
    {refused::hdf5, "ENS_MAA", "MED", refused::meshio},
    {refused::hdf5, "VTKHDF", "VTKHDF", refused::paraview},
    {refused::hdf5, "eb_prop1", "Exodus", refused::exodus},
    {"CDF", "", "Exodus", refused::exodus},
    {refused::hdf5, "", "HDF5", refused::meshio},
    {"(", "", "Fluent", "meshio convert -i ansys -o gmsh22 IN OUT.msh"},
    {"FORMAT", "ensight", "EnSight", refused::paraview},
    {"C Binary", "", "EnSight", refused::paraview},
    {"ISO-10303-21", "", "STEP", refused::gmsh},
    {"", " S      1", "IGES", refused::gmsh},
    {"", " S0000001", "IGES", refused::gmsh},
    {"", "CASCADE Topology", "BREP", refused::gmsh},
    {"", "SetFactory(", "a script of Gmsh", refused::gmsh},
    {"solid", "facet", refused::stl,
     "gmsh -3 IN.geo -o OUT.msh, where IN.geo is `Merge \"IN.stl\"; Surface Loop(1) = {1}; Volume(1) = {1};`"},
    {"ply", "element vertex", "PLY, a surface without inside", "meshio convert IN.ply IN.stl, then as of STL"},
    {"", "\nf ", "OBJ, a surface without inside (boundaries can slide along it or go onto it)",
     "meshio convert IN.obj IN.stl, then as of STL"},
    {"", "BEGIN BULK", "Nastran", refused::meshio},
    {"", "\nGRID", "Nastran", refused::meshio},
    {"\x1f\x8b", "", "compressed by gzip", "gunzip"},
    {"\xff\xfe", "", "text in UTF-16", "iconv -f UTF-16 -t UTF-8 IN > OUT"}};

// Throws InputError where the text begins like one of these; a binary STL has the length that the number of its
// triangles gives.
inline void refuse_known(std::string_view text, const std::string& path) {
    constexpr std::size_t head = 84, triangle = 50;
    const auto triangles = text.size() < head ? 0 : from_bytes<std::uint32_t>(&text[80], std::endian::little);
    const bool is_stl = triangles > 0 && text.size() == head + triangle * triangles;
    for (const auto& [begin, word, name, advice] : refused_formats)
        if (is_stl ? name == refused::stl : text.starts_with(begin) && text.find(word) != text.npos)
            throw InputError(path, ": ", name, ", which is not read; what makes a mesh of it that is: ", advice);
}

// The format that recognises the text, or else has the file's ending. Throws InputError where there is none.
inline const MeshFormat& find_format(std::span<const MeshFormat> formats, std::string_view text,
                                     const std::string& path) {
    text = without_mark(text);
    for (const MeshFormat& format : formats)
        if (format.recognise(text)) return format;
    refuse_known(text, path);
    std::string readable;
    for (const MeshFormat& format : formats) {
        if (path.ends_with(format.ending)) return format;
        ((readable += readable.empty() ? "" : "; ") += format.name) += " (*" + std::string(format.ending) + ")";
    }
    throw InputError(path,
                     ": not a mesh file of a known format, by its first lines or its name; readable are: ", readable);
}

// The mesh in the text of the file `path`, of this format or of the one that find_format() tells; throw InputError.
inline RawMesh parse_mesh(std::string_view text, const std::string& path, const MeshFormat& format) {
    if (!format.may_be_binary) check_is_text(text, path);
    RawMesh mesh = format.parse(text, path);
    mesh.format.ending = format.ending;
    complete_serendipity(mesh);
    simplify_cells(mesh);
    return mesh;
}
inline RawMesh parse_mesh(std::string_view text, const std::string& path) {
    return parse_mesh(text, path, find_format(mesh_formats, text, path));
}

// Of a mesh that was read in a format and has other nodes now: the one to write it in.
inline FileFormat written_anew(const FileFormat& format) {
    return format.ending == ".su2" ? format : FileFormat();
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

// The same of a surface.
inline RawMesh read_surface(const std::string& path) {
    const std::string text = read_file(path);
    for (const bool by_name : {false, true})
        for (const MeshFormat& format : surface_formats)
            if (by_name ? path.ends_with(format.ending) : format.recognise(text)) return parse_mesh(text, path, format);
    return parse_mesh(text, path);
}

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
