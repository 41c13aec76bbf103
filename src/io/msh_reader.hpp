// Reader of Gmsh mesh files, MSH 2.2 and 4.1, ASCII (Gmsh reference manual, "MSH file format"): points, lines,
// triangles and tetrahedra of Lagrange degree 1 to 7 as they stand in the file. build_mesh() makes a Mesh of them.
//
// Tolerated: blank lines and blanks at line ends, CR LF, any number of element tags, sections of other kinds (skipped).
// Refused with file and line: other element types, binary and partitioned meshes, other versions, ids that repeat or
// are not there, numbers that are no finite numbers, counts that do not hold.
// Cost: one pass over the text, and one sort where ids do not ascend; memory: a small multiple of the text, whatever
// the counts in it say.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct RawNode {
    long long id;
    double x[3];
    int line;
};

struct RawElement {
    long long id;
    std::size_t first;  // its nodes are element_nodes[first ...), in Gmsh's order
    int line;
    int dim, degree;  // a point has dimension 0 and degree 1
    int physical;     // tag of its physical group, the first one of several; 0: none
    int entity;       // tag of its elementary entity; 0: none
};

// An elementary entity of MSH 4.1 with all its physical groups.
struct RawEntity {
    int dim, tag;
    std::vector<int> physical;
};

struct RawMesh {
    std::string path;
    int version = 22;  // 22 or 41
    std::vector<RawNode> nodes;
    std::vector<RawElement> elements;
    std::vector<int> element_nodes;  // indices into nodes
    std::vector<PhysicalGroup> groups;
    std::vector<RawEntity> entities;  // ascending by (dim, tag); empty for MSH 2.2
};

RawMesh read_msh(const std::string& path);                          // throws InputError
RawMesh parse_msh(std::string_view text, const std::string& path);  // the same for text read from `path`

// Entity (dim, tag), or nullptr where the file lists none.
const RawEntity* find_entity(const RawMesh& mesh, int dim, int tag);

}  // namespace almesh
