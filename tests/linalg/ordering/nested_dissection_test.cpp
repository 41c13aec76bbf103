#include "linalg/ordering/nested_dissection.hpp"

#include <doctest/doctest.h>

#include "base/parallel.hpp"
#include "linalg/direct/factor_plan.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

double factor_entries(const BlockCsr& A, const std::vector<int>& order) {
    return plan_factorisation(A, graph_of(A), order).factor_entries;
}

}  // namespace

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
