// Sets of the numbers 0 .. count - 1 that are joined pair by pair (union-find with path halving; Tarjan & van Leeuwen,
// J. ACM 31, 1984). A set is known by its least number.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

namespace almesh {

class DisjointSets {
public:
    explicit DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

    // The least number in the set of i.
    int find(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    void join(int i, int j) {
        const int a = find(i), b = find(j);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<int> parent_;
};

}  // namespace almesh
