#include "linalg/krylov/krylov.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "base/parallel.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "support/identity.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

BlockCsr diagonal(const std::vector<double>& entries) {
    BlockCsr A = matrix_of_cells(static_cast<int>(entries.size()), 1, {}, 2);
    A.value.assign(entries.begin(), entries.end());
    return A;
}

// The cyclic shift x_{i+1}: GMRES makes no progress on e_0 before iteration n (Saad, section 6.5.5).
BlockCsr cyclic_shift(int n) {
    Edges edges = path(n);
    edges.push_back({0, n - 1});
    BlockCsr A = random_spd(n, 1, edges);
    std::fill(A.value.begin(), A.value.end(), 0.0);
    for (int i = 0; i < n; ++i) A.block(A.find((i + 1) % n, i))[0] = 1;
    return A;
}

}  // namespace

TEST_CASE("GMRES solves with and without preconditioner, and reports the true residual") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(400, d, grid(20, 20));
        const std::vector<double> b = random_vector(A.size());
        std::vector<double> x(A.size());
        const auto made_ilu = make_ilu0(A);
        Preconditioner& ilu = *made_ilu;
        REQUIRE(ilu.factor(A).status == SolveStatus::success);
        Gmres gmres(A.size(), {1000, 1e-10, 30});
        int iterations[2];
        Identity none(A.size());
        for (Preconditioner* M : {static_cast<Preconditioner*>(&none), static_cast<Preconditioner*>(&ilu)}) {
            const KrylovResult result = gmres.solve(A, *M, b.data(), x.data());
            CHECK(result.status == SolveStatus::success);
            CHECK(result.relative_residual <= 1e-10);
            CHECK(result.relative_residual == doctest::Approx(relative_residual(A, x, b)).epsilon(1e-4));
            iterations[M == &ilu] = result.iterations;
        }
        CHECK(iterations[1] < iterations[0]);
    }
}

TEST_CASE("as many iterations as there are different eigenvalues") {
    std::vector<double> entries(50);
    for (int i = 0; i < 50; ++i) entries[i] = 1 + i % 3;
    const BlockCsr A = diagonal(entries);
    const std::vector<double> b = random_vector(50);
    std::vector<double> x(50);
    const KrylovResult result = plain(Gmres(50, {100, 1e-12, 20}), A, b, x);
    CHECK(result.status == SolveStatus::success);
    CHECK(result.iterations == 3);
    for (int i = 0; i < 50; ++i) CHECK(x[i] == doctest::Approx(b[i] / entries[i]));
}

TEST_CASE("an exact preconditioner: the Krylov space ends with the solution in it") {
    const BlockCsr A = random_spd(60, 2, path(60));
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    ilu.factor(A);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x(A.size());
    const KrylovResult result = Gmres(A.size(), {100, 1e-12, 20}).solve(A, ilu, b.data(), x.data());
    CHECK(result.status == SolveStatus::success);
    CHECK(result.iterations <= 2);
}

TEST_CASE("stagnation: a full cycle without progress ends the solve, and so do twenty iterations of one") {
    const BlockCsr A = cyclic_shift(15);
    std::vector<double> b(15, 0.0), x(15);
    b[0] = 1;
    const KrylovResult result = plain(Gmres(15, {1000, 1e-8, 10}), A, b, x);
    CHECK(result.status == SolveStatus::stagnated);
    CHECK(result.iterations == 10);
    CHECK(result.relative_residual == doctest::Approx(1));
    // Without restart it takes n iterations.
    const KrylovResult whole = plain(Gmres(15, {1000, 1e-8, 15}), A, b, x);
    CHECK(whole.status == SolveStatus::success);
    CHECK(whole.iterations == 15);

    const BlockCsr longer = cyclic_shift(100);
    b.resize(100, 0.0), x.resize(100);
    const KrylovResult early = plain(Gmres(100, {1000, 1e-8, 100}), longer, b, x);
    CHECK(early.status == SolveStatus::stagnated);
    CHECK(early.iterations == 20);
}

TEST_CASE("a tolerance below rounding is stagnation, not an endless loop") {
    const BlockCsr A = random_spd(400, 1, grid(20, 20));
    const std::vector<double> b = random_vector(400);
    std::vector<double> x(400);
    const KrylovResult result = plain(Gmres(400, {100000, 1e-30, 50}), A, b, x);
    CHECK(result.status == SolveStatus::stagnated);
    CHECK(result.relative_residual < 1e-13);
    CHECK(result.iterations < 1000);
}

TEST_CASE("max_iterations: the limit holds inside a cycle, and x is the iterate it was reached with") {
    const BlockCsr A = random_spd(900, 1, grid(30, 30), 1e-3);
    const std::vector<double> b = random_vector(900);
    std::vector<double> x(900);
    for (int limit : {0, 1, 7}) {
        const KrylovResult result = plain(Gmres(900, {limit, 1e-10, 5}), A, b, x);
        CHECK(result.status == SolveStatus::max_iterations);
        CHECK(result.iterations == limit);
        CHECK(result.relative_residual == doctest::Approx(relative_residual(A, x, b)));
    }
}

TEST_CASE("breakdown: a singular matrix with an unreachable right-hand side, and numbers that are not finite") {
    BlockCsr A = diagonal({1, 1, 0});
    std::vector<double> b{1, 1, 1}, x(3);
    Gmres gmres(3, {100, 1e-8, 3});
    KrylovResult result = plain(gmres, A, b, x);
    CHECK(result.status == SolveStatus::breakdown);
    CHECK(result.relative_residual == doctest::Approx(1 / std::sqrt(3.0)));  // the best that can be done
    A.value[1] = std::numeric_limits<double>::quiet_NaN();
    result = plain(gmres, A, b, x);
    CHECK(result.status == SolveStatus::breakdown);
    CHECK(x == std::vector<double>{0, 0, 0});
    b[0] = std::numeric_limits<double>::infinity();
    CHECK(plain(gmres, diagonal({1, 1, 1}), b, x).status == SolveStatus::breakdown);
}

TEST_CASE("zero right-hand side, zero matrix, 1 x 1 and empty systems") {
    std::vector<double> b{0, 0}, x{5, 5};
    Gmres gmres(2, {});
    CHECK(plain(gmres, diagonal({1, 2}), b, x).status == SolveStatus::success);
    CHECK(x == b);
    b = {1, 0};
    CHECK(plain(gmres, diagonal({0, 0}), b, x).status == SolveStatus::breakdown);
    CHECK(plain(Gmres(1, {}), diagonal({4}), b, x).status == SolveStatus::success);
    CHECK(x[0] == 0.25);
    CHECK(plain(Gmres(0, {}), diagonal({}), b, x).status == SolveStatus::success);
}

TEST_CASE("GMRES gives the same bits for any number of threads") {
    const BlockCsr A = random_spd(10000, 2, grid(100, 100), 1e-2);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> first(A.size()), x(A.size());
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    ilu.factor(A);
    Gmres gmres(A.size(), {30, 1e-12, 20});
    const int before = max_threads();
    set_threads(1);
    gmres.solve(A, ilu, b.data(), first.data());
    for (int threads : {2, 3, 5}) {
        set_threads(threads);
        gmres.solve(A, ilu, b.data(), x.data());
        CHECK(x == first);
    }
    set_threads(before);
}
