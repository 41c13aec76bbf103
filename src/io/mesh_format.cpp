#include "io/mesh_format.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "io/msh.hpp"

namespace almesh {
namespace {

constexpr MeshFormat formats_known[] = {{"Gmsh MSH 2.2 and 4.1, ASCII", ".msh", looks_like_msh, parse_msh}};

}  // namespace

std::span<const MeshFormat> mesh_formats() { return formats_known; }

const MeshFormat& find_format(std::span<const MeshFormat> formats, std::string_view text, const std::string& path) {
    for (const MeshFormat& format : formats)
        if (format.recognise(text)) return format;
    std::string readable;
    for (const MeshFormat& format : formats) {
        if (path.ends_with(format.ending)) return format;
        ((readable += readable.empty() ? "" : "; ") += format.name) += " (*" + std::string(format.ending) + ")";
    }
    throw InputError(path + ": not a mesh file of a known format, by its first lines or its name; readable are: " +
                     readable);
}

RawMesh parse_mesh(std::string_view text, const std::string& path) {
    return find_format(mesh_formats(), text, path).parse(text, path);
}

RawMesh read_mesh(const std::string& path) { return parse_mesh(read_text_file(path), path); }

}  // namespace almesh
