// Whether vectors lie in an open half space: whether a d has a positive product with all of them. The point of their
// convex hull that is nearest to zero is such a d (Gilbert, Johnson, Keerthi, IEEE J. Robotics Autom. 4, 1988), found
// from subsets of at most three, by products that need no division.
#pragma once
#include <functional>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

// Of at most four vectors: d, the least product of one of them with d over |d|, at most 0 where they lie in no half
// space, and up to three of them that have the same product with d.
struct HalfSpace {
    Vec<3> d{};
    double least = 0;
    std::vector<Vec<3>> support;
};
HalfSpace half_space_of(const std::vector<Vec<3>>& vectors);

// The vector with the least product with d.
const Vec<3>& lowest(const std::vector<Vec<3>>& vectors, const Vec<3>& d);

// Whether a d was found with v . d > margin |d| for all v; margin >= 0. least(d): the v with the least product with d.
bool is_half_space(const std::function<Vec<3>(const Vec<3>& d)>& least, double margin);
bool are_in_half_space(const std::vector<Vec<3>>& vectors, double margin);

}  // namespace almesh
