#include "linalg/ordering/ordering.hpp"

#include <doctest/doctest.h>

#include <string>

#include "linalg/direct/factor_plan.hpp"
#include "linalg/ordering/nested_dissection.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

constexpr Ordering all[] = {Ordering::nested_dissection, Ordering::minimum_degree, Ordering::reverse_cuthill_mckee,
                            Ordering::natural};

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
