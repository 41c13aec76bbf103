// Why a run failed, and where: a node or an element of its last mesh. Each kind of diagnosis is found from that mesh
// alone, and says no more than what it measures.
//
//   off_target  the boundary node farthest from its target, in heights of the cells at it
//   unbalanced  the node with the largest part of |grad E|
//   distorted   the element with the largest distortion
//   invalid     the element with the lowest certified bound
//   overlap     the node that its elements go around more than once, or a face at which the boundary crosses itself
//
// Cost: O(nodes + elements), little beside one evaluation of the energy.
#pragma once
#include <array>
#include <limits>
#include <vector>

#include "mesh/restriction.hpp"

namespace almesh {

struct BoundaryTarget;
class Constraint;
struct Injectivity;
struct Mesh;

enum class DiagnosisKind { none, off_target, unbalanced, distorted, invalid, overlap };
const char* to_string(DiagnosisKind kind);

struct Diagnosis {
    DiagnosisKind kind = DiagnosisKind::none;
    int node = -1;      // of the mesh; -1 where an element alone is in the way
    int element = -1;   // that element, or of those at the node the one with the largest distortion
    int boundary = -1;  // index into mesh.boundaries: of the node; where it is on none, the boundary nearest to it
    bool on_boundary = false;        // the node, or a vertex of the element alone
    std::array<double, 3> position{};  // of the node, or the centre of the element alone; in 2D the third is 0
    std::array<double, 3> target{};  // off_target: of the node
    double distance = 0;             // off_target: from the target
    double heights = 0;              // off_target: the same over the height of the cells at the node
    // off_target: part of the straight way from the ideal mesh that it has come nearer, < 0 where it is farther than
    // it was; nan where it slides, or should have stayed.
    double way = std::numeric_limits<double>::quiet_NaN();
    double share = 0;  // unbalanced: length of the node's part of grad E over |grad E|
};

// The last mesh of a run and what is known of it. All positions are in one unit, nodes x dim.
struct LastMesh {
    const Mesh& mesh;
    const std::vector<double>&ideal, &x;
    const Constraint& constraint;
    const BoundaryTarget& target;
    const std::vector<double>& distortion;  // largest eta of each element
};

Diagnosis farthest_off_target(const LastMesh& last);  // kind none where every node is at its target
Diagnosis least_balanced(const LastMesh& last, const std::vector<double>& gradient);  // nodes x dim; none where zero
Diagnosis most_distorted(const LastMesh& last);
Diagnosis least_valid(const LastMesh& last, const std::vector<double>& bound);  // certified, per element
Diagnosis overlapping(const LastMesh& last, const Injectivity& found);  // none where that has no position

// The elements within some rings around the diagnosis: those with a node of it, those with a node of these, and so on;
// fewer rings, but one at least, where they have more than `most` elements.
Restriction neighbourhood(const Mesh& mesh, const Diagnosis& diagnosis, int rings = 3, int most = 5000);

// The boundary of each node: of the first face that prescribes its position, else of the first one; -1 inside.
std::vector<int> boundary_of_nodes(const Mesh& mesh, const BoundaryTarget& target);

}  // namespace almesh
