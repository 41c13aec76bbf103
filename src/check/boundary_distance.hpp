// How far curved faces are from a surface, and nodes from a wall.
//
// For a mesh and its original, d(y) is the distance from a point y of a face to the closest point of all original faces
// of the same boundary: it is zero for a node that slid along these. h: the longest edge of y's original face, from
// corner to corner. d is taken on a grid of barycentric coordinates in each face, with its corners, edges and middle,
// and is linear between them; over all faces of a boundary
//
//     largest = max d,   rms^2 = integral of d^2 / area,   and the same of d / h.
#pragma once
#include <string>
#include <vector>

namespace almesh {

struct BoundaryTarget;
struct Mesh;
class SlidingSurfaces;

struct BoundaryDistance {
    int boundary = 0;
    int faces = 0, moved = 0;  // moved: more than rounding away somewhere
    double moved_area = 0;     // share of the area
    double largest = 0, rms = 0;
    double relative_largest = 0, relative_rms = 0;  // of d / h
};

// One entry per boundary with moved faces. original, x: node_count x dim positions, finite. measured: per boundary;
// empty: all. Faces whose nodes have kept their bits cost next to nothing.
std::vector<BoundaryDistance> boundary_distances(const Mesh& mesh, const std::vector<double>& original,
                                                 const std::vector<double>& x, const std::vector<char>& measured = {});

// Per face: the largest d / h of its points from the original boundary, and of its original points from the boundary
// now; h: the shorter of its longest edges then and now.
std::vector<double> relative_face_distances(const Mesh& mesh, const std::vector<double>& original,
                                            const std::vector<double>& x, const std::vector<char>& measured = {});

// A table with a row for each, below a line that says from what; "" where there are none.
std::string distance_table(const Mesh& mesh, const std::vector<BoundaryDistance>& distances, const std::string& from);

// Largest distance from their surface of points of the faces that have a node that slides; 0 where there are none.
// x: node_count x dim positions, target and x in the frame sliding.frame().
double distance_from_surfaces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                              const std::vector<double>& x);

// Per face: whether it slides and somewhere is farther than the tolerance, in units of its longest edge, from its
// surface, as a flat face of a round body is.
std::vector<char> curved_faces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                               const std::vector<double>& x, double tolerance);

// A boundary node that is not where it was to be.
struct MovedNode {
    int node = 0, boundary = 0;
    double distance = 0;
    std::string along;  // the surfaces in which it slid: "plane", "plane and cylinder of radius 2"; "": it left its own
};

// Nodes that are not where the motions of their boundaries take them (BoundaryTarget::written), and their largest
// distance from there. What motions of two boundaries say of one node may differ by rounding.
struct OffMotion {
    int nodes = 0;
    double largest = 0, largest_slide = 0;  // of those that are freed to slide
    std::vector<MovedNode> moved;  // that are freed to slide, or on a fixed boundary and have another target
};

// now: the targets, face x face node x dim. x: nodes x dim; all in the file's frame.
OffMotion off_motion(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces* sliding,
                     const std::vector<double>& now, const std::vector<double>& x);

std::string moved_nodes_csv(const Mesh& mesh, const std::vector<MovedNode>& nodes);

// How many, how they moved, and the first ten; "" where there are none.
std::string moved_nodes_text(const Mesh& mesh, const std::vector<MovedNode>& nodes);

// Distance of every node to a wall: to the curved faces of degree p themselves, not to their nodes. The error is of the
// order of the rounding errors of the coordinates, however thin the layers at the wall are. Where a face is curved so
// strongly that the distance has several minima on a nearly flat part of it, the least one may be missed.
// is_wall: per boundary. x: node_count x dim positions, finite. Returns node_count distances, exactly 0 for the nodes
// of the wall. Throws InputError where the boundary has no faces. Cost: O(log faces) boxes and a few Newton steps for
// each node.
std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& is_wall);

}  // namespace almesh
