#include "linalg/krylov/krylov.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/parallel.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/krylov/deflated.hpp"
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

// The Laplacian of a path, with `excess` on the diagonal.
BlockCsr laplacian(int n, double excess) {
    BlockCsr A = random_spd(n, 1, path(n));
    for (int i = 0; i < n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) A.value[k] = A.col[k] == i ? 2 + excess : -1;
    return A;
}

class Jacobi : public Preconditioner {
public:
    explicit Jacobi(const BlockCsr& A) {
        for (int i = 0; i < A.n; ++i) diagonal_.push_back(A.value[A.find(i, i)]);
    }
    FactorResult factor(const BlockCsr&) override { return {SolveStatus::success}; }
    double apply(const double* r, double* z) override {
        double rz = 0;
        for (std::size_t i = 0; i < diagonal_.size(); ++i) rz += r[i] * (z[i] = r[i] / diagonal_[i]);
        return rz;
    }
    double squared_norm(const std::vector<double>& r) {
        std::vector<double> z(r.size());
        return apply(r.data(), z.data());
    }

private:
    std::vector<double> diagonal_;
};

}  // namespace

TEST_CASE("conjugate gradients find the solution of a dense Cholesky, to what the condition number leaves of it") {
    for (int d = 1; d <= 3; ++d) {
        constexpr double tolerance = 1e-11, smallest_eigenvalue = 0.1;  // of random_spd, by Gershgorin
        const BlockCsr A = random_spd(100, d, grid(10, 10), smallest_eigenvalue);
        const std::vector<double> b = random_vector(A.size());
        Dense L = to_dense(A);
        REQUIRE(dense_cholesky(L) == -1);
        const std::vector<double> expected = dense_solve(L, b);
        double length = 0;
        for (double v : expected) length += v * v;
        std::vector<double> x(A.size());
        const auto made_ilu = make_ilu0(A);
        Preconditioner& ilu = *made_ilu;
        REQUIRE(ilu.factor(A).status == SolveStatus::success);
        int iterations[2];
        Identity none(A.size());
        for (Preconditioner* M : {static_cast<Preconditioner*>(&none), static_cast<Preconditioner*>(&ilu)}) {
            ConjugateGradients cg(A.size(), {1000, tolerance});
            const KrylovResult result = cg.solve(A, *M, b.data(), x.data());
            CHECK(result.status == SolveStatus::success);
            CHECK(result.relative_residual <= tolerance);
            CHECK(result.relative_residual == doctest::Approx(relative_residual(A, x, b)).epsilon(1e-3));
            CHECK(max_difference(x, expected) <= norm_inf(A) / smallest_eigenvalue * tolerance * std::sqrt(length));
            iterations[M == &ilu] = result.iterations;
        }
        CHECK(iterations[1] < iterations[0]);
    }
}

TEST_CASE("as many iterations as there are different eigenvalues") {
    for (int different : {1, 2, 3, 5, 10}) {
        std::vector<double> entries(60);
        for (int i = 0; i < 60; ++i) entries[i] = 1 + i % different;
        const BlockCsr A = diagonal(entries);
        const std::vector<double> b = random_vector(60);
        std::vector<double> x(60);
        const KrylovResult result = plain(ConjugateGradients(60, {100, 1e-12}), A, b, x);
        CHECK(result.status == SolveStatus::success);
        CHECK(result.iterations == different);
        for (int i = 0; i < 60; ++i) CHECK(x[i] == doctest::Approx(b[i] / entries[i]));
    }
}

TEST_CASE("an exact preconditioner: one or two iterations") {
    const BlockCsr A = random_spd(60, 2, path(60));
    const auto made_ilu = make_ilu0(A);
    Preconditioner& ilu = *made_ilu;
    ilu.factor(A);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x(A.size());
    const KrylovResult result = ConjugateGradients(A.size(), {100, 1e-12}).solve(A, ilu, b.data(), x.data());
    CHECK(result.status == SolveStatus::success);
    CHECK(result.iterations <= 2);
}

TEST_CASE("negative and zero curvature are reported in the iteration that meets them") {
    std::vector<double> x(3);
    ConjugateGradients cg(3, {100, 1e-10});
    const auto solve = [&](const std::vector<double>& entries, const std::vector<double>& b) {
        return plain(cg, diagonal(entries), b, x);
    };
    const KrylovResult first = solve({1, 1, -3}, {1, 1, 1});
    CHECK(first.status == SolveStatus::not_positive_definite);
    CHECK(first.iterations == 1);
    CHECK(first.relative_residual == 1);
    CHECK(x == std::vector<double>{0, 0, 0});
    CHECK(solve({1, 1, -2}, {1, 1, 1}).iterations == 1);  // p'Ap = 0
    const KrylovResult later = solve({1, 2, -0.1}, {1, 1, 1});
    CHECK(later.status == SolveStatus::not_positive_definite);
    CHECK(later.iterations > 1);
    CHECK(x[0] + x[1] + x[2] > 0);  // b'x: what there is of x is a direction of descent
    CHECK(solve({0, 0, 0}, {1, 0, 0}).status == SolveStatus::not_positive_definite);
}

// A z is made wrong by more than the curvature of A, which then decides itself.
TEST_CASE("where the recurrence sees negative curvature, the product with A decides") {
    struct Careless final : Preconditioner {
        int good = 0;  // products before the wrong one
        FactorResult factor(const BlockCsr&) override { return {SolveStatus::success}; }
        double apply(const double* r, double* z) override {
            double rz = 0;
            for (int i = 0; i < 2; ++i) z[i] = r[i], rz += r[i] * z[i];
            return rz;
        }
        double apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az) override {
            const double rz = Preconditioner::apply_and_multiply(A, r, z, Az);
            for (int i = 0; i < 2 && good == 0; ++i) Az[i] -= 2 * z[i];
            --good;
            return rz;
        }
    };
    const BlockCsr A = diagonal({1, 1e-3});
    for (const int good : {0, 1}) {
        Careless careless;
        careless.good = good;
        const std::vector<double> b = {1, 1};
        std::vector<double> x(2);
        ConjugateGradients cg(2, {10, 1e-6});
        const KrylovResult result = cg.solve(A, careless, b.data(), x.data());
        CHECK(result.status == SolveStatus::success);
        CHECK(result.iterations == 2);
        CHECK(relative_residual(A, x, b) < 1e-6);
    }
}

TEST_CASE("put-off products: as many iterations as with products at once, and the same solution") {
    struct AtOnce final : Preconditioner {
        std::unique_ptr<Preconditioner> M;
        FactorResult factor(const BlockCsr& A) override { return M->factor(A); }
        double apply(const double* r, double* z) override { return M->apply(r, z); }
        double correct_start(const double* r, double* x) override { return M->correct_start(r, x); }
    } at_once;
    BlockCsr A = random_spd(8000, 3, grid_3d(20));  // turned into the Laplacian of the grid for each of three entries
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int e = 0; e < 9; ++e) A.block(k)[e] = e % 4 != 0 ? 0 : A.col[k] != i ? -1 : A.row[i + 1] - A.row[i];
    const std::vector<int> one_domain = {0, A.n};
    const auto ssor = [&] { return make_ilu0(A, one_domain, {0}, Sweeps::ssor); };
    at_once.M = ssor();
    Deflated deflated(ssor(), std::make_unique<CoarseSpace>(A, true));
    const std::vector<double> b = random_vector(A.size());
    for (const double tolerance : {1e-4, 1e-10}) {
        const auto solved_by = [&](Preconditioner& M, std::vector<double>& x) {
            REQUIRE(M.factor(A).status == SolveStatus::success);
            const KrylovResult result = ConjugateGradients(A.size(), {600, tolerance}).solve(A, M, b.data(), x.data());
            REQUIRE(result.status == SolveStatus::success);
            CHECK(relative_residual(A, x, b) <= tolerance);
            return result.iterations;
        };
        std::vector<double> x(A.size()), y(A.size()), z(A.size());
        const auto direct = ssor();
        const int iterations = solved_by(at_once, x);
        CHECK(iterations >= 5);
        // Below single precision, to which the parts of A are stored, a second cycle begins with the true residual.
        CHECK(solved_by(*direct, y) <= (tolerance < 1e-7 ? 2 * iterations : iterations));
        CHECK(max_difference(x, y) < 100 * tolerance * norm_inf(x));
        CHECK(solved_by(deflated, z) <= 2 * iterations);
    }
}

TEST_CASE("where put-off sums see negative curvature, the product with A decides") {
    struct Careless final : Preconditioner {
        std::vector<double> z_before;
        FactorResult factor(const BlockCsr&) override { return {SolveStatus::success}; }
        double apply(const double* r, double* z) override { return apply_and_put_off(r, z, nullptr).rz; }
        bool puts_off_products() const override { return true; }
        Products apply_and_put_off(const double* r, double* z, double*) override {
            z_before.assign(r, r + 2);
            std::copy_n(r, 2, z);
            const double rr = r[0] * r[0] + r[1] * r[1];
            return {rr, rr, r[0] * r[0] + 1e-3 * r[1] * r[1] - 0.01 * rr};
        }
        Products advance(double alpha, double beta, double* q, double* r, double* z, double* Az) override {
            for (int i = 0; i < 2; ++i) r[i] -= alpha * (q[i] = (i == 0 ? 1 : 1e-3) * z_before[i] + beta * q[i]);
            return apply_and_put_off(r, z, Az);
        }
    } careless;
    const BlockCsr A = diagonal({1, 1e-3});
    const std::vector<double> b = {1e-9, 1};
    std::vector<double> x(2);
    CHECK(ConjugateGradients(2, {10, 1e-6}).solve(A, careless, b.data(), x.data()).status == SolveStatus::success);
    CHECK(relative_residual(A, x, b) < 1e-6);
}

TEST_CASE("flexible: a preconditioner that changes from one iteration to the next costs few iterations") {
    struct Changing final : Preconditioner {
        int size, applied = 0;
        bool changes;
        Changing(int n, bool does) : size(n), changes(does) {}
        FactorResult factor(const BlockCsr&) override { return {SolveStatus::success}; }
        double apply(const double* r, double* z) override {
            ++applied;
            double rz = 0;
            for (int i = 0; i < size; ++i) {
                const bool odd = changes && (i + applied) % 2;
                z[i] = odd ? 1.5 * r[i] : r[i];
                rz += r[i] * z[i];
            }
            return rz;
        }
    };
    const BlockCsr A = laplacian(900, 1e-2);
    const std::vector<double> b = random_vector(900);
    std::vector<double> x(900);
    const auto iterations = [&](bool changes) {
        Changing M(900, changes);
        const KrylovResult result = ConjugateGradients(900, {2000, 1e-8}).solve(A, M, b.data(), x.data());
        CHECK(result.status == SolveStatus::success);
        CHECK(relative_residual(A, x, b) <= 1e-8);
        return result.iterations;
    };
    const int fixed = iterations(false), changing = iterations(true);
    CAPTURE(fixed);
    CHECK(changing <= 1.5 * fixed);
}

TEST_CASE("stagnation is noticed within a few windows of twenty iterations") {
    // The residual of the Laplacian of a path with b = e_0 travels along the path, one entry an iteration.
    const BlockCsr A = laplacian(4000, 0);
    std::vector<double> b(4000, 0.0), x(4000);
    b[0] = 1;
    const KrylovResult result = plain(ConjugateGradients(A.size(), {1000, 1e-8}), A, b, x);
    CHECK(result.status == SolveStatus::stagnated);
    CHECK(result.iterations <= 100);
    CHECK(result.relative_residual < 1);
    CHECK(result.relative_residual == doctest::Approx(relative_residual(A, x, b)));
}

TEST_CASE("a tolerance below rounding is stagnation, not an endless loop") {
    const BlockCsr A = random_spd(400, 1, grid(20, 20));
    const std::vector<double> b = random_vector(400);
    std::vector<double> x(400);
    const KrylovResult result = plain(ConjugateGradients(A.size(), {100000, 1e-30}), A, b, x);
    CHECK(result.status != SolveStatus::success);
    CHECK(result.relative_residual < 1e-13);
    CHECK(result.iterations < 2000);
}

TEST_CASE("max_iterations: x is the iterate it was reached with") {
    const BlockCsr A = laplacian(900, 1e-3);
    const std::vector<double> b = random_vector(900);
    std::vector<double> x(900);
    for (int limit : {0, 1, 7}) {
        const KrylovResult result = plain(ConjugateGradients(A.size(), {limit, 1e-10}), A, b, x);
        CHECK(result.status == SolveStatus::max_iterations);
        CHECK(result.iterations == limit);
        CHECK(result.relative_residual == doctest::Approx(relative_residual(A, x, b)));
    }
}

TEST_CASE("the tolerance can be changed between solves") {
    const BlockCsr A = laplacian(100, 1);
    const std::vector<double> b = random_vector(100);
    std::vector<double> x(100);
    ConjugateGradients cg(100, {});
    const int exact = plain(cg, A, b, x).iterations;
    cg.set_tolerance(1e-2);
    CHECK(plain(cg, A, b, x).iterations < exact);
}

TEST_CASE("breakdown: numbers that are not finite") {
    std::vector<double> b{1, 1, 1}, x(3);
    ConjugateGradients cg(3, {});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(plain(cg, diagonal({1, nan, 1}), b, x).status == SolveStatus::breakdown);
    CHECK(x == std::vector<double>{0, 0, 0});
    b[0] = std::numeric_limits<double>::infinity();
    CHECK(plain(cg, diagonal({1, 1, 1}), b, x).status == SolveStatus::breakdown);
    CHECK(x == std::vector<double>{0, 0, 0});
}

TEST_CASE("zero right-hand side, 1 x 1 and empty systems") {
    std::vector<double> b{0, 0}, x{5, 5};
    CHECK(plain(ConjugateGradients(2, {}), diagonal({1, 2}), b, x).status == SolveStatus::success);
    CHECK(x == b);
    b = {1};
    CHECK(plain(ConjugateGradients(1, {}), diagonal({4}), b, x).status == SolveStatus::success);
    CHECK(x[0] == 0.25);
    CHECK(plain(ConjugateGradients(0, {}), diagonal({}), b, x).status == SolveStatus::success);
}

TEST_CASE("conjugate gradients give the same bits for any number of threads") {
    const BlockCsr grid = random_spd(8000, 3, grid_3d(20), 1e-2);
    const BlockCsr A = reordered(grid, cut_into_domains(graph_of(grid)));
    const std::vector<double> b = random_vector(A.size());
    const int before = max_threads();
    set_threads(1);
    Deflated M(make_ilu0(A, A.order->start), std::make_unique<CoarseSpace>(A));
    REQUIRE(M.factor(A).status == SolveStatus::success);
    ConjugateGradients cg(A.size(), {});
    std::vector<double> first(A.size()), x(A.size());
    CHECK(cg.solve(A, M, b.data(), first.data()).status == SolveStatus::success);
    for (int threads : {2, 3, 8}) {
        set_threads(threads);
        M.factor(A);
        cg.solve(A, M, b.data(), x.data());
        CHECK(x == first);
    }
    set_threads(before);
}

// As in Newton's systems with a large penalty: nearly all of the right-hand side is at what is stiff.
TEST_CASE("the residual falls in the norm of the inverse preconditioner too, which sees errors of low energy") {
    constexpr double tolerance = 1e-6, stiff = 1e10;
    constexpr int n = 200;
    BlockCsr A = laplacian(n, 0.01);
    A.value[A.find(0, 0)] = stiff;
    std::vector<double> b(n, 1.0), x(n), r(n);
    b[0] = stiff;
    Jacobi M(A);
    const KrylovResult result = ConjugateGradients(n, {1000, tolerance}).solve(A, M, b.data(), x.data());
    CHECK(result.status == SolveStatus::success);
    multiply(A, x.data(), r.data());
    for (int i = 0; i < n; ++i) r[i] -= b[i];
    CHECK(std::sqrt(M.squared_norm(r)) <= 1.01 * tolerance * std::sqrt(M.squared_norm(b)));
}
