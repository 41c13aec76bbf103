#include "linalg/direct/factor_plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

// Rows of every column of L by eliminating vertex after vertex.
std::vector<std::set<int>> eliminate(const Graph& graph, const std::vector<int>& order) {
    const std::vector<int> position = inverse(order);
    std::vector<std::set<int>> rows(graph.size());
    for (int j = 0; j < graph.size(); ++j)
        for (int v = order[j], k = graph.start[v]; k < graph.start[v + 1]; ++k)
            if (position[graph.adjacent[k]] > j) rows[j].insert(position[graph.adjacent[k]]);
    for (auto& column : rows)
        if (!column.empty()) {
            std::set<int>& next = rows[*column.begin()];
            next.insert(std::next(column.begin()), column.end());
        }
    return rows;
}

}  // namespace

TEST_CASE("tree, counts and rows are those of the elimination itself") {
    Edges apart = grid(9, 8);
    for (const auto& [i, j] : path(30)) apart.push_back({i + 80, j + 80});
    const std::vector<BlockCsr> matrices = {random_spd(1, 1, {}), random_spd(30, 1, {}), random_spd(40, 1, path(40)),
                                            random_spd(40, 1, star(40)), random_spd(30, 1, complete(30)),
                                            random_spd(400, 1, grid(20, 20)), random_spd(343, 1, grid_3d(7)),
                                            random_spd(110, 1, apart), random_spd(200, 1, random_edges(200, 500, 3))};
    for (const BlockCsr& A : matrices)
        for (int d = 1; d <= 3; ++d) {
            const Graph graph = graph_of(A);
            const AssemblyTree tree = build_assembly_tree(graph, nested_dissection(graph), d);
            CHECK(is_permutation(tree.order));
            const std::vector<std::set<int>> rows = eliminate(graph, tree.order);
            REQUIRE(tree.first.front() == 0);
            REQUIRE(tree.first.back() == A.n);
            for (int f = 0; f < tree.fronts(); ++f) {
                const auto begin = tree.rows.begin() + tree.row_start[f], end = begin + tree.update_rows(f);
                CHECK(tree.columns(f) > 0);
                CHECK(std::is_sorted(begin, end));
                std::set<int> all(begin, end);
                CHECK(static_cast<int>(all.size()) == tree.update_rows(f));
                for (int j = tree.first[f]; j < tree.first[f + 1]; ++j) {
                    CHECK(tree.column_count[j] == static_cast<int>(rows[j].size()) + 1);
                    for (int i : rows[j]) CHECK((i < tree.first[f + 1] || all.count(i) == 1));
                }
                // The parent is the front of the first row below, and holds all the rows.
                const int p = tree.parent[f];
                CHECK((p == -1) == all.empty());
                if (p < 0) continue;
                REQUIRE(p > f);
                CHECK(*all.begin() >= tree.first[p]);
                CHECK(*all.begin() < tree.first[p + 1]);
                for (int i : all)
                    CHECK((i < tree.first[p + 1] || std::binary_search(tree.rows.begin() + tree.row_start[p],
                                                                       tree.rows.begin() + tree.row_start[p + 1], i)));
            }
        }
}

TEST_CASE("elimination trees known by heart") {
    const std::vector<int> natural{0, 1, 2, 3, 4};
    CHECK(elimination_tree(graph_of(random_spd(5, 1, path(5))), natural) == std::vector<int>{1, 2, 3, 4, -1});
    CHECK(elimination_tree(graph_of(random_spd(5, 1, star(5))), {1, 2, 3, 4, 0}) == std::vector<int>{4, 4, 4, 4, -1});
    CHECK(elimination_tree(graph_of(random_spd(5, 1, {})), natural) == std::vector<int>(5, -1));
}

TEST_CASE("a dense matrix is one front, a grid has far fewer fronts than columns") {
    const Graph dense = graph_of(random_spd(50, 1, complete(50))), square = graph_of(random_spd(2500, 1, grid(50, 50)));
    CHECK(build_assembly_tree(dense, nested_dissection(dense), 3).fronts() == 1);
    const AssemblyTree tree = build_assembly_tree(square, nested_dissection(square), 2);
    CHECK(tree.fronts() < 2500 / 3);
    double stored = 0, needed = 0;
    for (int f = 0; f < tree.fronts(); ++f)
        for (int c = 0; c < tree.columns(f); ++c) stored += tree.columns(f) - c + tree.update_rows(f);
    for (int count : tree.column_count) needed += count;
    CHECK(stored >= needed);
    CHECK(stored < 1.5 * needed);
}
