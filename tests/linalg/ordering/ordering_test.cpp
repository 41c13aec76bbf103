#include "linalg/ordering/ordering.hpp"

#include <doctest/doctest.h>

#include <string>

#include "base/parallel.hpp"
#include "linalg/block_csr.hpp"
#include "linalg/direct/factor_plan.hpp"
#include "linalg/ordering/graph.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

constexpr Ordering all[] = {Ordering::nested_dissection, Ordering::minimum_degree, Ordering::reverse_cuthill_mckee,
                            Ordering::natural};

SmallGraph small(int n, const Edges& edges) { return {n, n, std::vector<int>(n, 1), edges}; }

long long fill(int n, const Edges& edges, const std::vector<int>& order) {
    const AssemblyTree tree = build_assembly_tree(graph_of(random_spd(n, 1, edges)), order, 1);
    long long entries = 0;
    for (int count : tree.column_count) entries += count;
    return entries;
}

double factor_entries(const BlockCsr& A, const std::vector<int>& order) {
    return plan_factorisation(A, graph_of(A), order).factor_entries;
}

}  // namespace

TEST_CASE("every ordering of every graph is a permutation, and the predicted nnz(L) is that of the dense factor") {
    Edges two_parts = grid(5, 6);
    for (const auto& [i, j] : complete(20)) two_parts.push_back({i + 40, j + 40});
    const BlockCsr matrices[] = {random_spd(0, 1, {}),
                                 random_spd(1, 3, {}),
                                 random_spd(30, 2, {}),
                                 random_spd(60, 1, star(60)),
                                 random_spd(60, 1, two_parts),
                                 random_spd(40, 1, complete(40)),
                                 random_spd(100, 2, grid(10, 10)),
                                 random_spd(64, 1, grid_3d(4)),
                                 random_spd(120, 1, random_edges(120, 300, 5))};
    for (const BlockCsr& A : matrices)
        for (Ordering ordering : all) {
            CAPTURE(to_string(ordering));
            const Graph graph = graph_of(A);
            const std::vector<int> order = order_vertices(graph, ordering);
            CHECK(order.size() == static_cast<std::size_t>(A.n));
            CHECK(is_permutation(order));
            Dense L = to_dense(A, order);
            REQUIRE(dense_cholesky(L) == -1);
            int entries = 0;
            for (int j = 0; j < L.n; ++j)
                for (int i = j; i < L.n; ++i) entries += L(i, j) != 0;
            CHECK(plan_factorisation(A, graph, order).factor_entries == entries);
        }
}

TEST_CASE("the orderings are those of their names") {
    const Graph graph = graph_of(random_spd(200, 1, grid(10, 20)));
    CHECK(order_vertices(graph, Ordering::nested_dissection) == nested_dissection(graph));
    CHECK(order_vertices(graph, Ordering::reverse_cuthill_mckee) == reverse_cuthill_mckee(graph));
    CHECK(order_vertices(graph, Ordering::natural) == inverse(order_vertices(graph, Ordering::natural)));
    CHECK(order_vertices(graph, Ordering::natural).front() == 0);
    // Minimum degree eliminates a tree without fill.
    const BlockCsr arrow = random_spd(300, 1, star(300));
    const Graph star_graph = graph_of(arrow);
    CHECK(plan_factorisation(arrow, star_graph, order_vertices(star_graph, Ordering::minimum_degree)).factor_entries ==
          599);
    CHECK(std::string(to_string(Ordering::reverse_cuthill_mckee)) == "rcm");
}

TEST_CASE("minimum degree orders trees without fill") {
    Edges tree;
    for (int v = 1; v < 200; ++v) tree.push_back({v, (v - 1) / 3});
    for (const Edges& edges : {path(200), star(200), tree}) {
        const std::vector<int> order = minimum_degree(small(200, edges));
        CHECK(is_permutation(order));
        CHECK(fill(200, edges, order) == 200 + 199);
    }
}

TEST_CASE("minimum degree beats the natural order on a grid") {
    const Edges edges = grid(14, 14);
    const std::vector<int> order = minimum_degree(small(196, edges));
    std::vector<int> natural(196);
    for (int i = 0; i < 196; ++i) natural[i] = i;
    CHECK(is_permutation(order));
    CHECK(fill(196, edges, order) < 0.75 * fill(196, edges, natural));
}

TEST_CASE("heavy neighbours and the halo count, but the halo is not ordered") {
    // A path 0 - 1 - 2 - 3: both ends have one neighbour; weights or a halo next to 0 make the other end the first.
    SmallGraph line = small(4, path(4));
    CHECK(minimum_degree(line).front() == 0);
    line.weight[1] = 5;
    CHECK(minimum_degree(line) == std::vector<int>{3, 1, 0, 2});  // then the neighbours of 0, 1, 2 weigh 5, 2, 5
    line = small(4, path(4));
    line.size = 6;
    line.weight.resize(6, 1);
    line.edges.insert(line.edges.end(), {{4, 0}, {5, 0}});
    const std::vector<int> order = minimum_degree(line);
    CHECK(order.front() == 3);
    CHECK(is_permutation(order));
    CHECK(order.size() == 4);
}

TEST_CASE("no vertices, no edges") {
    CHECK(minimum_degree(small(0, {})).empty());
    CHECK(minimum_degree(small(70, {})).size() == 70);
}

TEST_CASE("nested dissection of anything is a permutation") {
    Edges parts = grid(20, 20);
    for (const auto& [i, j] : complete(200)) parts.push_back({i + 450, j + 450});
    const std::vector<BlockCsr> matrices = {
        random_spd(1, 1, {}),              random_spd(500, 1, {}),
        random_spd(1000, 1, path(1000)),   random_spd(1000, 1, star(1000)),
        random_spd(300, 1, complete(300)), random_spd(700, 1, parts),
        random_spd(2500, 2, grid(50, 50)), random_spd(1000, 3, grid_3d(10)),
        random_spd(800, 1, random_edges(800, 3000, 4))};
    for (const BlockCsr& A : matrices) {
        const std::vector<int> order = nested_dissection(graph_of(A));
        CHECK(order.size() == static_cast<std::size_t>(A.n));
        CHECK(is_permutation(order));
    }
    CHECK(nested_dissection(Graph{}).empty());
}

TEST_CASE("a bipartite graph that no small separator splits") {
    Edges edges;
    for (int i = 0; i < 100; ++i)
        for (int j = 100; j < 250; ++j) edges.push_back({i, j});
    CHECK(is_permutation(nested_dissection(graph_of(random_spd(250, 1, edges)))));
}

TEST_CASE("a star is ordered without fill, a path with one entry of fill per column") {
    const BlockCsr line = random_spd(5000, 1, path(5000)), arrow = random_spd(5000, 1, star(5000));
    CHECK(factor_entries(line, nested_dissection(graph_of(line))) < 3 * 5000);
    CHECK(factor_entries(arrow, nested_dissection(graph_of(arrow))) == 9999);
}

// Reference values: METIS 5.1.0 (METIS_NodeND with its default options) on the same graphs, entries of L.
TEST_CASE("fill on grids is close to that of METIS") {
    const BlockCsr square = random_spd(100 * 100, 1, grid(100, 100)), cube = random_spd(16 * 16 * 16, 1, grid_3d(16));
    CHECK(factor_entries(square, nested_dissection(graph_of(square))) < 1.10 * 289764);
    CHECK(factor_entries(cube, nested_dissection(graph_of(cube))) < 1.10 * 232073);
}

TEST_CASE("the order does not depend on the number of threads") {
    const Graph graph = graph_of(random_spd(90 * 90, 1, grid(90, 90)));
    const int before = max_threads();
    set_threads(1);
    const std::vector<int> first = nested_dissection(graph);
    for (int threads : {2, 3, 8}) {
        set_threads(threads);
        CHECK(nested_dissection(graph) == first);
    }
    set_threads(before);
}
