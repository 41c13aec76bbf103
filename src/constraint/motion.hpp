// Prescribed motions of a boundary: the Dirichlet data g_D of Eq. (4) of the paper, as a composition of simple steps
// applied in the order written.
//
//   boundary inner = rotate 30 about 0 0; translate 8 0
//
// Kinds of steps: fixed, translate, rotate, twist, scale, formulas, positions of single nodes from a file, and the
// projections circle, sphere, cylinder, which take a point to its closest one on a curved surface: the target of mesh
// curving. A final `slide` lets the nodes move along the boundary or that of another mesh, `free` anywhere.
// Coordinates in a step are those after the steps before it: the centre of a rotation is not moved by them. Which steps
// fit a mesh is known only with its dimension: check_dimension(). Cost of apply(): O(number of steps) per point.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/small_matrix.hpp"
#include "base/text.hpp"
#include "constraint/expression.hpp"

namespace almesh {

// What a node of a boundary does, from the least freedom to the most.
enum class NodeKind : unsigned char {
    fixed,   // it stays where the file has it
    target,  // it goes to a position
    slides,  // it is on a surface
    free     // it goes anywhere
};

inline bool is_prescribed(NodeKind kind) { return kind <= NodeKind::target; }

inline constexpr const char* file_of_line = "-";  // stands for a file that the coupled solver names with the time

struct MotionForm;  // a kind of step: one row of the table in motion.cpp

// A number of a step that is written as a formula of t, or of constants.
struct TimedNumber {
    int clause;  // 0: after the name, 1: after `axis`, 2: after `about`
    std::size_t place;
    Expression formula;

    bool operator==(const TimedNumber&) const = default;
};

// Where a program that uses the library has the point X at the time t.
using PositionAt = std::function<Vec<3>(const Vec<3>& X, double t)>;

struct MotionStep {
    const MotionForm* form = nullptr;
    std::vector<double> numbers;      // after the name, as `form` says
    std::vector<double> axis, about;  // after these words; empty: not written
    std::string file;                 // of nodes or of a surface: as written, or where the deck has found it
    std::string boundary;             // of that file, along which nodes slide; empty: not written
    bool displacement = false;        // the file has displacements instead of positions
    const MotionForm* rest = nullptr; // of the nodes that it leaves out: fixed, slide or free; null: it has them all
    std::vector<Expression> formulas; // one for each axis
    std::vector<TimedNumber> timed;   // whose values at the time t are among the numbers
    double t = 0;
    double fraction = 1;              // of the displacement of a point; always 1 for a turn
    std::shared_ptr<const PositionAt> position = {};          // of given_by()
    std::shared_ptr<const std::vector<double>> places = {};   // of given_by(): nodes x dim, in place of a file

    bool operator==(const MotionStep&) const = default;
};

struct Motion {
    std::vector<MotionStep> steps;  // at least one

    bool operator==(const Motion&) const = default;
};

// Steps separated by `;`. Throws UsageError (without file and line: the deck adds them) naming the step, what is wrong
// with it and its form.
Motion parse_motion(std::string_view text, const Constants& constants = {});

// Positions at the time t by a function, which turns the boundary by so many degrees since the time 0; and positions of
// all nodes of the base mesh, nodes x dim, in place of a file.
Motion given_by(PositionAt position, double t, double degrees);
Motion given_by(std::vector<double> places);

// The motion at the time t, in frame number `frame`, which replaces %d, or %04d for four digits, in names of files.
// Throws UsageError where a number is not finite then, or makes no sense.
Motion at_time(Motion motion, double t, int frame);

bool depends_on_time(const Motion& motion);  // whether a formula names t

// Throws UsageError naming the first step that cannot act in `dim` dimensions, and why.
void check_dimension(const Motion& motion, int dim);

// Moves the point x (dim coordinates); the motion has passed check_dimension(). Returns false, x unchanged, where a
// projection is undefined: at the centre of the circle or sphere, on the axis of the cylinder.
bool apply(const Motion& motion, int dim, double* x);

// The motion at a fraction in [0, 1]: turns and twists by that part of their angle, functions at that part of the time,
// other steps by that part of the displacement of a point.
Motion at_fraction(Motion motion, double fraction);

// The motion with angles in [-180, 180]: the same target, by the shorter way.
Motion shortest(Motion motion);

double turn(const Motion& motion);  // sum of the angles of its steps, without sign, in degrees

// Whether a mesh at the motion `before` is a start for `now`, the same steps with other numbers: no turn between them
// exceeds 90 degrees and, unless turns are taken as written, no whole turn exceeds 180 degrees, beyond which the other
// way round is shorter.
bool leads_to(const Motion& before, const Motion& now, bool as_written);

Motion motion_of(NodeKind kind);  // not `target`: the motion `fixed`, `slide` or `free`
NodeKind kind_of(const Motion& motion);
NodeKind kind_of_rest(const Motion& motion);  // of the nodes that its file leaves out
inline bool is_fixed(const Motion& motion) { return kind_of(motion) == NodeKind::fixed; }

// The step that takes positions of single nodes from a file: always the first one; null where there is none. apply()
// passes over it: the points given to it are there already (problem/node_targets.hpp).
const MotionStep* file_step(const Motion& motion);
bool is_of_mesh(const MotionStep& file_step);  // the file is a mesh

// The step that names another mesh along whose surface the nodes slide; null where they do not, or along their own.
const MotionStep* surface_step(const Motion& motion);
bool goes_onto(const Motion& motion);  // on which they do not lie yet

// Whether it is an affine map, which takes polynomials to polynomials of the same degree: no step is a projection.
bool is_affine(const Motion& motion);

std::string to_string(const Motion& motion);  // parse_motion() reads it back

std::vector<Named> motion_forms();  // form and meaning of every kind of step, for the list of keys

}  // namespace almesh
