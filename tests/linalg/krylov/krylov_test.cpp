#include "linalg/krylov/krylov.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.hpp"
#include "linalg/krylov/deflated.hpp"
#include "support/identity.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

// A preconditioner of one's own: the inverse of the diagonal blocks, for d = 2.
class BlockJacobi final : public Preconditioner {
public:
    explicit BlockJacobi(const BlockCsr& pattern) : inverse_(4 * pattern.n), rz_(pattern.size()) {}

    FactorResult factor(const BlockCsr& A) override {
        for (int i = 0; i < A.n; ++i) {
            const double* const D = A.block(A.find(i, i));
            const double determinant = D[0] * D[3] - D[1] * D[2];
            if (!(determinant > 0)) return {SolveStatus::indefinite_preconditioner, i};
            const double inverse[] = {D[3], -D[1], -D[2], D[0]};
            for (int e = 0; e < 4; ++e) inverse_[4 * i + e] = inverse[e] / determinant;
        }
        return {SolveStatus::success};
    }

    double apply(const double* r, double* z) override {
        return rz_([&](int begin, int count) {
            for (int i = begin / 2; i < (begin + count) / 2; ++i)
                for (int a = 0; a < 2; ++a)
                    z[2 * i + a] = inverse_[4 * i + 2 * a] * r[2 * i] + inverse_[4 * i + 2 * a + 1] * r[2 * i + 1];
            return dot_of_piece(count, r + begin, z + begin);
        });
    }

private:
    std::vector<double> inverse_;  // 2 x 2 per node
    TeamSum rz_;
};

// A matrix whose nodes have units from 1 to 1e4.
BlockCsr badly_scaled(int n, const Edges& edges) {
    BlockCsr A = random_spd(n, 2, edges);
    const auto unit = [](int node) { return std::pow(10.0, node % 5); };
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int e = 0; e < 4; ++e) A.block(k)[e] *= unit(i) * unit(A.col[k]);
    return A;
}

template <class Method>
KrylovResult solved(Method method, const BlockCsr& A, Preconditioner& M, std::vector<double>& x) {
    REQUIRE(M.factor(A).status == SolveStatus::success);
    const std::vector<double> b = random_vector(A.size());
    x.resize(A.size());
    return method.solve(A, M, b.data(), x.data());
}

}  // namespace

TEST_CASE("a preconditioner of one's own serves both Krylov methods, alone and deflated") {
    const BlockCsr A = badly_scaled(400, grid(20, 20));
    const KrylovParams params{1000, 1e-8, 50};
    Identity none(A.size());
    BlockJacobi jacobi(A);
    Deflated deflated(std::make_unique<BlockJacobi>(A), std::make_unique<CoarseSpace>(A));
    std::vector<double> x;
    for (Preconditioner* M : {static_cast<Preconditioner*>(&jacobi), static_cast<Preconditioner*>(&deflated)}) {
        CHECK(solved(ConjugateGradients(A.size(), params), A, *M, x).status == SolveStatus::success);
        CHECK(scaled_residual(A, x, random_vector(A.size())) < 1e-8);
        CHECK(solved(Gmres(A.size(), params), A, *M, x).status == SolveStatus::success);
        CHECK(scaled_residual(A, x, random_vector(A.size())) < 1e-8);
    }
    CHECK(solved(ConjugateGradients(A.size(), params), A, jacobi, x).iterations < 100);
    CHECK(solved(ConjugateGradients(A.size(), params), A, none, x).status == SolveStatus::stagnated);
    CHECK(solved(Gmres(A.size(), params), A, none, x).status == SolveStatus::stagnated);
}

TEST_CASE("a failed factorisation names its row, with deflation around it too") {
    BlockCsr A = random_spd(30, 2, path(30));
    A.block(A.find(7, 7))[0] = -1;
    Deflated M(std::make_unique<BlockJacobi>(A), std::make_unique<CoarseSpace>(A));
    const FactorResult result = M.factor(A);
    CHECK(result.status == SolveStatus::indefinite_preconditioner);
    CHECK(result.bad_row == 7);
}

TEST_CASE("sums by a team have the same bits for any number of threads") {
    const int n = 20000, before = max_threads();
    const std::vector<double> u = random_vector(n, 1), v = random_vector(n, 2);
    const auto dot_by = [&](int threads) {
        set_threads(threads);
        TeamSum sum(n);
        double result = 0;
#pragma omp parallel
        {
            const double own = sum([&](int i, int count) { return dot_of_piece(count, u.data() + i, v.data() + i); });
#pragma omp single
            result = own;
        }
        return result;
    };
    const double first = dot_by(1);
    CHECK(first == doctest::Approx(dot(u, v)));
    for (int threads : {2, 3, 5}) CHECK(dot_by(threads) == first);
    set_threads(before);
}

namespace {

// Iterations until the test fires on the residuals rate^k, at most 1000.
int iterations_at(double rate) {
    StagnationTest test{1};
    for (int k = 1; k <= 1000; ++k)
        if (test.stagnates(std::pow(rate, k))) return k;
    return 1000;
}

}  // namespace

TEST_CASE("twenty iterations must halve the residual") {
    CHECK(iterations_at(0.95) == 1000);  // 0.95^20 = 0.36
    CHECK(iterations_at(0.99) == 20);    // 0.99^20 = 0.82
    CHECK(iterations_at(1.0) == 20);
    CHECK(iterations_at(2.0) == 20);
}

TEST_CASE("the best residual of each window counts, and only what came since the window before") {
    StagnationTest test{1};
    for (int k = 1; k <= 200; ++k) CHECK_FALSE(test.stagnates((k % 7 == 0 ? 1 : 100) * std::pow(0.9, k)));
    StagnationTest late{1};
    int fired = 0;
    for (int k = 1; k <= 60 && !fired; ++k) fired = late.stagnates(std::pow(0.5, std::min(k, 30))) ? k : 0;
    CHECK(fired == 60);
}
