#include "lessons/exercises/10.hpp"

#include <algorithm>
#include <cmath>

#include "lessons/exercise.hpp"
#include "linalg/ordering/ordering.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(multiply_symmetric, factor_entries, order_of_tree, cg_step, sufficient_steps, dissection_of_grid, entries_foretold);

Graph graph_of_edges(int n, const std::vector<std::array<int, 2>>& edges) {
    std::vector<std::vector<int>> adjacent(n);
    for (const auto& [a, b] : edges) {
        adjacent[a].push_back(b);
        adjacent[b].push_back(a);
    }
    Graph graph;
    for (std::vector<int>& of_vertex : adjacent) {
        std::sort(of_vertex.begin(), of_vertex.end());
        graph.adjacent.insert(graph.adjacent.end(), of_vertex.begin(), of_vertex.end());
        graph.start.push_back(static_cast<int>(graph.adjacent.size()));
    }
    return graph;
}

// Points, neighbours in rows and columns joined.
Graph grid(int rows, int columns) {
    std::vector<std::array<int, 2>> edges;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            if (j + 1 < columns) edges.push_back({i * columns + j, i * columns + j + 1});
            if (i + 1 < rows) edges.push_back({i * columns + j, (i + 1) * columns + j});
        }
    return graph_of_edges(rows * columns, edges);
}

Graph renumbered(const Graph& graph, const std::vector<int>& order) {
    const std::vector<int> place = inverse(order);
    std::vector<std::array<int, 2>> edges;
    for (int v = 0; v < graph.size(); ++v)
        for (const int w : graph.neighbours(v))
            if (v < w) edges.push_back({place[v], place[w]});
    return graph_of_edges(graph.size(), edges);
}

// By marking all pairs.
int entries_of_dense_elimination(const Graph& graph) {
    const int n = graph.size();
    std::vector<std::vector<char>> joined(n, std::vector<char>(n));
    for (int v = 0; v < n; ++v)
        for (const int w : graph.neighbours(v)) joined[v][w] = 1;
    int entries = n;
    for (int v = 0; v < n; ++v)
        for (int a = v + 1; a < n; ++a) {
            if (!joined[v][a]) continue;
            ++entries;
            for (int b = v + 1; b < n; ++b)
                if (joined[v][b] && a != b) joined[a][b] = 1;
        }
    return entries;
}

// The matrix of a graph: degree plus 0.1 on the diagonal, -1 for every edge.
BlockCsr matrix_of(const Graph& graph, bool lower_only) {
    BlockCsr A;
    A.n = graph.size();
    A.row.push_back(0);
    for (int i = 0; i < A.n; ++i) {
        std::vector<int> columns(graph.neighbours(i).begin(), graph.neighbours(i).end());
        columns.push_back(i);
        std::sort(columns.begin(), columns.end());
        for (const int j : columns) {
            if (lower_only && j > i) continue;
            A.col.push_back(j);
            A.value.push_back(i == j ? graph.degree(i) + 0.1 : -1);
        }
        A.row.push_back(A.blocks());
    }
    return A;
}

EXERCISE("10.1", "a product with half a matrix") {
    const Graph graph = grid(4, 4);
    const BlockCsr A = matrix_of(graph, false), lower = matrix_of(graph, true);
    Vector x(A.n), expected(A.n);
    for (int i = 0; i < A.n; ++i) x[i] = 1 + std::sin(i);
    multiply(A, x.data(), expected.data());
    const Vector y = multiply_symmetric(lower, x);
    expect(y.size() == x.size(), "y has ", y.size(), " entries, expected ", x.size());
    for (int i = 0; i < A.n; ++i)
        expect_close(concat("entry ", i, " of A x"), y[i], expected[i], 1e-12,
                     "an entry a_ij below the diagonal serves twice, for y_i and for y_j; one on it only once");
}

EXERCISE("10.2", "counting fill") {
    const Graph star_first = graph_of_edges(6, {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}});
    const Graph star_last = graph_of_edges(6, {{5, 0}, {5, 1}, {5, 2}, {5, 3}, {5, 4}});
    const auto compare = [](const char* what, const Graph& graph, const char* hint) {
        const int answer = factor_entries(graph), right = entries_of_dense_elimination(graph);
        expect(answer == right, what, ": nnz(L) is ", answer, ", expected ", right, ": ", hint);
    };
    compare("a star, its centre last", star_last, "no fill, but the entries of A count, and the diagonal");
    compare("a star, its centre first", star_first, "all leaves become neighbours of each other: L is full");
    for (const int m : {3, 6}) {
        const Graph graph = grid(m, m);
        compare("a grid", graph, "fill makes neighbours, whose elimination makes more fill");
        compare("a grid by nested dissection", renumbered(graph, nested_dissection(graph)), "every order counts alike");
    }
}

EXERCISE("10.3", "a tree without fill") {
    for (const int n : {1, 7, 30}) {
        std::vector<std::array<int, 2>> edges;
        for (int v = 1; v < n; ++v) edges.push_back({v, (v * 7 + 3) % v});
        const Graph tree = graph_of_edges(n, edges);
        const std::vector<int> order = order_of_tree(tree);
        std::vector<int> sorted = order;
        std::sort(sorted.begin(), sorted.end());
        for (int v = 0; v < n; ++v)
            expect(static_cast<int>(sorted.size()) == n && sorted[v] == v, "that is no order of the ", n, " vertices");
        const int entries = entries_of_dense_elimination(renumbered(tree, order));
        expect(entries == 2 * n - 1, "a tree of ", n, " vertices has ", entries, " entries in L, expected ", 2 * n - 1,
               ": n on the diagonal and one for each edge; a vertex with one neighbour left makes no fill");
    }
}

EXERCISE("10.4", "a step of conjugate gradients") {
    const BlockCsr A = matrix_of(grid(3, 3), false);
    Vector x(A.n), b(A.n);
    for (int i = 0; i < A.n; ++i) x[i] = std::cos(3 * i);
    multiply(A, x.data(), b.data());
    CgState state = {Vector(A.n), b, b};
    cg_step(A, state);
    double rr = 0, slope = 0;
    for (int i = 0; i < A.n; ++i) {
        rr += state.r[i] * state.r[i];
        slope += state.r[i] * b[i];
    }
    expect(state.x != Vector(A.n), "x has not moved");
    expect_close("after one step, the slope of the energy along the step taken", slope, 0, 1e-10,
                 "alpha = r'r / p'Ap goes to the minimum along p");
    Vector Ap(A.n);
    multiply(A, state.p.data(), Ap.data());
    double conjugate = 0;
    for (int i = 0; i < A.n; ++i) conjugate += Ap[i] * b[i];
    expect_close("p_1' A p_0", conjugate, 0, 1e-10, "p = r + beta p, beta = the new r'r over the old one");
    for (int k = 1; k < A.n; ++k)
        if (std::sqrt(rr) > 1e-13) {
            cg_step(A, state);
            rr = 0;
            for (const double r_i : state.r) rr += r_i * r_i;
        }
    for (int i = 0; i < A.n; ++i)
        expect_close(concat("after ", A.n, " steps, entry ", i, " of x"), state.x[i], x[i], 1e-8,
                     "as many steps as unknowns are enough, but for rounding");
}

EXERCISE("10.5", "how many steps are enough") {
    for (const double kappa : {2.0, 100.0, 1e4, 1e6})
        for (const double factor : {1e-2, 1e-8}) {
            const int k = sufficient_steps(kappa, factor);
            const double root = std::sqrt(kappa);
            const auto bound = [root](int steps) { return 2 * std::pow((root - 1) / (root + 1), steps); };
            expect(k > 0, "kappa = ", kappa, ": ", k, " steps reduce nothing");
            expect(bound(k) <= factor * (1 + 1e-9), "kappa = ", kappa, ": after ", k, " steps the bound is ", bound(k),
                   ", more than ", factor);
            expect(bound(k - 1) > factor * (1 - 1e-9), "kappa = ", kappa, ": ", k - 1, " steps are enough for ", factor,
                   ", the answer was ", k, ": it grows like the root of kappa, not like kappa");
        }
}

// By walking the elimination tree (Liu 1990): row i of L has the vertices between its earlier neighbours and i.
int entries_by_tree(const Graph& graph) {
    std::vector<int> parent(graph.size(), -1), seen(graph.size(), -1);
    int entries = graph.size();
    for (int i = 0; i < graph.size(); ++i) {
        seen[i] = i;
        for (int j : graph.neighbours(i))
            for (; j < i && seen[j] != i; j = parent[j]) {
                if (parent[j] < 0) parent[j] = i;
                seen[j] = i;
                ++entries;
            }
    }
    return entries;
}

EXERCISE("10.6", "an hour: nested dissection counted") {
    struct Case {
        int rows, columns, most;
    };
    for (const auto& [rows, columns, most] : {Case{3, 3, 26}, Case{15, 15, 2350}, Case{20, 45, 13500},
                                              Case{60, 5, 2450}, Case{63, 63, 88000}}) {
        const int n = rows * columns;
        const std::string where = concat(" of ", rows, " x ", columns, " points");
        const std::vector<int> order = dissection_of_grid(rows, columns);
        std::vector<int> sorted = order;
        std::sort(sorted.begin(), sorted.end());
        for (int v = 0; v < n; ++v)
            expect(static_cast<int>(sorted.size()) == n && sorted[v] == v, "that is no order of the ", n, " points", where);
        const int counted = entries_by_tree(renumbered(grid(rows, columns), order));
        expect(counted <= most, "nnz(L)", where, " is ", counted, ", it can be ", most, ": cut across the longer side, ",
               rows == columns ? "and number the separator after both halves, which are ordered alike"
                               : "whichever that is in each piece");
        const double foretold = entries_foretold(rows, columns);
        expect(std::abs(foretold / counted - 1) < (n < 100 ? 0.3 : 0.06), foretold, " entries are foretold", where, ", ",
               counted, " are counted: a separator has a border on those sides of its piece that have been cut, not ",
               "where the grid ends, and its points have each other");
    }
    const auto per_point = [](int m) { return entries_foretold(m, m) / m / m; };
    expect_close("from 1023 x 1023 to 2047 x 2047 points, the growth of nnz(L)/n", per_point(2047) - per_point(1023),
                 7.62, 0.03, "it tends to 31/4 for each doubling");
}

}  // namespace
}  // namespace almesh::lessons
