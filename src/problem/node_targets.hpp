// What the steps of a motion take from files: positions of single nodes, and surfaces of other meshes.
#pragma once
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "problem/boundaries.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Where files have the nodes of boundaries.
struct NodeTargets {
    std::optional<Mesh> raised;  // the mesh, where another one that has the faces of a boundary is of a higher degree
    PlacedNodes placed;          // of the nodes of that, or of the mesh itself
};

// Of the steps `file` and `mesh`. motions: per boundary. The nodes of `file`, and of `mesh` where both meshes are
// linear, are those with the same ids; else the faces of `mesh` are those with the same vertices, as they are curved
// there. Nodes that a `file` with `else` leaves out are where the mesh has them; between vertices they follow these.
// Throws InputError, with the line where there is one, for ids that are no nodes of the boundary (`file` only), doubled
// ones that differ, missing nodes and faces, and numbers that are none.
NodeTargets read_node_targets(const Mesh& mesh, const std::vector<Motion>& motions);

// A file of rows `node-id x y [z]`, vectors at nodes; at others `value` stays. nodes: those that it may have, by their
// ids; place: what these are on, for messages. known: on return, per node, whether the file has it.
void read_node_rows(const Mesh& mesh, const std::string& path, const std::unordered_map<long long, int>& nodes,
                    const std::string& place, std::vector<double>& value, std::vector<char>& known);

// Of the step `slide along FILE`: the surfaces of other meshes along which boundaries slide. Per boundary of the mesh;
// empty where all slide along their own, if at all. notes: what was corrected in the files. Throws InputError, with the
// line of the deck, for files that are no mesh of this dimension or have not the boundary.
std::vector<OtherSurface> read_other_surfaces(const ProblemSetup& setup, const Mesh& mesh,
                                              std::vector<std::string>& notes);

}  // namespace almesh
