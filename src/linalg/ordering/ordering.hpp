// The orderings in which a symmetric matrix can be eliminated. order[new] = old; none depends on the number of threads.
//
// nested_dissection has the least fill on meshes and is what runs use. The others are there to compare with:
// minimum_degree is nearly as good on small matrices, reverse_cuthill_mckee makes a band, natural keeps the numbering.
#pragma once
#include <utility>
#include <vector>

namespace almesh {

struct Graph;
struct RowOrder;

enum class Ordering { nested_dissection, minimum_degree, reverse_cuthill_mckee, natural };

const char* to_string(Ordering ordering);

// minimum_degree() keeps a bit for every pair of vertices: 200 MB at this many.
inline constexpr int largest_minimum_degree = 40000;

// minimum_degree: of a graph with at most largest_minimum_degree vertices.
std::vector<int> order_vertices(const Graph& graph, Ordering ordering);

// A small vertex separator is numbered last, the two sides it leaves are ordered the same way, and pieces of some
// hundred vertices by minimum degree (George, SIAM J. Numer. Anal. 10, 1973; Karypis & Kumar, SIAM J. Sci. Comput. 20,
// 1998). The graph is compressed first, so that all nodes of a cell interior or an edge of a high-degree mesh move as
// one. Leaves are ordered with the separators around them as halo, without which minimum degree would underestimate
// degrees. Cost: O(edges log(vertices / leaf)).
std::vector<int> nested_dissection(const Graph& graph);

// A breadth-first numbering from an end vertex of each component, neighbours by ascending degree, reversed. Keeps
// neighbours close in number, which makes ILU(0) accurate (George & Liu, Computer Solution of Large Sparse Positive
// Definite Systems, 1981, ch. 4). Cost: O(edges log degree).
std::vector<int> reverse_cuthill_mckee(const Graph& graph);

// One order for all that sweep over the rows of a matrix (RowOrder in block_csr.hpp): a few domains, those with most
// edges first, and the separators between them, each in reverse Cuthill-McKee order. Eight domains whatever the number
// of threads; a single one where the graph has less than a thousand vertices.
// Only the share of the separators in the rows counts here, so a coarse graph is cut: that takes a fraction of the time
// of nested dissection, for separators half as large again. O(edges).
RowOrder cut_into_domains(const Graph& graph);

// A graph whose vertices [0, eliminable) are to be ordered; the rest, its halo, stays.
struct SmallGraph {
    int size = 0;                            // vertices
    int eliminable = 0;
    std::vector<int> weight;                 // one per vertex
    std::vector<std::pair<int, int>> edges;  // each edge once or twice, no loops
};

// The vertices [0, eliminable) in elimination order: always one of least weight of neighbours (halo included), the
// lowest number among equals. The elimination graph is kept explicitly, one row of bits per vertex, so degrees are
// exact and eliminating a vertex is a few word operations per neighbour: faster than a quotient graph up to a few
// hundred vertices. Cost: O(n^3 / 64) at worst.
std::vector<int> minimum_degree(const SmallGraph& graph);

}  // namespace almesh
