// The Dirichlet data g_D of the constraint phi = g_D (paper, Eq. 4): for each boundary face as read from the file, its
// image under the motion of its boundary.
#pragma once
#include <vector>

#include "base/index.hpp"
#include "constraint/motion.hpp"
#include "mesh/mesh.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

double face_size(const Mesh& mesh, const std::vector<double>& x, int f);  // from its first vertex to the farthest

// The approximation of g_D in the constraint: its values at the nodes, or its best approximation in the mean.
enum class TargetKind { nodal, least_squares };

// Of faces of one type: the rule on the reference face, the basis functions at its points.
struct FaceRule {
    ElementGroup faces;
    Quadrature quadrature;
    std::vector<double> values;  // point x face node
    std::size_t first_sample;    // of these faces

    std::size_t sample(int f, int q) const {
        return first_sample + offset(f - faces.first, quadrature.count, q);
    }
};

struct BoundaryTarget {
    bool in_trace_space = false;  // all motions are affine: g_D is of the mesh's degree on every face
    std::vector<NodeKind> kind;   // face x face node
    std::vector<FaceRule> rules;  // by type of faces
    std::vector<double> node;     // face x face node x dim: g_D at the nodes of the face
    std::vector<double> sample;   // face x quadrature point x dim: g_D at the quadrature points
    std::vector<NodeKind> written_kind;  // `kind` and `node` by the motion of the face's own boundary, before nodes
    std::vector<double> written;         // were freed, fixed or shared; always in the file's frame

    const double* node_of(const Mesh& mesh, int f) const { return &node[mesh.face_start(f) * mesh.dim]; }
    // Whether node mesh.faces[k] slides although the motion of its boundary prescribes its position; whether any does.
    bool is_freed(std::size_t k) const { return kind[k] == NodeKind::slides && is_prescribed(written_kind[k]); }
    bool frees() const;
    bool slides(const Mesh& mesh, int f) const;      // any node of the face
    bool prescribes(const Mesh& mesh, int f) const;  // all nodes of the face
    bool prescribes_all() const;
};

// Where a file has the nodes of a boundary, nodes x dim each.
struct PlacedBoundary {
    std::vector<double> x;         // empty: there is no file
    std::vector<double> left_out;  // not 0 at nodes that it does not list, which slide or are free; empty: none
};

using PlacedNodes = std::vector<PlacedBoundary>;  // per boundary, or empty

// The rule for a node to which two boundaries give different positions: an error, the position of the boundary of
// lowest rank, or the mean. The faces at the node follow by their basis functions.
struct SharedNodes {
    enum Rule { refuse, first, mean } rule = refuse;
    std::vector<int> rank{};  // per boundary
};

// Of the mesh with its nodes at x. motion: one per mesh.boundaries. Throws UsageError where one does not fit the
// dimension, InputError where a projection is undefined (a node at the centre), or where two boundaries disagree on a
// node and the rule is `refuse`.
BoundaryTarget make_target(const Mesh& mesh, const std::vector<double>& x, const std::vector<Motion>& motion,
                           const PlacedNodes& placed = {}, const SharedNodes& shared = {});
inline BoundaryTarget make_target(const Mesh& mesh, const std::vector<Motion>& motion) {
    return make_target(mesh, mesh.x, motion);
}

// x (node_count x dim) with the boundary nodes at their positions in the target: the first face that holds a node
// decides.
std::vector<double> at_target(const Mesh& mesh, const BoundaryTarget& target, std::vector<double> x);

// Per boundary: the kind of its least free node; nodes that a file leaves out may be freer. kind: face x face node.
std::vector<NodeKind> kinds_of_boundaries(const Mesh& mesh, const std::vector<NodeKind>& kind);

// Per node: whether wanted(f, k) of one of the places k of face f at which it is in `faces`.
template <class Wanted>
std::vector<char> nodes_with(const Mesh& mesh, const Wanted& wanted) {
    std::vector<char> nodes(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) { if (wanted(f, k)) nodes[mesh.faces[k]] = 1; });
    return nodes;
}

// Per node: whether its kind on some face is prescribed; is not free; is freed to slide.
std::vector<char> prescribed_nodes(const Mesh& mesh, const BoundaryTarget& target);
std::vector<char> held_nodes(const Mesh& mesh, const BoundaryTarget& target);
std::vector<char> freed_nodes(const Mesh& mesh, const BoundaryTarget& target);

// Lets the chosen nodes slide wherever their positions are prescribed.
void free_nodes(const Mesh& mesh, const std::vector<char>& chosen, BoundaryTarget& target);

// Faces agree on the nodes that they share: the position is that of a boundary that is fixed, else that of the first
// face that prescribes one; also on faces that slide or are free.
void prescribe_shared_nodes(const Mesh& mesh, BoundaryTarget& target);

}  // namespace almesh
