// Elements that are not valid wherever the nodes that may move go, which is proved by the boundary alone:
//   - where the determinant depends only on nodes that are fixed (determined_elements.hpp), and is not positive;
//   - where it depends only on nodes that slide in one plane, or along one line: it is zero.
// Where all of the boundary is fixed and crosses itself, some elements overlap whatever the others do.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "constraint/constraint.hpp"
#include "constraint/sliding.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct NeverValid {
    std::string what;  // "element 3", or "face 7 of boundary wall"
    std::string why;
    Vec<3> at;
};

// The first. x: node_count x dim, where the constraint holds: else none is found. sliding: null where no node slides.
std::optional<NeverValid> find_never_valid(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                           const BoundaryTarget& target, const SlidingSurfaces* sliding);

}  // namespace almesh
