// What a mesh file of any format holds, before build_mesh() makes a Mesh of it: elements of every dimension with their
// ids, tags and lines in the file. A reader of a format fills it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct RawNode {
    long long id;
    double x[3];
    int line;  // 0: of a binary file
};

struct RawElement {
    long long id;
    std::size_t first;  // its nodes are element_nodes[first ...), in Gmsh's order
    int line;           // 0: of a binary file
    int dim, degree;  // a point has dimension 0 and degree 1
    int physical;     // tag of its physical group, the first one of several; 0: none
    int entity;       // tag of its elementary entity; 0: none
    const CellType* type = nullptr;  // none: the simplex of the dimension

    const CellType& cell() const { return type ? *type : simplex(dim); }
    int node_count() const { return cell().node_count(degree); }
};

struct RawMesh {
    std::string path;
    FileFormat format;
    std::vector<RawNode> nodes;
    CoordinateFields coordinates;  // of the first nodes, all that are in the file
    std::vector<RawElement> elements;
    std::vector<int> element_nodes;  // indices into nodes
    std::vector<PhysicalGroup> groups;
    std::vector<PeriodicSides> periodic;
    std::vector<FileEntity> entities;       // ascending by key; empty where the format has none
    int zones = 1;                          // of SU2: where there are several, the entity of an element is its zone
    std::vector<ImpliedNode> implied;       // added to the others
    std::vector<std::string> sections;      // what else the file has
    std::vector<std::string> notes;         // of what the reader has changed
};

inline bool is_before(const FileEntity& a, const FileEntity& b) { return a.key < b.key; }

// Entity (dim, tag), or nullptr where the file lists none. entities: ascending by key. Cost: O(log entities).
inline const FileEntity* find_entity(const std::vector<FileEntity>& entities, int dim, int tag) {
    const auto found =
        std::lower_bound(entities.begin(), entities.end(), EntityKey{dim, tag},
                         [](const FileEntity& entity, const EntityKey& key) { return entity.key < key; });
    return found != entities.end() && found->key == EntityKey{dim, tag} ? &*found : nullptr;
}

inline int dim_of(const RawMesh& mesh) {  // that of its elements
    int dim = 0;
    for (const RawElement& element : mesh.elements) dim = std::max(dim, element.dim);
    return dim;
}

inline int degree_of(const RawMesh& mesh) {
    int degree = 1;
    for (const RawElement& element : mesh.elements) degree = std::max(degree, element.degree);
    return degree;
}

}  // namespace almesh
