#include "linalg/ordering/minimum_degree.hpp"

#include <bit>
#include <cstdint>
#include <numeric>

namespace almesh {

namespace {

using Word = std::uint64_t;

template <class Body>
void for_each_bit(const Word* bits, int words, const Body& body) {
    for (int w = 0; w < words; ++w)
        for (Word rest = bits[w]; rest; rest &= rest - 1) body(w * 64 + std::countr_zero(rest));
}

}  // namespace

std::vector<int> minimum_degree(const SmallGraph& graph) {
    const int words = (graph.size + 63) / 64;
    std::vector<Word> bits(static_cast<std::size_t>(graph.size) * words, 0);
    auto row = [&](int v) { return bits.data() + static_cast<std::size_t>(v) * words; };
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

}  // namespace almesh
