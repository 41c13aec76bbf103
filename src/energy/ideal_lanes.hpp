// The ideal elements of a batch, one in each lane.
#pragma once
#include <vector>

#include "base/lanes.hpp"
#include "base/small_matrix.hpp"

namespace almesh {

template <int n>
struct IdealLanes {
    const Mat<n, Lanes>& inverse;       // A^{-1} of straight ones
    Lanes jacobian;                     // mean det A
    const std::vector<double>& curved;  // node positions (nodes x n) of curved ones, else empty
    bool has_one = false;               // those of one element with mean det A = 1, of which all are multiples
};

}  // namespace almesh
