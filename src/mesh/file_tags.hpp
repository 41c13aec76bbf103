// What a mesh file says besides the geometry, so that the result is written with the ids, tags and names of the input.
#pragma once
#include <bit>
#include <compare>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

struct PhysicalGroup {
    int dim = 0, tag = 0;
    std::string name;
    bool is_entity = false;  // no group, but an elementary entity of a file without groups of this dimension
};

// Of group (dim, tag); "tag 7" where there is none.
inline std::string group_name(const std::vector<PhysicalGroup>& groups, int dim, int tag) {
    for (const PhysicalGroup& group : groups)
        if (group.dim == dim && group.tag == tag) return group.name;
    return "tag " + std::to_string(tag);
}

// How a mesh file is written. Of MSH, 2.2 in text is written where the mesh is not that of a file.
struct FileFormat {
    std::string_view ending = ".msh";  // of names of its files, which tells the format (io/mesh_format.hpp)
    int msh_version = 22;              // 10, 22, 40 or 41
    bool binary = false;

    bool operator==(const FileFormat&) const = default;
    long long first_id() const { return ending == ".su2" ? 0 : 1; }  // of nodes and elements numbered by their order
};

// Where a file has the coordinates of its nodes, for it to be written again with others (io/patch.hpp).
struct CoordinateFields {
    enum class Form { text, float64, float32 };
    Form form = Form::text;
    std::endian order = std::endian::little;  // of binary numbers
    int dim = 3;                              // coordinates that the file has of a node
    int width = 0;                            // columns of a number of text; 0: up to a blank, comma, bracket, line end
    int most = 0;                             // characters of a free number that its readers take; 0: all
    // If not null, how the file is rewritten whose coordinates are in a block with a coding, where `first` counts.
    std::string (*rewritten)(std::string_view file, CoordinateFields fields, const std::vector<double>& x) = nullptr;
    std::vector<std::size_t> first{};  // byte of coordinate a of node i at [dim * i + a]; empty: not known
};

// An elementary entity of the geometry, a point, curve, surface or volume, by its dimension and tag.
struct EntityKey {
    int dim = -1, tag = 0;  // dim -1: none

    auto operator<=>(const EntityKey&) const = default;
};

// What an MSH 4 file says of an entity.
struct FileEntity {
    EntityKey key;
    std::vector<int> physical{};  // tags of its physical groups
};

// Two sides that a file calls periodic, points of one being R x + t for those of the other, its master.
struct PeriodicSides {
    int dim, slave, master;  // dimension and tags of their entities; tags 0: the file does not name the sides
    Mat<3> R;                // a rotation
    Vec<3> t;

    Vec<3> image(const Vec<3>& x) const { return Vec<3>{dot(R[0], x), dot(R[1], x), dot(R[2], x)} + t; }
};

// A node that the file does not have, in the middle of a cell of 8, 20, 15 or 13 nodes: a sum of others.
struct ImpliedNode {
    int node;
    std::vector<std::pair<int, double>> terms;  // nodes and their weights, whose sum is 1
};

// The cells of one type that a file has besides the elements and the boundary faces of its mesh: points, curves
// of 3D meshes, faces inside the mesh, elements and boundary faces that are given once more, as those of several groups
// are in MSH 2.2. They move with the mesh and are written again; the method does not see them.
struct KeptCells {
    std::vector<int> nodes;    // cells x nodes of the mesh's degree, in Gmsh's order
    std::vector<int> element;  // one that has all nodes of the cell; -1: not known, of a point
    std::vector<long long> id;
    std::vector<int> physical, entity;  // tags, as those of FileTags

    int count() const { return static_cast<int>(id.size()); }
};

inline constexpr int not_in_file = -1;  // physical tag of faces that are not written

struct FileTags {
    std::vector<long long> node_id, element_id, face_id;
    std::vector<int> element_physical, face_physical;  // tag of the physical group, the first of several; 0: none
    std::vector<int> element_entity, face_entity;      // tag of the elementary entity; 0: none
    std::vector<int> turned;   // of the mesh as it was read: elements whose nodes the file has the other way round
    bool has_elements = true;  // that one's, as they are: none was completed or simplified, or is given more than once
    double z = 0;                                      // of the plane of a 2D mesh
    int loose = 0;                                     // nodes without an element, which do not move
    std::vector<FileEntity> entities;  // ascending by key, of MSH 4
    std::vector<std::string> sections;  // what the file has besides the mesh: "$NodeData", "NPERIODIC", ...
    std::vector<PhysicalGroup> groups;
    std::vector<PeriodicSides> periodic;
    int zones = 1;  // of SU2: several are meshes of their own, which may touch and lie over each other
    FileFormat format;
    CoordinateFields coordinates;      // of the first nodes of the mesh, and in its dimension; empty: it has others, too
    std::vector<ImpliedNode> implied;  // the last ones, beside them
    std::string comment;  // one line, that is written as such; of what has been read: empty

    // Whether the mesh has the nodes of the file, which then can be written again with other coordinates.
    bool can_be_patched() const { return !coordinates.first.empty(); }
    void leave_file() {
        coordinates.first.clear();
        implied.clear();
    }

    int zone(int element) const { return zones > 1 ? element_entity[element] : 0; }  // from 1; 0: there is only one
};

}  // namespace almesh
