#include "linalg/direct/cholesky.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

struct Case {
    std::string name;
    int n;
    Edges edges;
};

std::vector<Case> small_cases() {
    Edges two_parts = grid(6, 6);
    for (const auto& [i, j] : grid(5, 5)) two_parts.push_back({i + 40, j + 40});  // 36 .. 39 stand alone
    return {{"1 x 1", 1, {}},
            {"diagonal", 20, {}},
            {"tridiagonal", 50, path(50)},
            {"arrow", 60, star(60)},
            {"dense", 70, complete(70)},
            {"disconnected", 65, two_parts},
            {"grid", 195, grid(13, 15)},
            {"3D grid", 216, grid_3d(6)},
            {"random", 150, random_edges(150, 400, 9)}};
}

std::vector<double> solve(const BlockCsr& A, const std::vector<double>& b) {
    Cholesky cholesky(A);
    std::vector<double> x(A.size());
    REQUIRE(cholesky.factor(A).status == SolveStatus::success);
    cholesky.solve(b.data(), x.data());
    return x;
}

}  // namespace

TEST_CASE("solutions are those of a dense Cholesky factorisation, d = 1, 2, 3") {
    for (const Case& test : small_cases())
        for (int d = 1; d <= 3; ++d) {
            CAPTURE(test.name);
            CAPTURE(d);
            const BlockCsr A = random_spd(test.n, d, test.edges);
            const std::vector<double> b = random_vector(A.size()), x = solve(A, b);
            Dense L = to_dense(A);
            REQUIRE(dense_cholesky(L) == -1);
            CHECK(max_difference(x, dense_solve(L, b)) < 1e-11);
            CHECK(scaled_residual(A, x, b) < 2e-16 * std::sqrt(A.size()) + 4e-16);
        }
}

TEST_CASE("large fronts: blocked kernels give small residuals too") {
    const BlockCsr dense = random_spd(150, 3, complete(150));     // one front of 450 columns
    const BlockCsr cube = random_spd(15 * 15 * 15, 3, grid_3d(15), 1e-3);
    for (const BlockCsr* A : {&dense, &cube}) {
        const std::vector<double> b = random_vector(A->size());
        CHECK(scaled_residual(*A, solve(*A, b), b) < 1e-15);
    }
}

TEST_CASE("an ill-conditioned matrix is still solved backward stably") {
    const BlockCsr A = random_spd(900, 2, grid(30, 30), 1e-9);
    const std::vector<double> b = random_vector(A.size());
    CHECK(scaled_residual(A, solve(A, b), b) < 1e-15);
}

TEST_CASE("one analysis serves many matrices, b and x may be the same array") {
    const Edges edges = grid(20, 20);
    const BlockCsr A = random_spd(400, 2, edges, 0.1, 1), B = random_spd(400, 2, edges, 5.0, 2);
    Cholesky cholesky(A);
    for (const BlockCsr* M : {&A, &B, &A}) {
        REQUIRE(cholesky.factor(*M).status == SolveStatus::success);
        const std::vector<double> b = random_vector(M->size());
        std::vector<double> x = b;
        cholesky.solve(x.data(), x.data());
        CHECK(scaled_residual(*M, x, b) < 1e-15);
    }
}

TEST_CASE("of two mirrored blocks only one is read, so rounding asymmetry of a summed Hessian does not matter") {
    const BlockCsr A = random_spd(100, 2, grid(10, 10));
    const std::vector<double> b = random_vector(A.size()), expected = solve(A, b);
    Cholesky cholesky(A);
    int read = 0;
    for (const auto& [i, j] : {std::pair{34, 35}, std::pair{35, 34}}) {
        BlockCsr B = A;
        std::fill_n(B.block(B.find(i, j)), 4, std::numeric_limits<double>::quiet_NaN());
        if (cholesky.factor(B).status != SolveStatus::success) {
            ++read;
            continue;
        }
        std::vector<double> x(A.size());
        cholesky.solve(b.data(), x.data());
        CHECK(x == expected);
    }
    CHECK(read == 1);
}

TEST_CASE("not positive definite: the node is named, later matrices are not affected") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(400, d, grid(20, 20));
        Cholesky cholesky(A);
        BlockCsr B = A;
        B.block(B.find(123, 123))[0] = -1;
        FactorResult result = cholesky.factor(B);
        CHECK(result.status == SolveStatus::not_positive_definite);
        CHECK(result.bad_row == 123);
        B = A;
        B.block(B.find(200, 200))[d * d - 1] = std::numeric_limits<double>::quiet_NaN();
        CHECK(cholesky.factor(B).bad_row == 200);
        B.block(B.find(200, 200))[d * d - 1] = std::numeric_limits<double>::infinity();
        CHECK(cholesky.factor(B).bad_row == 200);
        std::fill(B.value.begin(), B.value.end(), 0.0);
        CHECK(cholesky.factor(B).status == SolveStatus::not_positive_definite);
        CHECK(cholesky.factor(A).status == SolveStatus::success);
    }
}

TEST_CASE("indefinite and singular matrices are recognised wherever a dense factorisation does") {
    for (unsigned seed = 0; seed < 20; ++seed) {
        BlockCsr A = random_spd(100, 2, random_edges(100, 250, seed), 0.1, seed);
        const double shift = 0.3 * seed;  // from definite to indefinite
        for (int i = 0; i < A.n; ++i)
            for (int r = 0; r < 2; ++r) A.block(A.find(i, i))[r * 3] -= shift;
        Dense L = to_dense(A);
        const bool definite = dense_cholesky(L) == -1;
        CHECK((Cholesky(A).factor(A).status == SolveStatus::success) == definite);
    }
    BlockCsr laplacian = random_spd(400, 1, grid(20, 20));  // rows sum to zero: singular
    for (int i = 0; i < 400; ++i)
        for (int k = laplacian.row[i]; k < laplacian.row[i + 1]; ++k)
            laplacian.value[k] = laplacian.col[k] == i ? laplacian.row[i + 1] - laplacian.row[i] - 1 : -1;
    CHECK(Cholesky(laplacian).factor(laplacian).status == SolveStatus::not_positive_definite);
}

TEST_CASE("the factor and the bad node are the same for any number of threads") {
    const BlockCsr A = random_spd(10000, 2, grid(100, 100));
    BlockCsr bad = A;
    for (int node : {17, 4000, 5000, 9999}) bad.block(bad.find(node, node))[0] = -1;
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> first(A.size()), x(A.size());
    const int before = max_threads();
    set_threads(1);
    const int bad_node = Cholesky(bad).factor(bad).bad_row;
    first = solve(A, b);
    Cholesky cholesky(A);
    for (int threads : {2, 3, 8}) {
        set_threads(threads);
        REQUIRE(cholesky.factor(A).status == SolveStatus::success);  // memory grows with the threads
        cholesky.solve(b.data(), x.data());
        CHECK(x == first);
        CHECK(solve(A, b) == first);
        CHECK(cholesky.factor(bad).bad_row == bad_node);
    }
    set_threads(before);
}

namespace {

// Ten cliques of 220 nodes: fronts without children, each a tenth of all work. linked: all next to one more node.
BlockCsr cliques(bool linked) {
    Edges edges;
    for (int clique = 0; clique < 10; ++clique)
        for (const auto& [i, j] : complete(220)) edges.push_back({220 * clique + i, 220 * clique + j});
    for (int i = 0; linked && i < 2200; ++i) edges.push_back({i, 2200});
    return random_spd(linked ? 2201 : 2200, 1, edges);
}

}  // namespace

TEST_CASE("large fronts without children are factored, too") {
    for (const bool linked : {false, true}) {
        const BlockCsr A = cliques(linked);
        const std::vector<double> b = random_vector(A.size());
        const int before = max_threads();
        for (int threads : {1, 2, 3}) {
            set_threads(threads);
            CHECK(scaled_residual(A, solve(A, b), b) < 1e-14);
        }
        set_threads(before);
    }
}

TEST_CASE("a bad pivot is named wherever in the tree it is, and leaves nothing behind") {
    const BlockCsr A = random_spd(10000, 2, grid(100, 100));
    const Graph graph = graph_of(A);
    const FactorPlan plan = plan_factorisation(A, graph, order_vertices(graph, Ordering::nested_dissection));
    REQUIRE(!plan.single.empty());
    REQUIRE(!plan.top.empty());
    const std::vector<double> b = random_vector(A.size());
    const std::vector<double> expected = solve(A, b);
    std::vector<double> x(A.size());
    Cholesky cholesky(A);
    const int before = max_threads();
    for (int f : {plan.subtrees.front().begin, plan.subtrees.back().end - 1, plan.single.front(), plan.single.back(),
                  plan.top.front(), plan.top.back()})
        for (int threads : {1, 2, 3, 8}) {
            set_threads(threads);
            BlockCsr bad = A;
            const int node = plan.tree.order[plan.tree.first[f]];
            bad.block(bad.find(node, node))[0] = -1;
            CHECK(cholesky.factor(bad).bad_row == node);
            REQUIRE(cholesky.factor(A).status == SolveStatus::success);
            cholesky.solve(b.data(), x.data());
            CHECK(x == expected);
        }
    set_threads(before);
}

TEST_CASE("a factorisation that does not fit the memory is refused") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20));
    Cholesky small(A, {1000.0});
    CHECK_FALSE(small.fits());
    CHECK(small.factor(A).status == SolveStatus::too_large);
    Cholesky large(A);
    CHECK(large.fits());
    CHECK(large.predicted_bytes() > 8 * large.factor_entries());
    CHECK(large.predicted_bytes() < 80 * large.factor_entries());
}

TEST_CASE("an empty matrix") {
    const BlockCsr A = matrix_of_cells(0, 2, {}, 2);
    Cholesky cholesky(A);
    CHECK(cholesky.factor(A).status == SolveStatus::success);
    cholesky.solve(nullptr, nullptr);
    CHECK(cholesky.factor_entries() == 0);
}

TEST_CASE("a pivot of which rounding leaves less than two digits is none") {
    for (const double left : {1e-12, 2e-14, 5e-15, 1e-15}) {
        BlockCsr A = random_spd(2, 1, path(2));
        A.value = {1, 1, 1, 1 + left};
        const SolveStatus status = Cholesky(A).factor(A).status;
        CHECK((status == SolveStatus::success) == (left > 1e-14));
    }
}
