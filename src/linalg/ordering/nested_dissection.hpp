// Fill-reducing ordering of a graph by nested dissection: a small vertex separator is numbered last, the two sides it
// leaves are ordered the same way, and pieces of some hundred vertices by minimum degree (George, SIAM J. Numer.
// Anal. 10, 1973; Karypis & Kumar, SIAM J. Sci. Comput. 20, 1998).
//
// The graph is compressed first, so all nodes of a cell interior or an edge of a high-degree mesh move as one. Leaves
// know the separators around them (their halo), which minimum degree would otherwise underrate. Cost:
// O(edges log(vertices / leaf)). The answer does not depend on the number of threads.
#pragma once
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

// order[new] = old.
std::vector<int> nested_dissection(const Graph& graph);

}  // namespace almesh
