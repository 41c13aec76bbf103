#include "lessons/exercises/10.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

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

// A matrix with the pattern of a graph, any numbers off the diagonal, and positive definite: the diagonal is greater
// than the sum of their magnitudes.
BlockCsr random_matrix(const Graph& graph) {
    const double unit = random_inputs().scale(1e-3, 1e3);
    std::map<std::array<int, 2>, double> entry;
    for (int i = 0; i < graph.size(); ++i) {
        entry[{i, i}] += unit * random_inputs().uniform(0.1, 1);
        for (const int j : graph.neighbours(i))
            if (j < i) {
                const double value = unit * random_inputs().uniform(-2, 2);
                entry[{i, j}] = entry[{j, i}] = value;
                entry[{i, i}] += std::abs(value), entry[{j, j}] += std::abs(value);
            }
    }
    BlockCsr A;
    A.n = graph.size();
    A.row.assign(A.n + 1, 0);
    for (const auto& [place, value] : entry) {
        A.col.push_back(place[1]);
        A.value.push_back(value);
        ++A.row[place[0] + 1];
    }
    for (int i = 0; i < A.n; ++i) A.row[i + 1] += A.row[i];
    return A;
}

BlockCsr lower_triangle(const BlockCsr& A) {
    BlockCsr lower;
    lower.n = A.n;
    lower.row.push_back(0);
    for (int i = 0; i < A.n; ++i) {
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            if (A.col[k] <= i) lower.col.push_back(A.col[k]), lower.value.push_back(A.value[k]);
        lower.row.push_back(lower.blocks());
    }
    return lower;
}

// n vertices of which each pair is joined with the probability `density`; need not be connected.
Graph random_graph(int n, double density) {
    std::vector<std::array<int, 2>> edges;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j)
            if (random_inputs().uniform(0, 1) < density) edges.push_back({i, j});
    return graph_of_edges(n, edges);
}

Vector random_vector(int n) {
    Vector v(n);
    for (double& entry : v) entry = random_inputs().uniform(-2, 2);
    return v;
}

Vector product(const BlockCsr& A, const Vector& x) {
    Vector y(A.n);
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) y[i] += A.value[k] * x[A.col[k]];
    return y;
}

double dot(const Vector& a, const Vector& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }
double norm(const Vector& a) { return std::sqrt(dot(a, a)); }

EXERCISE("10.1", "a product with half a matrix") {
    for (int run = 0; run < 12; ++run) {
        const BlockCsr A = random_matrix(run == 0   ? grid(4, 4)
                                         : run == 1 ? random_graph(1, 0)
                                         : run == 2 ? grid(random_inputs().integer(20, 30), 30)
                                                    : random_graph(random_inputs().integer(2, 30), 0.3));
        const BlockCsr lower = lower_triangle(A);
        const Vector x = random_vector(A.n), expected = product(A, x), half = product(lower, x),
                     y = multiply_symmetric(lower, x);
        expect(y.size() == x.size(), "y has ", y.size(), " entries, expected ", x.size());
        const double unit = *std::max_element(A.value.begin(), A.value.end());
        for (int i = 0; i < A.n; ++i)
            expect(std::abs(y[i] - expected[i]) <= 1e-11 * unit, "entry ", i, " of A x, of ", A.n, " rows, is ", y[i],
                   ", expected ", expected[i],
                   std::abs(y[i] - half[i]) <= 1e-11 * unit
                       ? ": that is the product with the lower triangle alone"
                       : ": which entries of A stand in `lower`, and for how many?");
    }
}

EXERCISE("10.2", "counting fill") {
    const Graph star_first = graph_of_edges(6, {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}});
    const Graph star_last = graph_of_edges(6, {{5, 0}, {5, 1}, {5, 2}, {5, 3}, {5, 4}});
    const auto compare = [](const std::string& what, const Graph& graph, const char* hint) {
        const int answer = factor_entries(graph), right = entries_of_dense_elimination(graph);
        expect(answer == right, what, ": nnz(L) is ", answer, ", expected ", right, ": ", hint);
    };
    compare("a star, its centre last", star_last, "no fill, but the entries of A count, and the diagonal");
    compare("a star, its centre first", star_first, "all leaves become neighbours of each other: L is full");
    for (int k = 0; k < 8; ++k) {
        const int rows = random_inputs().integer(2, 7), columns = random_inputs().integer(2, 7);
        const std::string what = concat("a grid of ", rows, " x ", columns);
        const Graph graph = grid(rows, columns);
        std::vector<int> order(graph.size());
        std::iota(order.begin(), order.end(), 0);
        random_inputs().shuffle(order);
        compare(what, graph, "fill makes neighbours, whose elimination makes more fill");
        compare(what + ", numbered at random", renumbered(graph, order),
                "fill makes neighbours, whose elimination makes more");
        compare(what + " by nested dissection", renumbered(graph, nested_dissection(graph)),
                "every order counts alike");
    }
    for (int k = 0; k < 16; ++k) {
        const int n = k == 0 ? 1 : k == 1 ? random_inputs().integer(130, 200) : random_inputs().integer(2, 25);
        const double density = k == 1 ? 0.01 : random_inputs().uniform(0, 0.4);
        compare(concat("a graph of ", n, " vertices"), random_graph(n, density),
                "a graph may be in several parts, and a vertex may have no neighbours");
    }
}

// A tree with any numbers. kind 0: each vertex joined to any one before it, 1: a path, 2: a star, 3: a path with
// leaves.
Graph random_tree(int n, int kind) {
    std::vector<int> number(n);
    std::iota(number.begin(), number.end(), 0);
    random_inputs().shuffle(number);
    std::vector<std::array<int, 2>> edges;
    for (int v = 1; v < n; ++v) {
        const int parent = kind == 0   ? random_inputs().integer(0, v - 1)
                           : kind == 1 ? v - 1
                           : kind == 2 ? 0
                                       : v - 1 - v % 2;
        edges.push_back({number[v], number[std::max(0, parent)]});
    }
    return graph_of_edges(n, edges);
}

EXERCISE("10.3", "a tree without fill") {
    for (int k = 0; k < 30; ++k) {
        const int n = k < 3 ? k + 1 : k < 7 ? random_inputs().integer(130, 200) : random_inputs().integer(4, 40);
        const Graph tree = random_tree(n, k % 4);
        const std::vector<int> order = order_of_tree(tree);
        std::vector<int> sorted = order;
        std::sort(sorted.begin(), sorted.end());
        for (int v = 0; v < n; ++v)
            expect(static_cast<int>(sorted.size()) == n && sorted[v] == v, "that is no order of the ", n, " vertices");
        const int entries = entries_of_dense_elimination(renumbered(tree, order));
        expect(entries == 2 * n - 1, "a tree of ", n, " vertices has ", entries, " entries in L, expected ", 2 * n - 1,
               ": n on the diagonal and one for each edge; which vertex can be eliminated without fill?");
    }
}

EXERCISE("10.4", "a step of conjugate gradients") {
    for (int run = 0; run < 6; ++run) {
        const int n = run == 0 ? 9 : random_inputs().integer(3, 14);
        const BlockCsr A = random_matrix(run == 0 ? grid(3, 3) : random_graph(n, 0.4));
        const Vector solution = random_vector(n), b = product(A, solution);
        CgState state;
        state.x = random_vector(n);
        state.r = product(A, state.x);
        for (int i = 0; i < n; ++i) state.r[i] = b[i] - state.r[i];
        state.p = state.r;
        const double start = dot(state.r, state.r);
        const std::string of = concat(" with ", n, " unknowns");
        for (int step = 1; step <= n && dot(state.r, state.r) > 1e-20 * start; ++step) {
            const CgState before = state;
            cg_step(A, state);
            const bool whole = state.x.size() == b.size() && state.r.size() == b.size() && state.p.size() == b.size();
            expect(whole, "x, r or p has another length after step ", step);
            const Vector Ap = product(A, before.p), Ax = product(A, state.x);
            const double scale = std::sqrt(start) * 1e-8;
            expect(state.x != before.x, "x has not moved", of);
            const double along = dot(before.r, before.r) / dot(before.p, Ap);
            for (int i = 0; i < n; ++i)
                expect(std::abs(state.x[i] - before.x[i] - along * before.p[i]) <= 1e-7 * along * norm(before.p),
                       "step ", step, of, " moves entry ", i, " of x by ", state.x[i] - before.x[i], ", expected ",
                       along * before.p[i], ": a step goes along p, how far it goes is a product with A");
            for (int i = 0; i < n; ++i)
                expect(std::abs(b[i] - Ax[i] - state.r[i]) < scale, "after step ", step, of, " entry ", i, " of r is ",
                       state.r[i], ", and that of b - A x is ", b[i] - Ax[i]);
            expect(std::abs(dot(state.r, before.p)) <= scale * std::sqrt(dot(before.p, before.p)), "after step ", step,
                   of, " the slope of the energy along the step taken is ", -dot(state.r, before.p),
                   ", expected 0: the step ", "goes to the minimum along p");
            if (dot(state.r, state.r) < 1e-20 * start) break;
            const double across = dot(Ap, state.p) / std::sqrt(dot(Ap, Ap) * dot(state.p, state.p));
            expect(std::abs(across) < 1e-6, "p_", step, "' A p_", step - 1, of, ", both and A p of length 1, is ",
                   across, ", expected 0: how much of the last p has to be added to r?");
        }
        for (int i = 0; i < n; ++i)
            expect(std::abs(state.x[i] - solution[i]) < 1e-6, "after ", n, " steps", of, " entry ", i, " of x is ",
                   state.x[i], ", expected ", solution[i], ": as many steps as unknowns are enough, but for rounding");
    }
}

EXERCISE("10.5", "how many steps are enough") {
    for (int run = 0; run < 40; ++run) {
        const double kappa = 1 + random_inputs().scale(run % 2 ? 1e-3 : 10, run % 2 ? 100 : 1e6),
                     factor = run % 5 ? random_inputs().scale(1e-12, 0.9) : random_inputs().uniform(0.1, 0.99);
        const int k = sufficient_steps(kappa, factor);
        const double root = std::sqrt(kappa);
        const auto bound = [root](int steps) { return 2 * std::pow((root - 1) / (root + 1), steps); };
        expect(k > 0, "kappa = ", kappa, ": ", k, " steps reduce nothing");
        expect(bound(k) <= factor * (1 + 1e-9), "kappa = ", kappa, ": after ", k, " steps the bound is ", bound(k),
               ", more than ", factor);
        int enough = 1;
        while (bound(enough) > factor * (1 - 1e-9)) ++enough;
        expect(k <= enough, "kappa = ", kappa, ": ", enough, " steps are enough for ", factor, ", the answer was ", k,
               k > 2 * enough + 1 ? ": it grows like the root of kappa, not like kappa" : "");
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

// a., added up. border: whether later points lie before the first row, behind the last one, and so for columns.
double added_up(int rows, int columns, std::array<bool, 4> border) {
    if (rows < columns) return added_up(columns, rows, {border[2], border[3], border[0], border[1]});
    if (columns == 0) return 0;
    const double s = columns, b = columns * (border[0] + border[1]) + rows * (border[2] + border[3]);
    const int half = rows / 2;
    return s * s / 2 + s * b + added_up(half, columns, {border[0], true, border[2], border[3]}) +
           added_up(rows - half - 1, columns, {true, border[1], border[2], border[3]});
}

EXERCISE("10.6", "an hour: nested dissection counted") {
    std::vector<std::array<int, 2>> grids = {{3, 3}, {15, 15}, {63, 63}};
    for (int k = 0; k < 4; ++k) {
        grids.push_back({random_inputs().integer(5, 50), random_inputs().integer(5, 50)});
        grids.push_back({random_inputs().integer(1, 8), random_inputs().integer(20, 80)});
        if (k % 2) std::swap(grids.back()[0], grids.back()[1]);
    }
    for (const auto& [rows, columns] : grids) {
        const int n = rows * columns;
        const double expected = added_up(rows, columns, {}),
                     most = 1.1 * (expected + 0.5 * n);  // with the terms of order s
        const std::string where = concat(" of ", rows, " x ", columns, " points");
        const std::vector<int> order = dissection_of_grid(rows, columns);
        std::vector<int> sorted = order;
        std::sort(sorted.begin(), sorted.end());
        for (int v = 0; v < n; ++v)
            expect(static_cast<int>(sorted.size()) == n && sorted[v] == v, "that is no order of the ", n, " points",
                   where);
        const int counted = entries_by_tree(renumbered(grid(rows, columns), order));
        expect(counted <= most, "nnz(L)", where, " is ", counted, ", it can be less than ", std::ceil(most),
               ": which side of each piece is cut, and what is numbered last?");
        const double foretold = entries_foretold(rows, columns);
        expect(std::abs(foretold / counted - 1) < (std::min(rows, columns) < 10 ? 0.3 : 0.06), foretold,
               " entries are foretold", where, ", ", counted,
               " are counted: on which sides of its piece does a separator have ",
               "later points, and what do its points have of each other?");
    }
    for (int k = 0; k < 4; ++k) {
        const int rows = random_inputs().integer(200, 1200), columns = random_inputs().integer(200, 1200);
        const double expected = added_up(rows, columns, {}), foretold = entries_foretold(rows, columns);
        expect(std::abs(foretold / expected - 1) < 0.06, foretold, " entries are foretold of ", rows, " x ", columns,
               " points, added up over all separators they are ", expected);
    }
    const auto per_point = [](int m) { return entries_foretold(m, m) / m / m; };
    expect_close("from 1023 x 1023 to 2047 x 2047 points, the growth of nnz(L)/n", per_point(2047) - per_point(1023),
                 7.62, 0.03, "it tends to 31/4 for each doubling");
}

}  // namespace
}  // namespace almesh::lessons
