// What a mesh file says besides the geometry, so that the result is written with the ids, tags and names of the input.
#pragma once
#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace almesh {

struct PhysicalGroup {
    int dim = 0, tag = 0;
    std::string name;
};

// Of group (dim, tag); "tag 7" where there is none.
inline std::string group_name(const std::vector<PhysicalGroup>& groups, int dim, int tag) {
    for (const PhysicalGroup& group : groups)
        if (group.dim == dim && group.tag == tag) return group.name;
    return "tag " + std::to_string(tag);
}

// How a mesh file is written.
struct FileFormat {
    enum class Kind { msh, su2, vtk } kind = Kind::msh;
    int msh_version = 22;  // 22, 40 or 41
    bool binary = false;

    bool operator==(const FileFormat&) const = default;
};

// Where a file has the coordinates of its nodes, for it to be written again with others (io/patch.hpp).
struct CoordinateFields {
    enum class Form { text, float64, float32 };
    Form form = Form::text;
    std::endian order = std::endian::little;  // of binary numbers
    int dim = 3;                              // coordinates that the file has of a node
    int width = 0;                            // columns of a number of text; 0: up to a blank, comma, bracket, line end
    std::vector<std::size_t> first{};         // byte of coordinate a of node i at [dim * i + a]; empty: not known
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
    std::vector<int> bounds{};    // tags of the entities around it, negative where turned
    std::array<double, 6> box{};  // least and greatest coordinates; of a point, its own twice
    bool is_partitioned = false;  // the piece of an entity in a partition, listed in a section of its own
};

// A section of an MSH file that says nothing of the mesh itself: data of its nodes and elements, periodicity, ...
struct FileSection {
    std::string name;  // "$NodeData"
    std::string text;  // word for word, with its first and last line
    bool is_before_nodes = false;
};

// A node without an element, such as the centre of an arc. It does not move.
struct LooseNode {
    long long id;
    std::array<double, 3> x;
    EntityKey entity;
};

// The cells of one type that a file has besides the elements and the boundary faces of its mesh: points, curves
// of 3D meshes, faces inside the mesh, faces without a physical group, elements and boundary faces that are given once
// more, as those of several groups are in MSH 2.2. They move with the mesh and are written again; the method does not
// see them.
struct KeptCells {
    std::vector<int> nodes;    // cells x nodes of the mesh's degree, in Gmsh's order; -1 - k: loose[k]
    std::vector<int> element;  // one that has all nodes of the cell; -1: of a loose node
    std::vector<long long> id;
    std::vector<int> physical, entity;  // tags, as those of FileTags

    int count() const { return static_cast<int>(id.size()); }
};

// A marker of an SU2 file, and the lines that come before its faces: a key SEND_RECV, rows of points.
struct FileMarker {
    std::string name, group{}, lines{};  // name: in the file, group: the physical one here
    int points = 0;                      // rows among the lines
};

// An SU2 file in its order: lines that are kept as they are, and the sections NELEM, NPOIN and NMARK of each zone.
struct FilePiece {
    std::string text;  // the lines, or the keyword of the section
    int zone = 0;      // from 1; 0: lines
    std::vector<FileMarker> markers{};
};

inline constexpr int not_in_file = -1;  // physical tag of faces that are not written

struct FileTags {
    std::vector<long long> node_id, element_id, face_id;
    std::vector<int> element_physical, face_physical;  // tag of the physical group, the first of several; 0: none
    std::vector<int> element_entity, face_entity;      // tag of the elementary entity; 0: none
    std::vector<std::uint8_t> element_winding, face_winding;  // by the file's order of vertices (winding.hpp); or empty
    std::vector<EntityKey> node_entity;                // of the first nodes; the others are on none that is known
    double z = 0;                                      // of the plane of a 2D mesh
    std::vector<LooseNode> loose;
    std::vector<FileEntity> entities;  // ascending by key, of MSH 4
    std::vector<FileSection> sections;  // written again in the same format; empty once elements are others
    std::vector<PhysicalGroup> groups;
    std::vector<FilePiece> pieces;  // of SU2
    int zones = 1;  // of SU2: several are meshes of their own, which may touch and lie over each other
    FileFormat format;
    std::string comment;  // one line, that is written as such; of what has been read: empty

    int zone(int element) const { return zones > 1 ? element_entity[element] : 0; }  // from 1; 0: there is only one
};

}  // namespace almesh
