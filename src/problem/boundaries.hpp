// What moves which boundary of the mesh.
#pragma once
#include <string>
#include <vector>

#include "constraint/motion.hpp"
#include "mesh/mesh.hpp"
#include "problem/options.hpp"

namespace almesh {

struct BoundaryMotion {
    std::string name;  // of the mesh's physical group, "volume NAME" where it is one of elements; or `rest`, `all`
    Motion motion;
    std::string where;  // for errors: "circle.deck:12" or "command line"
    bool is_volume = false;
};

// What is to be solved on a mesh.
struct ProblemSetup : ProblemOptions {
    std::vector<BoundaryMotion> boundaries;  // in their order of precedence at nodes that they share
    std::string wall;                        // a boundary of the mesh, "" for none
    std::string contact;                     // names of boundaries, lists of them separated by ;
};

extern const char* const without_motion;  // a sentence: which periodic sides move as one

// The motion of a boundary of the mesh: its own, or that of `rest` or `all`; null where there is none.
const BoundaryMotion* motion_for(const ProblemSetup& setup, const std::string& boundary);

// Makes the boundaries of the mesh those of the setup: inner faces and volumes that it names become boundaries, faces in
// several groups that one motion has are one boundary of its name. In a mesh that is improved, `rest` and `all` stand
// for all boundaries inside too, named ones and those between groups of elements. Notes what is left free inside.
// Throws UsageError where a motion, the wall or a contact names no group of the mesh, where a motion does not fit the
// dimension, and where faces belong to two groups whose motions disagree.
void assign_boundaries(const ProblemSetup& setup, Mesh& mesh, std::vector<std::string>& notes);

// Removes boundaries all of whose faces belong to others now.
void drop_empty_boundaries(Mesh& mesh);

// One motion per boundary of the mesh; each must have one, `all` and `rest` stand for those not named. Throws
// SettingError with the lines of a deck that are missing. periodic: on return, per boundary, whether it moves as one
// with others, because its sides are periodic in the file and no line names it; its nodes are free, or slide if
// `rest` or `all` says so. Where nothing else moves these stay, too.
std::vector<Motion> motions_of(const ProblemSetup& setup, const Mesh& mesh, std::vector<char>* periodic = nullptr);

bool stays_on_surface(const Motion& motion);  // fixed, or no more than `slide`

// Whether the file's mesh may be the result of an improvement: regular ideal elements, all boundaries stay or slide.
bool may_stay(const ProblemOptions& options, const std::vector<Motion>& motions);

}  // namespace almesh
