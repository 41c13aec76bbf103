// The problem to be solved: the mesh, its target, and both in the run's frame.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "problem/boundaries.hpp"
#include "base/frame.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "method/continuation.hpp"

namespace almesh {

struct BaseMesh;

struct Problem {
    Mesh base;                     // as read, with the boundaries of the setup
    std::string name;              // of its file, for errors
    bool is_own_ideal = false;     // it is curved, and itself the ideal mesh
    std::vector<Motion> motions;   // of its boundaries
    std::vector<char> periodic;    // per boundary: motions_of()
    PeriodicPairs pairs;           // of the level, in the file's frame
    SharedNodes shared;            // the rule for nodes that these share
    std::optional<Mesh> raised;    // base in the degree of the meshes that place its boundaries, if that is higher
    std::unique_ptr<Level> level;  // the base mesh refined and raised, its ideal mesh; in the run's frame
    BoundaryTarget target;         // in the run's frame
    std::vector<double> node_target;  // target.node in units of the file
    int split_elements = 0;           // of the file: inverted by the target, and divided in the base mesh
    bool curves_in_place = false;     // a curved mesh whose boundary should stay as in the file (curving.hpp)
    std::vector<double> file_x;       // mesh().x in units of the file, nodes x dim
    std::vector<double> start;        // start = FILE: the first iterate, in the run's frame,
    std::optional<Standing> standing;  // and where its run stood, of which it is a mesh so far,
    std::string way;                   // on this way (deck/so_far.hpp)
    std::vector<double> regular;      // DistortionParams::regular, in the run's frame
    std::vector<std::string> infeasible;  // improved: per element why it need not be valid, or ""; empty: all have to
    PlacedNodes placed, level_placed;  // positions from files, for shape() and for the level, in units of the file
    std::shared_ptr<const SlidingSurfaces> sliding;  // null where no boundary slides
    std::vector<OtherSurface> other;  // read_other_surfaces()
    Frame frame;                   // of the run, by the mesh file
    std::string mesh_hash, run_id;  // of a run of a deck (deck/make_problem.hpp)
    std::string mesh_text;          // its mesh file, where that will be written again with other coordinates
    std::vector<std::string> notes;

    const Mesh& shape() const { return raised ? *raised : base; }
    std::vector<double> ideal_of(const Mesh& mesh) const { return is_own_ideal ? mesh.x : straight_sided(mesh); }
    const Mesh& mesh() const { return level->mesh; }
    bool is_feasible(int e) const { return infeasible.empty() || infeasible[e].empty(); }
    const std::vector<double>& ideal() const { return level->ideal; }
};

// Per face: whether it was made flatter than the file has it, of a mesh that is curved in place.
std::vector<char> straight_faces(const Problem& problem);

// Throws SettingError, UsageError or InputError for everything that can be wrong before solving, target faces that are
// invalid themselves included. base: with the boundaries of the setup. The level has no energy and no constraint yet.
// In two steps: mesh and target, in the file's frame; then, with the standing of a run that goes on, all else.
Problem make_problem(const ProblemSetup& setup, BaseMesh base, std::vector<std::string> notes = {});
Problem begin_problem(const ProblemSetup& setup, BaseMesh base, std::vector<std::string> notes);
void complete(const ProblemSetup& setup, Problem& problem);

// Interpolates positions (or another field) at the nodes of `shape` to the level's mesh, which has the same elements,
// possibly refined.
std::vector<double> on_level(const Mesh& shape, std::vector<double> positions, const Level& level);

// Gives the problem the target of the motions as they are now, at another time; all else stays.
void move_target(const ProblemSetup& setup, Problem& problem);

// The base mesh, refined and in another degree, its ideal mesh and its target, in the file's frame. placed: on entry
// for shape(), on return for this mesh.
std::unique_ptr<Level> discretise(const Problem& problem, int refinements, int degree, PlacedNodes& placed,
                                  BoundaryTarget& target);

// Of a mesh that is curved in place, the surfaces of the file along which nodes can slide; null where they are not
// known.
std::shared_ptr<SlidingSurfaces> surfaces_in_place(const ProblemOptions& options, const Problem& problem);

// The energy of a mesh of this problem, in which infeasible elements need not be valid.
std::unique_ptr<DistortionEnergy> make_energy(const Problem& problem, const Level& level,
                                              const DistortionParams& params);

// Makes energy and constraint of the problem's level, the functional of Eq. 6. Do not move the Problem afterwards.
void set_functional(const ProblemOptions& options, const Problem& problem);

// The same for its constraint alone, after move_target().
void set_constraint(const ProblemOptions& options, const Problem& problem);

// A mesh on which the problem is solved first.
struct CoarserMesh {
    int refinements, degree;  // of the base mesh
};

// The problem on a coarser mesh, with its functional, in the same frame; the target is not checked again. In a lower
// degree than the deck's the target is nodal: the shape between nodes is left to the finer mesh. The problem must
// outlive the level.
std::unique_ptr<Level> coarser_level(const ProblemOptions& options, const Problem& problem, const CoarserMesh& coarser);

}  // namespace almesh
