// What a mesh file of any format holds, before build_mesh() makes a Mesh of it: elements of every dimension with their
// ids, tags and lines in the file. A reader of a format fills it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
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
    int dim, degree;  // of a simplex; a point has dimension 0 and degree 1
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
    int msh_version = 22;  // 22 or 41; files of other formats keep 22
    std::vector<RawNode> nodes;
    std::vector<RawElement> elements;
    std::vector<int> element_nodes;  // indices into nodes
    std::vector<PhysicalGroup> groups;
    std::vector<RawEntity> entities;  // ascending by (dim, tag); empty where the format has none
};

// Entity (dim, tag), or nullptr where the file lists none. Cost: O(log entities).
inline const RawEntity* find_entity(const RawMesh& mesh, int dim, int tag) {
    const auto key = [](const RawEntity& entity) { return std::pair(entity.dim, entity.tag); };
    const auto found = std::ranges::lower_bound(mesh.entities, std::pair(dim, tag), {}, key);
    return found != mesh.entities.end() && key(*found) == std::pair(dim, tag) ? &*found : nullptr;
}

}  // namespace almesh
