// Cuts a graph into a few domains with vertex separators between them, so that sweeps over the rows of a matrix can run
// on several threads: no edge joins two domains, and only the separators, numbered last, have to wait for all of them.
//
// The graph is coarsened a few times, the coarse graph bisected recursively (separator.hpp), and the vertices of the
// fine graph that still see another domain are taken out. Separators half as large again as those of nested dissection
// for a fraction of the time: here only their share of the rows counts. O(edges).
#pragma once
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

struct Domains {
    std::vector<int> order;  // order[new] = old; reverse Cuthill-McKee inside each domain and inside the separators
    std::vector<int> start;  // domain k: new numbers start[k] .. start[k+1]; separators: from start.back() on.
                             // Domains with most edges come first.

    int count() const { return static_cast<int>(start.size()) - 1; }
};

// Eight domains whatever the number of threads; a single one where the graph has less than a few thousand vertices.
Domains cut_into_domains(const Graph& graph);

}  // namespace almesh
