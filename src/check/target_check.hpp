// Finds, before anything is solved, targets whose boundary is itself invalid.
//
// No mesh can follow a target on which
//   - a face is folded or degenerate: its normal n(xi), a polynomial of degree (n - 1)(p - 1) bounded in Bezier form,
//     turns 90 degrees or more away from its mean over the face (arcs of up to 180 degrees pass; FaceBend);
//   - a closed part of the boundary is mirrored, turned inside out or flattened: the area or volume it encloses, the
//     integral of x . n / dim, changes sign or vanishes;
//   - faces cross each other, or neighbours are folded flat onto each other;
//   - a closed part is moved into or out of another one, through it or past it;
//   - distinct nodes fall together.
// Crossings, folds and coincident nodes of the initial mesh (the two sides of a crack) are no faults of the target.
// Parts in different zones of a file (FileTags) are not compared.
// In 3D, non-neighbouring faces that overlap within one plane are not found.
//
// Cost: O(faces log faces), plus the bisections of faces that come close to each other, plus O(faces parts).
#pragma once
#include <array>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

// How far the normal of a face may turn.
enum class FaceBend {
    usual,  // less than 90 degrees away from its mean
    any     // as far as it stays in one half-space: a face that elements were found to be valid beside
};

struct TargetReport {
    struct Fault {
        int face;         // index into the mesh's faces
        std::string why;  // names the face by id and boundary, its centre in the mesh as read, and what is wrong
        bool by_curvature = false;  // it is folded although the flat face with the same corners is not
    };
    std::vector<Fault> faults;
    std::vector<std::array<int, 2>> crossing;  // pairs of faces; of closed parts that cross only one is a fault
    int crossed_before = -1;  // the first face that crosses another one in the initial mesh, and does so in the target
};

// target: node_count x dim positions, of which those of boundary nodes count (see at_target()), finite. open: faces
// whose position the target does not tell, because they slide or are free; they and the closed parts that they belong
// to are passed over. Empty for none.
TargetReport check_target(const Mesh& mesh, const std::vector<double>& target, const std::vector<char>& open = {},
                          FaceBend bend = FaceBend::usual);

}  // namespace almesh
