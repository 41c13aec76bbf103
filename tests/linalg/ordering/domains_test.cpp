#include "linalg/ordering/ordering.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "linalg/block_csr.hpp"
#include "linalg/ordering/graph.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

Graph graph_with(int n, const Edges& edges) { return graph_of(random_spd(n, 1, edges)); }

int count(const RowOrder& domains) { return static_cast<int>(domains.start.size()) - 1; }

// Domain of every vertex, count(domains) in the separators.
std::vector<int> domain_of(const RowOrder& domains) {
    std::vector<int> domain(domains.node.size());
    for (int i = 0; i < static_cast<int>(domains.node.size()); ++i)
        domain[domains.node[i]] =
            static_cast<int>(std::upper_bound(domains.start.begin(), domains.start.end(), i) - domains.start.begin()) -
            1;
    return domain;
}

bool separated(const Graph& graph, const RowOrder& domains) {
    const std::vector<int> domain = domain_of(domains);
    for (int v = 0; v < graph.size(); ++v)
        for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
            const int u = graph.adjacent[k];
            if (domain[u] != domain[v] && domain[u] != count(domains) && domain[v] != count(domains)) return false;
        }
    return true;
}

}  // namespace

TEST_CASE("eight domains of like size that no edge joins, and few vertices between them") {
    for (const Graph& graph : {graph_with(8000, grid_3d(20)), graph_with(10000, grid(100, 100)),
                               graph_with(6000, random_edges(6000, 4000, 5)), graph_with(5000, path(5000))}) {
        const RowOrder domains = cut_into_domains(graph);
        CHECK(is_permutation(domains.node));
        CHECK(static_cast<int>(domains.node.size()) == graph.size());
        CHECK(count(domains) == 8);
        CHECK(domains.start.front() == 0);
        CHECK(separated(graph, domains));
        for (int k = 0; k < 8; ++k) {
            const int size = domains.start[k + 1] - domains.start[k];
            CHECK(size > graph.size() / 8 / 2);
            CHECK(size < graph.size() / 8 * 2);
        }
        CHECK(graph.size() - domains.start.back() < 0.25 * graph.size());
    }
}

TEST_CASE("domains with most edges come first") {
    const Graph graph = graph_with(6000, random_edges(6000, 4000, 5));
    const RowOrder domains = cut_into_domains(graph);
    std::vector<int> edges(count(domains), 0);
    for (int k = 0; k < count(domains); ++k)
        for (int i = domains.start[k]; i < domains.start[k + 1]; ++i) edges[k] += graph.degree(domains.node[i]);
    CHECK(std::is_sorted(edges.rbegin(), edges.rend()));
    CHECK(edges.front() > edges.back());
}

TEST_CASE("the separators of a plane grid are lines") {
    const RowOrder domains = cut_into_domains(graph_with(10000, grid(100, 100)));
    CHECK(10000 - domains.start.back() < 1000);  // 100 + 2 * 50 + 4 * 50 at best
}

TEST_CASE("a graph that cannot be cut has one separator of everything, and gives an order all the same") {
    const Graph graph = graph_with(5000, star(5000));
    const RowOrder domains = cut_into_domains(graph);
    CHECK(is_permutation(domains.node));
    CHECK(separated(graph, domains));
}

TEST_CASE("small and empty graphs are one domain in reverse Cuthill-McKee order") {
    const Graph graph = graph_with(100, grid(10, 10));
    const RowOrder domains = cut_into_domains(graph);
    CHECK(domains.node == reverse_cuthill_mckee(graph));
    CHECK(domains.start == std::vector<int>{0, 100});
    CHECK(cut_into_domains(graph_with(0, {})).start == std::vector<int>{0, 0});
}
