// Vertex separators of graphs by the multilevel method: merge neighbours along heavy edges until few vertices are left,
// split that graph from several seeds, and project the split back level by level, refining it at each with
// Fiduccia-Mattheyses moves (Karypis & Kumar, SIAM J. Sci. Comput. 20, 1998; Hendrickson & Rothberg, same volume, for
// moves on vertex separators).
//
// Cost: O(edges) for each level, and the levels shrink geometrically.
#pragma once
#include <cstdint>
#include <vector>

#include "linalg/ordering/coarsening.hpp"

namespace almesh {

enum Part : unsigned char { left = 0, right = 1, separator = 2 };

// Part of every vertex such that no edge joins left and right, both hold less than about 60 % of the weight, and the
// separator is light. One side may be empty where the graph cannot be split. The same seed gives the same answer.
std::vector<Part> find_separator(const WeightedGraph& graph, std::uint64_t seed);

// The same with the first steps of coarsening given.
std::vector<Part> find_separator(const Hierarchy& graphs, std::uint64_t seed);

}  // namespace almesh
