// Cuts a graph into a few domains with vertex separators between them, so that sweeps over the rows of a matrix can run
// on several threads: no edge joins two domains, and only the separators, numbered last, have to wait for all of them.
//
// Only the share of the separators in the rows counts here, so a coarse graph is cut (separator.hpp): that takes a
// fraction of the time of nested dissection, for separators half as large again. O(edges).
#pragma once
#include <vector>

namespace almesh {

struct Graph;

struct Domains {
    std::vector<int> order;  // order[new] = old; reverse Cuthill-McKee inside each domain and inside the separators
    std::vector<int> start;  // domain k: new numbers start[k] .. start[k+1]; separators: from start.back() on.
                             // Domains with most edges come first.

    int count() const { return static_cast<int>(start.size()) - 1; }
};

// Eight domains whatever the number of threads; a single one where the graph has less than a few thousand vertices.
Domains cut_into_domains(const Graph& graph);

}  // namespace almesh
