// Minimum degree: eliminates a vertex of least degree, joins its neighbours to a clique, and repeats. Reverse
// Cuthill-McKee: breadth-first search from an end of the graph, reversed.
#include "linalg/ordering/ordering.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>

#include "base/index.hpp"
#include "linalg/ordering/graph.hpp"

namespace almesh {

const char* to_string(Ordering ordering) {
    constexpr const char* name[] = {"nested_dissection", "minimum_degree", "rcm", "natural"};
    return name[static_cast<int>(ordering)];
}

namespace {

using Word = std::uint64_t;

template <class Body>
void for_each_bit(const Word* bits, int words, const Body& body) {
    for (int w = 0; w < words; ++w)
        for (Word rest = bits[w]; rest; rest &= rest - 1) body(w * 64 + std::countr_zero(rest));
}

// Appends the component of `root` to `order` in Cuthill-McKee order and returns how many levels it has; mark[v] =
// `stamp` for the vertices reached.
int breadth_first(const Graph& graph, int root, int stamp, std::vector<int>& mark, std::vector<int>& order) {
    std::size_t begin = order.size(), end = begin + 1;
    order.push_back(root);
    mark[root] = stamp;
    int levels = 0;
    for (; begin < order.size(); ++levels) {
        end = order.size();
        for (; begin < end; ++begin) {
            const int v = order[begin];
            const std::size_t first = order.size();
            for (int u : graph.neighbours(v))
                if (mark[u] != stamp) {
                    mark[u] = stamp;
                    order.push_back(u);
                }
            std::stable_sort(order.begin() + first, order.end(),
                             [&](int a, int b) { return graph.degree(a) < graph.degree(b); });
        }
    }
    return levels;
}

}  // namespace

std::vector<int> minimum_degree(const SmallGraph& graph) {
    const int words = (graph.size + 63) / 64;
    std::vector<Word> bits(offset(graph.size, words), 0);
    auto row = [&](int v) { return bits.data() + offset(v, words); };
    auto clear = [&](int u, int v) { row(u)[v / 64] &= ~(Word(1) << (v % 64)); };
    for (const auto& [u, v] : graph.edges) {
        row(u)[v / 64] |= Word(1) << (v % 64);
        row(v)[u / 64] |= Word(1) << (u % 64);
    }
    std::vector<int> degree(graph.size, 0), left(graph.eliminable), order;
    for (int v = 0; v < graph.size; ++v) for_each_bit(row(v), words, [&](int u) { degree[v] += graph.weight[u]; });
    std::iota(left.begin(), left.end(), 0);
    while (!left.empty()) {
        std::size_t best = 0;
        for (std::size_t k = 1; k < left.size(); ++k)
            if (degree[left[k]] < degree[left[best]]) best = k;
        const int pivot = left[best];
        left.erase(left.begin() + best);
        order.push_back(pivot);
        const Word* const clique = row(pivot);
        for_each_bit(clique, words, [&](int u) {
            clear(u, pivot);
            degree[u] -= graph.weight[pivot];
            Word* const own = row(u);
            for (int w = 0; w < words; ++w) {
                Word fill = clique[w] & ~own[w];
                if (w == u / 64) fill &= ~(Word(1) << (u % 64));
                if (fill == 0) continue;
                own[w] |= fill;
                for_each_bit(&fill, 1, [&](int bit) { degree[u] += graph.weight[w * 64 + bit]; });
            }
        });
    }
    return order;
}

std::vector<int> reverse_cuthill_mckee(const Graph& graph) {
    std::vector<int> order, mark(graph.size(), -1);
    order.reserve(graph.size());
    int stamp = 0;
    for (int v = 0; v < graph.size(); ++v) {
        if (mark[v] >= 0) continue;  // in a component that has been numbered
        // A last vertex of a longest breadth-first search is a good end of the component (George & Liu's
        // pseudo-peripheral vertex): start there.
        const std::size_t begin = order.size();
        int root = v, levels = 0;
        for (;;) {
            const int deeper = breadth_first(graph, root, stamp++, mark, order);
            if (deeper <= levels) break;
            levels = deeper;
            root = order.back();
            order.resize(begin);
        }
    }
    std::reverse(order.begin(), order.end());
    return order;
}

std::vector<int> order_vertices(const Graph& graph, Ordering ordering) {
    if (ordering == Ordering::nested_dissection) return nested_dissection(graph);
    if (ordering == Ordering::reverse_cuthill_mckee) return reverse_cuthill_mckee(graph);
    if (ordering == Ordering::minimum_degree) {
        const CompressedGraph compressed = compress(graph);
        const int groups = compressed.graph.size();
        SmallGraph small{groups, groups, compressed.graph.weight, {}};
        for (int g = 0; g < groups; ++g)
            for (int h : compressed.graph.neighbours(g)) small.edges.push_back({g, h});
        return expand(compressed, minimum_degree(small));
    }
    std::vector<int> natural(graph.size());
    std::iota(natural.begin(), natural.end(), 0);
    return natural;
}

}  // namespace almesh
