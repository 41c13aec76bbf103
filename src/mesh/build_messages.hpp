// Words that the errors and notes of build_mesh() share.
#pragma once
#include <string>

#include "base/error.hpp"
#include "mesh/mesh.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

[[noreturn]] inline void refuse(const RawMesh& raw, const std::string& message) {
    throw InputError(raw.path + ": " + message);
}

// "path:line: element 12 <message>"
[[noreturn]] inline void refuse(const RawMesh& raw, const RawElement& element, const std::string& message) {
    throw InputError(raw.path + ":" + std::to_string(element.line) + ": element " + std::to_string(element.id) + " " +
                     message);
}

inline std::string name_of(const RawElement& element) {
    return "element " + std::to_string(element.id) + " (line " + std::to_string(element.line) + ")";
}

inline std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

inline std::string dimension_name(int dim) { return dim == 1 ? "curve" : dim == 2 ? "surface" : "volume"; }

// Ids of nodes of the mesh, separated by commas.
inline std::string node_ids(const Mesh& mesh, const int* node, int count) {
    std::string text;
    for (int v = 0; v < count; ++v) text += (v ? ", " : "") + std::to_string(mesh.file.node_id[node[v]]);
    return text;
}

}  // namespace almesh
