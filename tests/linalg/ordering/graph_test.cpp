#include "linalg/ordering/graph.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

int bandwidth(const Graph& graph, const std::vector<int>& order) {
    const std::vector<int> position = inverse(order);
    int widest = 0;
    for (int v = 0; v < graph.size(); ++v)
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
            widest = std::max(widest, std::abs(position[v] - position[graph.adjacent[k]]));
    return widest;
}

std::vector<int> shuffled(int n) {
    std::vector<int> order(n);
    for (int i = 0; i < n; ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(2));
    return order;
}

Edges renumbered(Edges edges, const std::vector<int>& to) {
    for (auto& [i, j] : edges) i = to[i], j = to[j];
    return edges;
}

}  // namespace

TEST_CASE("graph of a pattern: ascending, without loops") {
    BlockCsr A;  // rows {0, 2}, {1}, {0, 2}
    A.n = 3;
    A.row = {0, 2, 3, 5};
    A.col = {0, 2, 1, 0, 2};
    const Graph graph = graph_of(A);
    CHECK(graph.start == std::vector<int>{0, 1, 1, 2});
    CHECK(graph.adjacent == std::vector<int>{2, 0});
    CHECK(graph_of(BlockCsr{0, 1, {0}, {}, {}}).size() == 0);
}

TEST_CASE("permutations") {
    const std::vector<int> order = shuffled(50), position = inverse(order);
    for (int i = 0; i < 50; ++i) CHECK(position[order[i]] == i);
    CHECK(is_permutation(order));
    CHECK_FALSE(is_permutation({0, 0}));
    CHECK_FALSE(is_permutation({0, 2}));
    CHECK_FALSE(is_permutation({-1, 0}));
}

TEST_CASE("reverse Cuthill-McKee finds the bandwidth of a shuffled path and a shuffled grid") {
    const Graph line = graph_of(random_spd(200, 1, renumbered(path(200), shuffled(200))));
    CHECK(bandwidth(line, reverse_cuthill_mckee(line)) == 1);
    const Graph square = graph_of(random_spd(400, 1, renumbered(grid(20, 20), shuffled(400))));
    const std::vector<int> order = reverse_cuthill_mckee(square);
    CHECK(is_permutation(order));
    CHECK(bandwidth(square, order) <= 41);  // 21 in the best numbering, hundreds when shuffled
}

TEST_CASE("reverse Cuthill-McKee numbers every component") {
    Edges edges = path(5);
    edges.push_back({7, 8});  // vertices 5, 6, 9 stand alone
    CHECK(is_permutation(reverse_cuthill_mckee(graph_of(random_spd(10, 2, edges)))));
    CHECK(reverse_cuthill_mckee(Graph{}).empty());
}

TEST_CASE("compression joins the nodes of one cell interior and of one edge of degree 4") {
    const BlockCsr A = matrix_of_cells(17 * 17, 1, quartic_cells(4, 4), 15);
    const CompressedGraph compressed = compress(graph_of(A));
    // 32 cells, 40 inner edges and 25 vertices. The 16 boundary edges and two corners lie in one cell only and join its
    // interior, the other two corners in two cells only and join the edge between them.
    CHECK(compressed.graph.size() == 32 + 40 + 25 - 4);
    CHECK(is_permutation(compressed.members.item));
    CHECK(*std::max_element(compressed.graph.weight.begin(), compressed.graph.weight.end()) == 3 + 1 + 3 + 3);
    CHECK(compress(graph_of(random_spd(9, 1, complete(9)))).graph.size() == 1);
    CHECK(compress(graph_of(random_spd(9, 1, path(9)))).graph.size() == 9);
}
