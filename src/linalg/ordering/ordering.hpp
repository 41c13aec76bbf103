// The orderings in which a symmetric matrix can be eliminated, by name.
//
// nested_dissection has the least fill on meshes and is what runs use. The others are there to compare with:
// minimum_degree is nearly as good on small matrices, reverse_cuthill_mckee makes a band, natural keeps the numbering.
#pragma once
#include <vector>

#include "linalg/ordering/graph.hpp"

namespace almesh {

enum class Ordering { nested_dissection, minimum_degree, reverse_cuthill_mckee, natural };

const char* to_string(Ordering ordering);

// minimum_degree() keeps a bit for every pair of vertices: 200 MB at this many.
inline constexpr int largest_minimum_degree = 40000;

// order[new] = old. minimum_degree: of a graph with at most largest_minimum_degree vertices.
std::vector<int> order_vertices(const Graph& graph, Ordering ordering);

}  // namespace almesh
