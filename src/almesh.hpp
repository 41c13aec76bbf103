// almesh in one header: a mesh follows its boundary, and no element is ever inverted.
//
// The library minimises the distortion of the map from the original mesh, which is infinite for inverted elements: no
// step accepts one. The position of the boundary is a constraint, imposed by an augmented Lagrangian.
//
//     almesh::MovingMesh mesh(arrays);                                   // nodes, cells, faces of named boundaries
//     mesh.set("outer", almesh::Boundary::fixed());
//     mesh.set("wing", almesh::Boundary::moves([](almesh::Point X, double t) -> almesh::Point {
//         return {X[0] + 8 * t, X[1]};                                   // where the node at X is at the time t
//     }));
//     const almesh::Moved moved = mesh.move();                           // to the time 1, from where arrays have it
//     if (moved.is_good()) use(moved.x);
//
// In an array, coordinate a of node i is at [dim * i + a]; nodes and elements are counted from 0; the unit of length
// and the order are the caller's. An error of the caller (an unknown name, an invalid mesh) is thrown as a
// std::runtime_error that says what, where and what to do. A failed solution is a result: see Moved::status.
// Objects are independent of each other; one object is used by one thread at a time and computes on all cores, with the
// same bits for any number of them.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace almesh {

using Point = std::array<double, 3>;  // in 2D the last coordinate is 0

// ---- Meshes and boundaries

enum class Cell { line, triangle, quadrilateral, tetrahedron, hexahedron, prism, pyramid };

// Cells of one type, with the nodes of each in the order of Gmsh: vertices, then those of edges, faces, inside.
struct Cells {
    Cell type;
    std::vector<int> nodes;   // count x nodes of a cell of the degree
    std::string volume = {};  // of elements: the name of a group of them, empty: none
};

struct Faces {
    std::string boundary;  // its name
    Cells cells;           // lines in 2D; triangles or quadrilaterals in 3D, of the degree of the mesh
};

// All cells have the same degree, 1 to 7. Each face that belongs to one element is on a boundary: "untagged" if it is
// in no list; without lists "boundary" ("boundary-1", ... if in parts).
struct MeshArrays {
    int dim = 2, degree = 1;
    std::vector<double> x;  // nodes x dim
    std::vector<Cells> elements;
    std::vector<Faces> faces;
};

// The condition on the nodes of a boundary.
struct Boundary {
    enum class Kind { fixed, moves, slides, free };
    // The position at the time t of the node that was at X; at t = 0 it is X. Called by one thread.
    using Position = std::function<Point(const Point& X, double t)>;

    Kind kind = Kind::fixed;
    Position position = {};          // moves: of the nodes; slides: of the surface, empty if it stays
    std::vector<double> target = {}; // moves, instead: positions at t = 1, nodes x dim, read on the boundary;
                                     // until then the straight way there
    double turn = 0;                 // degrees by which `position` turns the boundary until t = 1: see Continuation

    static Boundary fixed() { return {}; }
    static Boundary moves(Position to, double degrees = 0) { return {Kind::moves, std::move(to), {}, degrees}; }
    static Boundary moves_to(std::vector<double> x) { return {Kind::moves, {}, std::move(x)}; }
    static Boundary slides(Position along = {}) { return {Kind::slides, std::move(along)}; }
    static Boundary free() { return {Kind::free}; }
};

// ---- What is certified

// Proved by bounds on the determinants of the elements, not by samples.
struct Verdict {
    bool valid = false;              // det J > 0 everywhere in every element
    bool injective = false;          // and no two elements overlap
    int undecided = 0;               // elements proved neither valid nor invalid
    std::vector<double> certified_bound;  // per element, below det J over that of the straight one: 1 for a simplex
    std::string reason;              // why one of them fails; empty if both hold
};

// Certifies the mesh in the arrays, which may have inverted elements. Cost: O(elements log elements).
Verdict certify(const MeshArrays& mesh);

// ---- Moving

struct Options {
    enum class Objective {
        deviation,   // the integral of (eta - 1)^2, eta the distortion
        squared,     // of eta^2
        size_shape,  // of (eta - 1)^2, where eta is of shape and size
        minimax      // the largest eta
    };
    // Whether the motion is divided into increments, each from the mesh of the last one. automatic: if Boundary::turn,
    // without full turns, exceeds 90 degrees, or if the whole motion fails at once; always: with turns as they are
    // given, also beyond 180 degrees.
    enum class Continuation { automatic, never, always };

    Objective objective = Objective::deviation;
    Continuation continuation = Continuation::automatic;
    int degree = 0;                  // of the mesh that moves, at least that of the arrays; 0: theirs
    double gradient_tolerance = 1e-8;  // of |grad E|, in units of the size of the mesh
    double boundary_tolerance = 1e-3;  // of the largest distance of a boundary node from its target, in cell heights;
                                       // after convergence nodes are set exactly to their targets where valid
    int max_iterations = 50;         // of the augmented Lagrangian
    int max_newton_steps = 200;      // of one minimisation
    bool may_slide = true;           // if no valid mesh has the prescribed boundary, its nodes slide along it; false:
                                     // this is an error
    int threads = 0;                 // of the object's calls; 0: as many as the machine has, or OMP_NUM_THREADS
};

// After every Newton step and, with newton_step = 0, after every iteration of the augmented Lagrangian.
struct Progress {
    int iteration, newton_step;
    double energy, gradient_norm, step_length;  // step_length: of Newton steps; else 1
    double constraint_norm;                     // |c_D|; of iterations, else 0
};
// An exception that it throws ends the call and is passed on; the object is unchanged.
using Observer = std::function<void(const Progress&)>;

struct Moved {
    std::vector<double> x;  // nodes x dim, of MovingMesh::arrays()
    double t = 0;           // the time of x
    bool converged = false;  // also if further steps gain nothing: status "no_visible_gain"
    std::string status;      // "converged", "stalled", "max_newton_iterations", ..., as in almesh's summary.txt
    Verdict verdict;
    double relative_quality = 0, max_distortion = 1;  // 1 where nothing is distorted
    int nodes_off_target = 0;                         // boundary nodes, by any amount
    int newton_steps = 0;                             // all that were made

    bool is_good() const { return converged && verdict.valid && verdict.injective; }
};

class MovingMesh {
public:
    // Copies the arrays. Elements with the other orientation are turned over inside; an inverted mesh is refused.
    explicit MovingMesh(const MeshArrays& mesh, const Options& options = {});
    MovingMesh(MovingMesh&&) noexcept;
    MovingMesh& operator=(MovingMesh&&) noexcept;
    ~MovingMesh();

    // The mesh that moves: the given arrays or, with a higher degree, these with new nodes at the end. Elements keep
    // their order.
    const MeshArrays& arrays() const;

    // Sets or replaces a condition; that of "rest" is for all without one. Each boundary needs one before a move.
    void set(const std::string& boundary, const Boundary& what);

    // Moves the original mesh to the time t, independently of earlier calls.
    Moved move(double t = 1, const Observer& observe = {});

    // Moves `before`, a good mesh of this object, to a later time t, in the few Newton steps that a near mesh needs; if
    // that fails, the time step is halved. To an earlier time: like move().
    Moved follow(const Moved& before, double t, const Observer& observe = {});

    Verdict certify(const std::vector<double>& x) const;

    // Derivatives at a converged mesh, which is first made stationary to rounding (on return in `at`): of x along a
    // velocity of the boundary nodes; and of a function J(x) by the position of each boundary node, zero inside. All
    // arrays are nodes x dim.
    std::vector<double> tangent(Moved& at, const std::vector<double>& velocity);
    std::vector<double> adjoint(Moved& at, const std::vector<double>& dJ_dx);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace almesh
