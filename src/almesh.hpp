// almesh in one header: a mesh follows its boundary, and no element is ever inverted.
//
// The distortion of the map from the mesh as it was is minimised; it is infinite for inverted elements, so that no step
// of the minimisation can accept one. The position of the boundary is a constraint, imposed by an augmented Lagrangian.
//
//     almesh::MovingMesh mesh(arrays);                                   // nodes, cells, faces of named boundaries
//     mesh.set("outer", almesh::Boundary::fixed());
//     mesh.set("wing", almesh::Boundary::moves([](almesh::Point X, double t) -> almesh::Point {
//         return {X[0] + 8 * t, X[1]};                                   // where the node at X is at the time t
//     }));
//     const almesh::Moved moved = mesh.move();                           // to the time 1, from where arrays have it
//     if (moved.is_good()) use(moved.x);
//
// Arrays have point after point: coordinate a of node i at [dim * i + a], nodes and elements counted from 0, in the
// caller's unit of length and order. What a caller can mend (an unknown name, a mesh that is not valid) is thrown as a
// std::runtime_error that says what, where and what to do. What a solution comes to is a result: see Moved::status.
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
    std::vector<int> nodes;  // count x nodes of a cell of the degree
};

struct Faces {
    std::string boundary;  // its name
    Cells cells;           // lines in 2D; triangles or quadrilaterals in 3D, of the degree of the mesh
};

// Degree 1 to 7, all cells of the same. Each face that belongs to one element is on a boundary; where no list has any,
// all are on the boundary "all".
struct MeshArrays {
    int dim = 2, degree = 1;
    std::vector<double> x;  // nodes x dim
    std::vector<Cells> elements;
    std::vector<Faces> faces;
};

// What holds the nodes of a boundary.
struct Boundary {
    enum class Kind { fixed, moves, slides, free };
    // Where the node that was at X is at the time t; at t = 0 it is X. Called by one thread.
    using Position = std::function<Point(const Point& X, double t)>;

    Kind kind = Kind::fixed;
    Position position = {};          // of moves; of slides: where the surface goes, empty: it stays
    std::vector<double> target = {}; // of moves, instead: nodes x dim at t = 1, of which the boundary's are read; until
                                     // then the straight way there
    double turn = 0;                 // degrees by which the position turns the boundary at t = 1: see Continuation

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
    std::vector<double> lower_bound; // per element, of its scaled Jacobian: 1 for a straight simplex
    std::string reason;              // what stands in the way; empty where both hold
};

// Of the mesh as the arrays have it, inverted elements allowed. Cost: O(elements log elements).
Verdict certify(const MeshArrays& mesh);

// ---- Moving

struct Options {
    enum class Objective {
        deviation,   // the integral of (eta - 1)^2, eta the distortion
        squared,     // of eta^2
        size_shape,  // of (eta - 1)^2, where eta is of shape and size
        minimax      // the largest eta
    };
    // Whether the motion is done in parts, each from the mesh of the one before. automatic: if Boundary::turn, without
    // full turns, is above 90 degrees, and if the whole motion at once fails; always: by turns as they are given, also
    // beyond 180 degrees.
    enum class Continuation { automatic, never, always };

    Objective objective = Objective::deviation;
    Continuation continuation = Continuation::automatic;
    int degree = 0;                  // of the mesh that moves, at least that of the arrays; 0: theirs
    double gradient_tolerance = 1e-8;  // of |grad E|, in units of the size of the mesh
    double boundary_tolerance = 1e-3;  // of the largest distance of a boundary node from its target, in cell heights;
                                       // what has converged is set to its target to the last bit where that is valid
    int max_iterations = 50;         // of the augmented Lagrangian
    int max_newton_steps = 200;      // of one minimisation
    bool may_slide = true;           // where no valid mesh has the boundary as prescribed, nodes slide along it; false:
                                     // that is an error
    int threads = 0;                 // of all objects; 0: as many as the machine has, or OMP_NUM_THREADS
};

// After every Newton step and, with newton_step = 0, after every iteration of the augmented Lagrangian.
struct Progress {
    int iteration, newton_step;
    double energy, gradient_norm, step_length;  // step_length: of Newton steps; else 1
    double constraint_norm;                     // |c_D|; of iterations, else 0
};
// What it throws ends the call, and is thrown by that; the object remains as it was.
using Observer = std::function<void(const Progress&)>;

struct Moved {
    std::vector<double> x;  // nodes x dim, of MovingMesh::arrays()
    double t = 0;           // the time that it is of
    bool converged = false;  // also if steps no longer gain anything, with the status "no_visible_gain"
    std::string status;      // "converged", "stalled", "max_newton_iterations", ..., as in almesh's summary.txt
    Verdict verdict;
    double relative_quality = 0, max_distortion = 1;  // 1 where nothing is distorted
    int nodes_off_target = 0;                         // of the boundary, by however little
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

    // What is moved: the arrays, or, with a higher degree, these with nodes added behind theirs. Elements keep their
    // order.
    const MeshArrays& arrays() const;

    // Each boundary needs one before the mesh moves, or that of "rest"; another one replaces it.
    void set(const std::string& boundary, const Boundary& what);

    // From the mesh as it was, in one solution: nothing depends on what was moved before.
    Moved move(double t = 1, const Observer& observe = {});

    // From `before`, a mesh of this object that is good, to a later time t, in the few Newton steps that a near mesh
    // needs; the motion from one time to the other in halves if the whole fails. To an earlier time as move().
    Moved follow(const Moved& before, double t, const Observer& observe = {});

    Verdict certify(const std::vector<double>& x) const;

    // Derivatives at a mesh that has converged, which is first made stationary to rounding (on return `at` is that
    // mesh): of x by the position of the boundary, along a velocity of its nodes; and of a function J(x) by the
    // position of each boundary node, zero inside. All nodes x dim.
    std::vector<double> tangent(Moved& at, const std::vector<double>& velocity);
    std::vector<double> adjoint(Moved& at, const std::vector<double>& dJ_dx);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace almesh
