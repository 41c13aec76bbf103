// Symmetric quadrature rules on triangles and tetrahedra with few points, all of them inside and of positive weight.
// Computed by tests/support/quadrature_rules.py; as few points as in Witherden & Vincent, Comput. Math. Appl. 69 (2015)
// 1232, in most rules.
#pragma once
#include <array>
#include <string_view>
#include <vector>

namespace almesh {

// All permutations of one point in barycentric coordinates. `pattern` has a letter per vertex, equal letters are equal
// coordinates: a is free[0], b free[1], and the last letter's value makes the sum of the coordinates 1. Numbers of
// points: triangle aaa 1, aab 3, abc 6; tetrahedron aaaa 1, aaab 4, aabb 6, aabc 12.
struct Orbit {
    double weight;             // of each of its points, as a part of the simplex's volume
    std::string_view pattern;
    std::array<double, 2> free;
};

struct SymmetricRule {
    int dim, exactness;
    std::vector<Orbit> orbits;
};

// The rule of fewest points in the table that is exact to `exactness`, or null where the table ends.
const SymmetricRule* symmetric_rule(int dim, int exactness);

}  // namespace almesh
