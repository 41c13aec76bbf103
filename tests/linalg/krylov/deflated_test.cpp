#include "linalg/krylov/deflated.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "linalg/krylov/krylov.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/vector_ops.hpp"
#include "support/identity.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

// The group of every node.
std::vector<int> groups_of(const CoarseSpace& coarse, int nodes) {
    std::vector<int> group;
    for (int i = 0; i < nodes; ++i) group.push_back(coarse.group(i));
    return group;
}

// Z' v and Z c for d entries per node.
std::vector<double> restricted(const std::vector<int>& group, int groups, int d, const std::vector<double>& v) {
    std::vector<double> sum(groups * d, 0.0);
    for (std::size_t i = 0; i < v.size(); ++i) sum[group[i / d] * d + i % d] += v[i];
    return sum;
}

std::vector<double> prolonged(const std::vector<int>& group, int d, const std::vector<double>& c) {
    std::vector<double> v;
    for (int g : group) v.insert(v.end(), c.begin() + g * d, c.begin() + (g + 1) * d);
    return v;
}

std::vector<double> product(const BlockCsr& A, const std::vector<double>& x) {
    std::vector<double> y(x.size());
    multiply(A, x.data(), y.data());
    return y;
}

// The Laplacian of a graph, the same for each of the d entries, with `excess` on the diagonal.
BlockCsr laplacian(int n, int d, const Edges& edges, double excess) {
    BlockCsr A = random_spd(n, d, edges);
    for (double& v : A.value) v = 0;
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int a = 0; a < d; ++a)
                A.block(k)[a * d + a] = A.col[k] == i ? A.row[i + 1] - A.row[i] - 1 + excess : -1;
    return A;
}

// Deflation without another preconditioner.
Deflated only_deflated(const BlockCsr& A) {
    Deflated M(std::make_unique<Identity>(A.size()), std::make_unique<CoarseSpace>(A));
    REQUIRE(M.factor(A).status == SolveStatus::success);
    return M;
}

}  // namespace

TEST_CASE("the groups are a few hundred neighbours each") {
    const BlockCsr A = random_spd(8000, 1, grid_3d(20));
    const CoarseSpace coarse(A);
    const std::vector<int> group = groups_of(coarse, A.n);
    std::vector<int> members(coarse.groups(), 0);
    for (int g : group) ++members[g];
    CHECK(coarse.groups() >= 20);
    CHECK(coarse.groups() <= 41);
    for (int count : members) CHECK((count > 0 && count <= 400));
    // Every group hangs together: spread the smallest number of a member from neighbour to neighbour.
    std::vector<int> smallest(A.n);
    for (int i = 0; i < A.n; ++i) smallest[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < A.n; ++i)
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                if (group[A.col[k]] == group[i] && smallest[A.col[k]] < smallest[i]) {
                    smallest[i] = smallest[A.col[k]];
                    changed = true;
                }
    }
    int pieces = 0;
    for (int i = 0; i < A.n; ++i) pieces += smallest[i] == i;
    CHECK(pieces == coarse.groups());
}

TEST_CASE("where A z is put off the correction is the same, and what it adds to A z and z'A z is told") {
    for (int d = 1; d <= 3; ++d)
        for (const bool in_single : {false, true}) {
            const BlockCsr A = random_spd(1331, d, grid_3d(11), 1e-2);
            CoarseSpace coarse(A, in_single);
            REQUIRE(coarse.factor(A).status == SolveStatus::success);
            const double error = in_single ? 1e-5 : 1e-10;
            const std::vector<double> r = random_vector(A.size(), 1), z = random_vector(A.size(), 2);
            const std::vector<double> Az = product(A, z);
            std::vector<double> corrected = z, added(A.size(), 0.0), expected = z, A_expected = Az;
            Products of_z{.rz = dot(r, z), .zAz = dot(z, Az)};
            coarse.correct_put_off(r.data(), corrected.data(), added.data(), of_z);
            coarse.correct(r.data(), expected.data(), A_expected.data());
            CHECK(max_difference(corrected, expected) < error * norm_inf(expected));
            axpy(1, Az, added);
            CHECK(max_difference(added, product(A, corrected)) < error * norm_inf(A));
            CHECK(of_z.rz == doctest::Approx(dot(r, corrected)).epsilon(error));
            CHECK(of_z.zAz == doctest::Approx(dot(corrected, product(A, corrected))).epsilon(error));
        }
}

TEST_CASE("the correction solves the system on the coarse space") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(1331, d, grid_3d(11), 1e-2);
        CoarseSpace coarse(A);
        REQUIRE(coarse.factor(A).status == SolveStatus::success);
        const std::vector<int> group = groups_of(coarse, A.n);
        const int size = coarse.groups() * d;
        REQUIRE(coarse.groups() > 1);
        Dense E{size, std::vector<double>(size * size)};
        for (int j = 0; j < size; ++j) {
            std::vector<double> unit(size, 0.0);
            unit[j] = 1;
            const std::vector<double> column =
                restricted(group, coarse.groups(), d, product(A, prolonged(group, d, unit)));
            for (int i = 0; i < size; ++i) E(i, j) = column[i];
        }
        REQUIRE(dense_cholesky(E) == -1);
        const std::vector<double> r = random_vector(A.size(), 1), z = random_vector(A.size(), 2);
        for (bool with_z : {false, true}) {
            std::vector<double> residual = r;
            if (with_z) axpy(-1, product(A, z), residual);
            const std::vector<double> c = dense_solve(E, restricted(group, coarse.groups(), d, residual));
            const std::vector<double> expected = prolonged(group, d, c);
            std::vector<double> x = with_z ? z : std::vector<double>(A.size(), 0.0), Ax = product(A, x);
            const double rZc = with_z ? coarse.correct(r.data(), x.data(), Ax.data())
                                      : coarse.correct_start(r.data(), x.data());
            for (int i = 0; i < A.size(); ++i)
                CHECK(x[i] - (with_z ? z[i] : 0) == doctest::Approx(expected[i]).epsilon(1e-10));
            CHECK(rZc == doctest::Approx(dot(r, expected)).epsilon(1e-10));
            if (with_z) CHECK(max_difference(Ax, product(A, x)) < 1e-10 * norm_inf(A));
        }
    }
}

TEST_CASE("conjugate gradients take fewer iterations, more so the softer the matrix, and find the same solution") {
    const auto solve = [](double excess, bool deflated) {
        const BlockCsr A = laplacian(8000, 1, grid(20, 400), excess);  // a strip, fixed by nothing else
        const std::vector<double> b = random_vector(A.size());
        std::unique_ptr<Preconditioner> M = make_ilu0(A);
        if (deflated) M = std::make_unique<Deflated>(std::move(M), std::make_unique<CoarseSpace>(A));
        REQUIRE(M->factor(A).status == SolveStatus::success);
        std::vector<double> x(A.size());
        const KrylovResult result = ConjugateGradients(A.size(), {1000, 1e-10}).solve(A, *M, b.data(), x.data());
        if (result.status == SolveStatus::success) {
            std::vector<double> residual = b;
            axpy(-1, product(A, x), residual);
            CHECK(norm_2(residual) <= 1.001e-10 * norm_2(b));
        }
        return result;
    };
    CHECK(solve(1e-2, true).iterations < 0.6 * solve(1e-2, false).iterations);
    CHECK(solve(1e-4, false).status == SolveStatus::stagnated);
    const KrylovResult soft = solve(1e-4, true);
    CHECK(soft.status == SolveStatus::success);
    CHECK(soft.iterations < 100);
}

TEST_CASE("deflation goes without ILU(0) as well, for any d") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(1331, d, grid_3d(11), 1e-1);
        const std::vector<double> expected = random_vector(A.size()), b = product(A, expected);
        Deflated M = only_deflated(A);
        std::vector<double> x(A.size());
        const KrylovResult result =
            ConjugateGradients(A.size(), {1000, 1e-12}).solve(A, M, b.data(), x.data());
        CHECK(result.status == SolveStatus::success);
        CHECK(max_difference(x, expected) < 1e-12 * norm_inf(A) / 1e-1 * norm_2(expected));
    }
}

TEST_CASE("the start is corrected so that Z'(b - A x) = 0") {
    const BlockCsr A = random_spd(1331, 2, grid_3d(11), 1e-2);
    const std::vector<double> b = random_vector(A.size());
    const CoarseSpace coarse(A);
    Deflated M = only_deflated(A);
    std::vector<double> x(A.size(), 0.0), r = b;
    const double ry = M.correct_start(b.data(), x.data());
    CHECK(ry == doctest::Approx(dot(b, x)).epsilon(1e-10));
    axpy(-1, product(A, x), r);
    const double scale = norm_inf(restricted(groups_of(coarse, A.n), coarse.groups(), 2, b));
    CHECK(norm_inf(restricted(groups_of(coarse, A.n), coarse.groups(), 2, r)) < 1e-10 * scale);
}

TEST_CASE("the corrected iteration ends where the coarse space holds the solution") {
    const BlockCsr A = laplacian(1728, 1, grid_3d(12), 1e-3);
    Deflated M = only_deflated(A);
    const std::vector<double> ones(A.size(), 1.0), b = product(A, ones);
    std::vector<double> x(A.size());
    const KrylovResult result =
        ConjugateGradients(A.size(), {100, 1e-10}).solve(A, M, b.data(), x.data());
    CHECK(result.status == SolveStatus::success);
    CHECK(result.iterations == 0);
    CHECK(max_difference(x, ones) < 1e-10);
}

TEST_CASE("a coarse matrix that is not positive definite shows that A is not") {
    BlockCsr A = laplacian(1728, 2, grid_3d(12), 1e-3);
    CoarseSpace coarse(A);
    CHECK(coarse.factor(A).status == SolveStatus::success);
    for (int i = 0; i < A.n; ++i) A.block(A.find(i, i))[0] -= 2e-3;
    CHECK(coarse.factor(A).status == SolveStatus::not_positive_definite);
}

TEST_CASE("small, empty and unconnected matrices are their own coarse space") {
    for (int n : {0, 1, 5}) {
        const BlockCsr A = random_spd(n, 2, {});
        Deflated M = only_deflated(A);
        const std::vector<double> b = random_vector(A.size());
        std::vector<double> x(A.size());
        const KrylovResult result = ConjugateGradients(A.size(), {}).solve(A, M, b.data(), x.data());
        CHECK(result.status == SolveStatus::success);
        CHECK(max_difference(product(A, x), b) < 1e-12);
    }
}
