#include "linalg/ordering/ordering.hpp"

#include <numeric>

#include "linalg/ordering/minimum_degree.hpp"
#include "linalg/ordering/nested_dissection.hpp"

namespace almesh {

const char* to_string(Ordering ordering) {
    switch (ordering) {
        case Ordering::nested_dissection: return "nested_dissection";
        case Ordering::minimum_degree: return "minimum_degree";
        case Ordering::reverse_cuthill_mckee: return "rcm";
        case Ordering::natural: return "natural";
    }
    return "";
}

namespace {

std::vector<int> minimum_degree_of_groups(const Graph& graph) {
    const CompressedGraph compressed = compress(graph);
    SmallGraph small;
    small.size = small.eliminable = compressed.graph.size();
    small.weight = compressed.weight;
    for (int g = 0; g < small.size; ++g)
        for (int k = compressed.graph.start[g]; k < compressed.graph.start[g + 1]; ++k)
            small.edges.push_back({g, compressed.graph.adjacent[k]});
    return expand(compressed, minimum_degree(small));
}

}  // namespace

std::vector<int> order_vertices(const Graph& graph, Ordering ordering) {
    std::vector<int> natural;
    switch (ordering) {
        case Ordering::nested_dissection: return nested_dissection(graph);
        case Ordering::minimum_degree: return minimum_degree_of_groups(graph);
        case Ordering::reverse_cuthill_mckee: return reverse_cuthill_mckee(graph);
        case Ordering::natural: break;
    }
    natural.resize(graph.size());
    std::iota(natural.begin(), natural.end(), 0);
    return natural;
}

}  // namespace almesh
