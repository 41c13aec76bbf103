// Elements that are not valid wherever the nodes that may move go, which is proved by the boundary alone:
//   - where the determinant depends only on nodes that stay (determined_elements.hpp), and is not positive;
//   - where it depends only on nodes that slide in one plane, or along one line: it is zero.
#pragma once
#include <string>
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Per element the reason, "" for one that may be valid. x: node_count x dim; where the constraint does not hold at x,
// nodes of the boundary stay at x, or are at the target. sliding: null where no node slides.
std::vector<std::string> find_infeasible(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                         const BoundaryTarget& target, const SlidingSurfaces* sliding);

// Ascending, the elements that are invalid as long as all nodes of the boundary that are not free stay at x.
std::vector<int> invalid_by_boundary(const Mesh& mesh, const std::vector<double>& x, const BoundaryTarget& target);

// Per node: whether it is on faces that do not leave it free.
std::vector<char> held_nodes(const Mesh& mesh, const BoundaryTarget& target);

// Elements that are not valid, for a user: all of them as text for the file invalid.csv, and the first ten.
struct InvalidElements {
    int count = 0;
    std::string csv, first;  // first: a line each, with its id, centre, and scaled Jacobian >=
};

// elements: in the order in which they are listed. x: node_count x dim in units of the file. scaled_jacobian: per
// element. why: as of find_infeasible(); or empty.
InvalidElements list_invalid(const Mesh& mesh, const std::vector<int>& elements, const std::vector<double>& x,
                             const std::vector<double>& scaled_jacobian, const std::vector<std::string>& why = {});

}  // namespace almesh
