#include "linalg/krylov/ilu0.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "base/parallel.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/vector_ops.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

constexpr double single = 1e-5;  // L is kept in single precision

std::vector<double> solved(Preconditioner& ilu, const std::vector<double>& r) {
    std::vector<double> z(r.size());
    [[maybe_unused]] const int size = static_cast<int>(r.size());
#pragma omp parallel if (size >= parallel_work)
    ilu.apply(r.data(), z.data());
    return z;
}

// A 3D grid numbered domain by domain, and where its domains start: one domain for m <= 15.
struct CutGrid {
    BlockCsr A;
    std::vector<int> start;

    explicit CutGrid(int m, int d, double excess = 1.0) : A(random_spd(m * m * m, d, grid_3d(m), excess)) {
        A = reordered(A, cut_into_domains(graph_of(A)));
        start = A.order->start;
    }
};

}  // namespace

TEST_CASE("ILU(0) of a block tridiagonal and of a dense matrix is exact: one solve gives the solution") {
    for (int d = 1; d <= 3; ++d)
        for (const Edges& edges : {path(40), complete(40)}) {
            const BlockCsr A = random_spd(40, d, edges);
            const std::vector<double> x = random_vector(A.size());
            std::vector<double> y(A.size());
            multiply(A, x.data(), y.data());
            const auto made_ilu = make_ilu0(A);
            Preconditioner& ilu = *made_ilu;
            CHECK(ilu.factor(A).status == SolveStatus::success);
            CHECK(max_difference(x, solved(ilu, y)) < single);
            ilu.apply(y.data(), y.data());
            CHECK(max_difference(x, y) < single);
        }
}

TEST_CASE("a block diagonal matrix is inverted to the last digits: C is kept in double precision") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(50, d, {});
        const std::vector<double> x = random_vector(A.size());
        std::vector<double> y(A.size());
        multiply(A, x.data(), y.data());
        const auto made_ilu = make_ilu0(A);
        Preconditioner& ilu = *made_ilu;
        REQUIRE(ilu.factor(A).status == SolveStatus::success);
        CHECK(max_difference(x, solved(ilu, y)) < 1e-13);
    }
}

TEST_CASE("on its pattern, the product of the factors is the matrix") {
    const BlockCsr A = random_spd(25, 2, grid(5, 5), 2.0);
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    REQUIRE(ilu.factor(A).status == SolveStatus::success);
    const int n = A.size();
    Dense inverse{n, std::vector<double>(static_cast<std::size_t>(n) * n, 0.0)};
    for (int j = 0; j < n; ++j) {
        std::vector<double> e(n, 0.0);
        e[j] = 1;
        const std::vector<double> column = solved(ilu, e);
        for (int i = 0; i < n; ++i) inverse(i, j) = column[i];
    }
    // The product itself, by Gauss-Jordan on its inverse.
    Dense M{n, std::vector<double>(static_cast<std::size_t>(n) * n, 0.0)};
    for (int i = 0; i < n; ++i) M(i, i) = 1;
    for (int k = 0; k < n; ++k) {
        const double pivot = inverse(k, k);
        for (int j = 0; j < n; ++j) inverse(k, j) /= pivot, M(k, j) /= pivot;
        for (int i = 0; i < n; ++i) {
            const double factor = inverse(i, k);
            for (int j = 0; j < n && i != k; ++j) inverse(i, j) -= factor * inverse(k, j), M(i, j) -= factor * M(k, j);
        }
    }
    const Dense expected = to_dense(A);
    double on_pattern = 0, elsewhere = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            double& worst = A.find(i / 2, j / 2) >= 0 ? on_pattern : elsewhere;
            worst = std::max(worst, std::abs(M(i, j) - expected(i, j)));
        }
    CHECK(on_pattern < single);
    CHECK(elsewhere > 1e-3);
}

TEST_CASE("the preconditioner is symmetric and positive definite, in several domains too") {
    for (int m : {6, 18}) {
        const CutGrid grid(m, 2, 1e-2);
        const BlockCsr& A = grid.A;
        const auto made_ilu = make_ilu0(A, grid.start);
        Preconditioner& ilu = *made_ilu;
        CHECK(grid.start.size() == (m == 6 ? 2 : 9));
        REQUIRE(ilu.factor(A).status == SolveStatus::success);
        const std::vector<double> u = random_vector(A.size(), 1), v = random_vector(A.size(), 2);
        const std::vector<double> Mu = solved(ilu, u), Mv = solved(ilu, v);
        CHECK(dot(u, Mv) == doctest::Approx(dot(v, Mu)).epsilon(1e-12));
        CHECK(dot(u, Mu) > 0);
    }
}

TEST_CASE("domains and separators are swept as the same rows in one piece are") {
    for (int d = 1; d <= 3; ++d) {
        const CutGrid grid(17, d, 1e-2);
        REQUIRE(grid.start.size() == 9);
        const auto made = make_ilu0(grid.A, grid.start), made_whole = make_ilu0(grid.A);
        Preconditioner &parts = *made, &whole = *made_whole;
        REQUIRE(parts.factor(grid.A).status == SolveStatus::success);
        REQUIRE(whole.factor(grid.A).status == SolveStatus::success);
        const std::vector<double> r = random_vector(grid.A.size());
        CHECK(max_difference(solved(parts, r), solved(whole, r)) < 1e-13 * norm_inf(solved(whole, r)));
    }
}

TEST_CASE("ILU(0) returns r'z, to a single thread too") {
    for (int d = 1; d <= 3; ++d)
        for (int m : {6, 17}) {
            const CutGrid grid(m, d, 1e-2);
            const auto made_ilu = make_ilu0(grid.A, grid.start);
            Preconditioner& ilu = *made_ilu;
            REQUIRE(ilu.factor(grid.A).status == SolveStatus::success);
            const std::vector<double> r = random_vector(grid.A.size(), 1), expected = solved(ilu, r);
            std::vector<double> z(r.size());
            CHECK(ilu.apply(r.data(), z.data()) == doctest::Approx(dot(r, expected)).epsilon(1e-12));
            CHECK(z == expected);
        }
}

TEST_CASE("the units of the matrix do not matter, though L is in single precision") {
    BlockCsr A = random_spd(49, 3, grid(7, 7));
    const std::vector<double> r = random_vector(A.size());
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    REQUIRE(ilu.factor(A).status == SolveStatus::success);
    const std::vector<double> z = solved(ilu, r);
    for (int exponent : {-400, 400}) {
        BlockCsr B = A;
        for (double& v : B.value) v = std::ldexp(v, exponent);
        REQUIRE(ilu.factor(B).status == SolveStatus::success);
        std::vector<double> scaled = solved(ilu, r);
        for (double& v : scaled) v = std::ldexp(v, exponent);
        CHECK(scaled == z);
    }
}

TEST_CASE("factor() refills the pattern, and names the row of a pivot block that is not positive") {
    for (int m : {4, 17}) {  // one domain, and several
        const CutGrid grid(m, 2);
        const BlockCsr& A = grid.A;
        const auto made_ilu = make_ilu0(A, grid.start);
        Preconditioner& ilu = *made_ilu;
        CHECK(ilu.factor(A).status == SolveStatus::success);
        for (const double bad :
             {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
            for (int row : {4, A.n / 2, A.n - 1}) {
                BlockCsr B = A;
                B.block(B.find(row, row))[3] = bad;
                const FactorResult result = ilu.factor(B);
                CHECK(result.status == SolveStatus::indefinite_preconditioner);
                CHECK(result.bad_row == row);
            }
        CHECK(ilu.factor(A).bad_row == -1);
    }
}

TEST_CASE("a shift factors A with a heavier diagonal") {
    const BlockCsr A = random_spd(49, 2, grid(7, 7));
    BlockCsr heavier = A;
    for (int i = 0; i < A.n; ++i)
        for (int e = 0; e < 4; ++e) heavier.block(A.find(i, i))[e] *= 1.25;
    const std::vector<double> r = random_vector(A.size());
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    REQUIRE(ilu.factor(heavier).status == SolveStatus::success);
    const std::vector<double> z = solved(ilu, r);
    const auto made_shifted = make_ilu0(A, {0, A.n}, {0.25});
    Preconditioner& shifted = *made_shifted;
    const FactorResult result = shifted.factor(A);
    REQUIRE(result.status == SolveStatus::success);
    CHECK(result.diagonal_shift == 0.25);
    CHECK(solved(shifted, r) == z);
}

TEST_CASE("SSOR is (D + T) D^{-1} (D + T') with the blocks of the matrix, in several domains too") {
    for (int m : {6, 18}) {
        const CutGrid grid(m, 2, 1e-2);
        const BlockCsr& A = grid.A;
        const auto made_ssor = make_ilu0(A, grid.start, {0}, Sweeps::ssor);
        Preconditioner& ssor = *made_ssor;
        const FactorResult result = ssor.factor(A);
        REQUIRE(result.status == SolveStatus::success);
        CHECK(result.ssor);
        // (D + T) D^{-1} (D + T') z from any z, by two triangular products with D^{-1} between them.
        const std::vector<double> z = random_vector(A.size());
        std::vector<double> upper(A.size()), between(A.size()), r(A.size());
        for (int i = 0; i < A.n; ++i) {
            const double* const D = A.block(A.find(i, i));
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int a = 0; a < 2 && A.col[k] >= i; ++a)
                    for (int b = 0; b < 2; ++b) upper[2 * i + a] += A.block(k)[2 * a + b] * z[2 * A.col[k] + b];
            const double det = D[0] * D[3] - D[1] * D[2];
            between[2 * i] = (D[3] * upper[2 * i] - D[1] * upper[2 * i + 1]) / det;
            between[2 * i + 1] = (D[0] * upper[2 * i + 1] - D[2] * upper[2 * i]) / det;
        }
        for (int i = 0; i < A.n; ++i)
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int a = 0; a < 2 && A.col[k] <= i; ++a)
                    for (int b = 0; b < 2; ++b) r[2 * i + a] += A.block(k)[2 * a + b] * between[2 * A.col[k] + b];
        CHECK(max_difference(solved(ssor, r), z) < 1e-5 * norm_inf(z));  // L is in single precision
    }
}

TEST_CASE("apply_and_multiply: z as by apply(), and A z") {
    for (const Sweeps sweeps : {Sweeps::ssor, Sweeps::ilu0}) {
        const CutGrid grid(6, 3, 1e-2);
        const auto made_M = make_ilu0(grid.A, grid.start, {0}, sweeps);
        Preconditioner& M = *made_M;
        REQUIRE(M.factor(grid.A).status == SolveStatus::success);
        const std::vector<double> r = random_vector(grid.A.size());
        std::vector<double> z(r.size()), Az(r.size()), expected(r.size());
        const double rz = M.apply_and_multiply(grid.A, r.data(), z.data(), Az.data());
        CHECK(z == solved(M, r));
        CHECK(rz == doctest::Approx(dot(r, z)).epsilon(single));
        multiply(grid.A, z.data(), expected.data());
        CHECK(Az == expected);
    }
}

// SSOR has A z from its own parts, which are in single precision.
TEST_CASE("SSOR puts products off: z, z'A z, and in the next sweep A z, in several domains and in a team too") {
    for (int d = 1; d <= 3; ++d)
        for (int m : {6, 18}) {
            const CutGrid grid(m, d, 1e-2);
            const BlockCsr& A = grid.A;
            const auto made_M = make_ilu0(A, grid.start, {0}, Sweeps::ssor);
            Preconditioner& M = *made_M;
            CHECK(!M.puts_off_products());
            REQUIRE(M.factor(A).status == SolveStatus::success);
            REQUIRE(M.puts_off_products());
            const auto in_team = [m](const auto& body) {
                Products result;
#pragma omp parallel if (m > 6)
                {
                    const Products own = body();
#pragma omp single
                    result = own;
                }
                return result;
            };
            const std::vector<double> given = random_vector(A.size()), q_before = random_vector(A.size(), 2);
            std::vector<double> r = given, z(r.size()), Az(r.size(), 7.0), q = q_before, product(r.size());
            const auto check = [&](const Products& found) {
                CHECK(z == solved(M, r));
                CHECK(Az == std::vector<double>(r.size(), 0.0));
                multiply(A, z.data(), product.data());
                CHECK(found.rz == doctest::Approx(dot(r, z)).epsilon(single));
                CHECK(found.zAz == doctest::Approx(dot(z, product)).epsilon(single));
            };
            check(in_team([&] { return M.apply_and_put_off(r.data(), z.data(), Az.data()); }));
            Az[3] = 0.5;  // as if a coarse space had changed z
            std::vector<double> new_q = product, new_r = r;
            new_q[3] += 0.5;
            axpy(0.25, q_before, new_q);
            axpy(-0.1, new_q, new_r);
            const Products found =
                in_team([&] { return M.advance(0.1, 0.25, q.data(), r.data(), z.data(), Az.data()); });
            CHECK(max_difference(q, new_q) <= 1e-6 * norm_inf(new_q));
            CHECK(max_difference(r, new_r) <= 1e-6 * norm_inf(new_r));
            CHECK(found.rr == doctest::Approx(dot(r, r)));
            check(found);
        }
}

TEST_CASE("SSOR steps in where ILU(0) has no positive pivots, and needs positive definite diagonal blocks itself") {
    // Four nodes in a ring with springs of alternating sign: positive definite, but not without its fill.
    BlockCsr A = random_spd(4, 1, {{0, 1}, {1, 2}, {2, 3}, {3, 0}});
    for (int i = 0; i < 4; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            A.value[k] = A.col[k] == i ? 1.6 : A.col[k] + i == 3 && A.col[k] * i == 0 ? -1 : 1;
    REQUIRE(make_ilu0(A)->factor(A).status == SolveStatus::indefinite_preconditioner);
    const auto made_either = make_ilu0(A, {0, 4}, {0}, Sweeps::ilu0_or_ssor);
    Preconditioner& either = *made_either;
    const FactorResult result = either.factor(A);
    CHECK(result.status == SolveStatus::success);
    CHECK(result.ssor);
    A.value[A.find(2, 2)] = -1;
    CHECK(either.factor(A).status == SolveStatus::indefinite_preconditioner);
    CHECK(either.factor(A).bad_row == 2);
}

TEST_CASE("an empty matrix") {
    const BlockCsr A = matrix_of_cells(0, 2, {}, 2);
    CHECK(make_ilu0(A)->factor(A).status == SolveStatus::success);
}

TEST_CASE("ILU(0) gives the same bits for any number of threads") {
    const CutGrid grid(20, 3, 1e-2);
    const BlockCsr& A = grid.A;
    const std::vector<double> r = random_vector(A.size());
    const int before = max_threads();
    set_threads(1);
    const auto made_ilu = make_ilu0(A, grid.start);
    Preconditioner& ilu = *made_ilu;
    ilu.factor(A);
    const std::vector<double> first = solved(ilu, r);
    for (int threads : {2, 3, 8}) {
        set_threads(threads);
        const auto made_other = make_ilu0(A, grid.start);
        Preconditioner& other = *made_other;
        other.factor(A);
        CHECK(solved(other, r) == first);
    }
    set_threads(before);
}
