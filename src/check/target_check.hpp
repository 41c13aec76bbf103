// Finds, before anything is solved, targets whose boundary is itself invalid.
//
// No mesh can follow a target on which
//   - a face is folded or degenerate: its normal n(xi), a polynomial of degree (n - 1)(p - 1) bounded in Bezier form,
//     turns 90 degrees or more away from its mean over the face (arcs of up to 180 degrees pass; FaceBend);
//   - a closed part of the boundary is mirrored, turned inside out or flattened: the area or volume it encloses, the
//     integral of x . n / dim, changes sign or vanishes;
//   - faces cross each other, or neighbours are folded flat onto each other;
//   - a closed part is moved into or out of another one, through it or past it;
//   - distinct nodes fall together, on the side where the elements are.
// Crossings, folds and coincident nodes of the initial mesh are no faults of the target. Nor is contact from outside,
// up to touching_distance of patch.hpp: the lips of a crack may close, open and slide. Two faces with equal nodes count
// as glued together, like the sides of two elements inside the mesh. Other faces that touch are listed. Faces that may
// overlap (Overlaps) are not compared. In 3D, neighbours are not tested for crossing away from what they share.
//
// Cost: O(faces log faces), plus the bisections of faces that come close to each other, plus O(faces parts).
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// How far the normal of a face may turn.
enum class FaceBend {
    usual,  // less than 90 degrees away from its mean
    any,    // as far as it stays in one half-space: a face that elements were found to be valid beside
    of_valid  // the same, of a mesh all of whose elements are valid: what is folded flat closes a gap outside then,
              // and parts that moved through one another overlap
};

struct TargetReport {
    struct Fault {
        int face;         // index into the mesh's faces
        std::string why;  // names the face by id and boundary, its centre in the mesh as read, and what is wrong
        bool by_curvature = false;  // it is folded although the flat face with the same corners is not
    };
    std::vector<Fault> faults;
    std::vector<std::array<int, 2>> crossing;  // pairs of faces; of closed parts that cross only one is a fault
    std::vector<std::array<int, 2>> touching;  // pairs of faces that may touch beside what they share
    std::vector<int> place;   // per node: the first node at the same place in the target
    std::vector<char> glued;  // per face: whether there is one more with the same places and the opposite normal
    std::array<int, 2> crossed_before = {-1, -1};  // the first faces that cross in the initial mesh and in the target
};

// What may overlap: elements and faces of different zones of a file (FileTags), and those with vertices on two
// boundaries that are declared to be in contact (Mesh::contact), or with vertices on one that is in contact with
// itself.
class Overlaps {
public:
    explicit Overlaps(const Mesh& mesh);
    bool elements(int e, int other) const;
    bool faces(int f, int g) const;

private:
    const Mesh& mesh_;
    std::vector<std::array<int, 2>> of_node_;  // contact and boundary of each node, where there are contacts

    bool may(int e, std::span<const int> vertices, int other, std::span<const int> of_other) const;
};

// The contact of the boundary of a face, 0: none.
inline int contact_of(const Mesh& mesh, int f) {
    return mesh.contact.empty() ? 0 : mesh.contact[mesh.face_boundary[f]];
}

// target: node_count x dim positions, of which those of boundary nodes count (see at_target()), finite. open: faces
// whose position the target does not tell, because they slide or are free; they and the closed parts that they belong
// to are passed over. Empty for none.
TargetReport check_target(const Mesh& mesh, const std::vector<double>& target, const std::vector<char>& open = {},
                          FaceBend bend = FaceBend::usual);

}  // namespace almesh
