// Surfaces inside a mesh and whole volumes as boundaries: an inner boundary is a set of faces between two elements,
// each face once, and has a motion like an outer one. Of a volume whose nodes all follow a motion it is every side of
// its elements.
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// Some cells of a mesh, of a physical group.
struct GroupCells {
    std::string name;
    std::vector<int> cells;
};

// The physical groups that have faces inside the mesh, with these among its kept_faces(), and those of its elements,
// each with its elements, ascending; in the order of their first cells.
std::vector<GroupCells> inner_groups(const Mesh& mesh);
std::vector<GroupCells> volume_groups(const Mesh& mesh);

// What stands for a volume among the groups of a boundary.
inline std::string volume_group(const std::string& name) { return "volume " + name; }

// The faces of the mesh that are written to a file, the first ones of each type.
inline std::vector<ElementGroup> faces_in_file(const Mesh& mesh) {
    std::vector<ElementGroup> groups = mesh.face_groups();
    for (auto& [cell, first, count, start] : groups)
        while (count > 0 && mesh.file.face_physical[first + count - 1] == not_in_file) --count;
    return groups;
}

// Makes boundaries of the faces inside the mesh that belong to the groups, taken out of Mesh::kept, of all sides of
// the elements of the volumes, and, if wanted, of all sides between elements of different groups: "between solid and
// fluid". Sides of volumes that are on another boundary belong to the volume too. Neighbouring faces of an inner
// boundary are oriented alike. Those that the file does not have get the physical tag not_in_file.
// Cost: O(elements log elements).
void make_inner_boundaries(Mesh& mesh, const std::vector<std::string>& groups, const std::vector<std::string>& volumes,
                           bool between_groups = false);

}  // namespace almesh
