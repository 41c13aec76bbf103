// The second half of build_mesh(): the boundary faces, which are the faces of one element only, with the tags of the
// file's face elements; and what both halves share.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// A mesh being built from a file.
struct MeshBuild {
    const RawMesh& raw;
    std::vector<std::string>& notes;
    Mesh mesh;
    std::vector<int> elements, faces;  // elements and faces of the mesh in file order: indices into raw.elements
    std::vector<int> node;             // node of the mesh by raw node, -1: none
    std::vector<int> kept;             // what else there is: indices into raw.elements
    std::vector<int> repeated{};       // elements that have the vertices of others: indices into raw.elements

    const RawElement& element(int e) const { return raw.elements[elements[e]]; }
    const RawElement& face(int f) const { return raw.elements[faces[f]]; }
    std::string node_ids(const int* nodes, int count) const;  // of nodes of the mesh, separated by commas

    // Throw InputError "path: message" and "path:line: element 12 message", without the line of a binary file.
    template <class... Parts>
    [[noreturn]] void refuse(const Parts&... message) const {
        throw InputError(raw.path, ": ", message...);
    }
    template <class... Parts>
    [[noreturn]] void refuse(const RawElement& element, const Parts&... message) const {
        const std::string line = element.line ? concat(":", element.line) : "";
        throw InputError(raw.path, line, ": element ", element.id, " ", message...);
    }
};

std::string name_of(const RawElement& element);  // "element 12 (line 40)", "element 12" of a binary file

// Fills the faces of the mesh, whose nodes and elements are there already. Faces in no group are the boundary
// `untagged` or, if no face is in a group, `boundary` (`boundary-1`, ... for several connected parts); those that the
// file does not have get the physical tag not_in_file. Faces inside the mesh, and repeated ones, go to MeshBuild::kept.
// Returns the pairs of elements that lie on the same side of their common face: none in a valid mesh. If elements are
// repeated, it only fills MeshBuild::repeated. Throws InputError if faces and elements are inconsistent (see
// build_mesh()).
//
// Faces are matched by their vertices: those with the same lowest vertex are sorted. Cost: O(elements log(elements
// around a vertex)) time, in parallel; 32 bytes per tetrahedron (24 per triangle).
std::vector<std::array<int, 2>> fill_boundary(MeshBuild& build);

// Fills Mesh::kept from MeshBuild::kept, once elements and nodes are there. What is not in the mesh is left out, with a
// note of curves and faces. Cost: O(elements + kept cells * elements around a vertex).
void fill_kept(MeshBuild& build);

}  // namespace almesh
