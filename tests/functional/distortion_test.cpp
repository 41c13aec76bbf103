#include "functional/distortion.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace almesh;

namespace {

template <int n>
Mat<n> random_matrix(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    Mat<n> m;
    for (auto& row : m)
        for (double& v : row) v = uniform(random);
    return m;
}

// A random F with the given determinant sign; `thin` squeezes one direction to make it nearly inverted.
template <int n>
Mat<n> random_gradient(std::mt19937& random, double thin) {
    auto svd = singular_values(random_matrix<n>(random));
    for (int k = 0; k < n; ++k) svd.s[k] = 0.7 + 0.3 * k;
    svd.s[n - 1] *= thin;
    Mat<n> US = svd.U;
    for (auto& row : US)
        for (int k = 0; k < n; ++k) row[k] *= svd.s[k];
    return multiply<n>(US, transpose<n>(svd.V));
}

template <int n>
double f(const Mat<n>& F, double delta, Objective objective) {
    return density(distortion<n>(F, delta), objective);
}

template <int n>
Mat<n> shifted(Mat<n> F, const Mat<n>& dF, double t) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) F[i][j] += t * dF[i][j];
    return F;
}

template <int n>
double inner(const Mat<n>& a, const Mat<n>& b) {
    double s = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) s += a[i][j] * b[i][j];
    return s;
}

template <int n>
Mat<n> apply(const DensityHessian<n>& A, const Mat<n>& dF) {
    Mat<n> r{};
    for (int m = 0; m < n * n; ++m) r = shifted<n>(r, A.mode[m], A.value[m] * inner<n>(A.mode[m], dF));
    return r;
}

// Central differences against the derivative: the error must fall as t^2.
template <int n>
void check_slopes(const Mat<n>& F, double delta, Objective objective, const Mat<n>& dF, double t) {
    const double exact = inner<n>(density_gradient<n>(F, delta, objective), dF);
    const Mat<n> exact2 = apply<n>(density_hessian<n>(F, delta, objective), dF);
    double first[2], second[2];
    for (int k = 0; k < 2; ++k, t /= 2) {
        const Mat<n> plus = shifted<n>(F, dF, t), minus = shifted<n>(F, dF, -t);
        first[k] = std::abs((f<n>(plus, delta, objective) - f<n>(minus, delta, objective)) / (2 * t) - exact);
        Mat<n> difference = density_gradient<n>(plus, delta, objective);
        difference = shifted<n>(difference, density_gradient<n>(minus, delta, objective), -1);
        for (auto& row : difference)
            for (double& v : row) v /= 2 * t;
        second[k] = std::sqrt(frobenius_squared<n>(shifted<n>(difference, exact2, -1)));
    }
    CHECK(std::log2(first[0] / first[1]) == doctest::Approx(2).epsilon(0.05));
    CHECK(std::log2(second[0] / second[1]) == doctest::Approx(2).epsilon(0.05));
}

template <int n>
void check_derivatives() {
    std::mt19937 random(7);
    for (const Objective objective : {Objective::squared, Objective::deviation})
        for (int trial = 0; trial < 5; ++trial) {
            const Mat<n> dF = random_matrix<n>(random);
            check_slopes<n>(random_gradient<n>(random, 1), 0, objective, dF, 2e-2);
            check_slopes<n>(random_gradient<n>(random, 1e-2), 0, objective, dF, 2e-4);  // nearly inverted
            check_slopes<n>(random_gradient<n>(random, -0.5), 0.3, objective, dF, 1e-2);  // inverted, regularised
        }
}

template <int n>
void check_modes() {
    std::mt19937 random(11);
    bool some_negative = false;
    for (int trial = 0; trial < 20; ++trial) {
        const auto H = density_hessian<n>(random_gradient<n>(random, trial % 2 ? 0.2 : 0.05), 0, Objective::deviation);
        for (int k = 0; k < n * n; ++k) {
            some_negative = some_negative || H.value[k] < 0;
            for (int l = 0; l < n * n; ++l)
                CHECK(inner<n>(H.mode[k], H.mode[l]) == doctest::Approx(k == l).epsilon(1e-13).scale(1));
        }
    }
    CHECK(some_negative);  // otherwise there is nothing to project
}

}  // namespace

TEST_CASE("eta is one exactly for rotations times scalings") {
    CHECK(distortion<2>({{{1, 0}, {0, 1}}}, 0) == 1);
    CHECK(distortion<3>({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0) == doctest::Approx(1));
    CHECK(distortion<2>({{{0, -5}, {5, 0}}}, 0) == 1);
    CHECK(distortion<2>({{{2, 0}, {0, 1}}}, 0) == 1.25);           // (4 + 1) / (2 * 2)
    CHECK(distortion<3>({{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, 0) == doctest::Approx(1));
    CHECK(distortion<3>({{{8, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 0) == doctest::Approx(66.0 / (3 * 4)));
}

TEST_CASE("eta is infinite for degenerate and inverted maps, unless regularised") {
    CHECK(std::isinf(distortion<2>({{{1, 0}, {0, -1}}}, 0)));
    CHECK(std::isinf(distortion<2>({{{1, 1}, {1, 1}}}, 0)));
    CHECK(std::isinf(distortion<3>(Mat<3>{}, 0)));
    CHECK(std::isinf(distortion<2>({{{NAN, 0}, {0, 1}}}, 0)));
    // Eq. 3 at sigma = 0: sigma_delta = delta.
    CHECK(distortion<2>({{{1, 1}, {1, 1}}}, 0.5) == doctest::Approx(4 / (2 * 0.5)));
    CHECK(std::isfinite(distortion<2>({{{1, 0}, {0, -1}}}, 0.1)));
}

TEST_CASE("eta does not see rotations and scalings of either frame") {
    std::mt19937 random(3);
    for (int trial = 0; trial < 20; ++trial) {
        const Mat<3> F = random_gradient<3>(random, 0.3);
        Mat<3> R = singular_values(random_matrix<3>(random)).U;
        for (auto& row : R)
            for (double& v : row) v *= 7.5;
        const double eta = distortion<3>(F, 0);
        CHECK(distortion<3>(multiply<3>(R, F), 0) == doctest::Approx(eta));
        CHECK(distortion<3>(multiply<3>(F, R), 0) == doctest::Approx(eta));
    }
}

TEST_CASE_TEMPLATE("singular values rebuild the matrix from rotations", N, std::integral_constant<int, 2>,
                   std::integral_constant<int, 3>) {
    constexpr int n = N::value;
    std::mt19937 random(5);
    std::vector<Mat<n>> cases = {Mat<n>{}};
    Mat<n> rank_one{};
    rank_one[0][n - 1] = 2;
    cases.push_back(rank_one);
    for (int trial = 0; trial < 50; ++trial) cases.push_back(random_matrix<n>(random));
    for (const Mat<n>& F : cases) {
        const auto [U, V, s] = singular_values(F);
        Mat<n> US = U;
        for (auto& row : US)
            for (int k = 0; k < n; ++k) row[k] *= s[k];
        const Mat<n> rebuilt = multiply<n>(US, transpose<n>(V));
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) CHECK(rebuilt[i][j] == doctest::Approx(F[i][j]).epsilon(1e-13).scale(1));
        CHECK(determinant(U) == doctest::Approx(1));
        CHECK(determinant(V) == doctest::Approx(1));
    }
}

TEST_CASE("first and second derivatives have slope 2 in 2D") { check_derivatives<2>(); }
TEST_CASE("first and second derivatives have slope 2 in 3D") { check_derivatives<3>(); }
TEST_CASE("the modes of the Hessian are orthonormal, and some values negative") {
    check_modes<2>();
    check_modes<3>();
}

TEST_CASE("at the identity the Hessian of Eq. 5 is zero and that of eta^2 has the conformal maps as kernel") {
    const Mat<3> I = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (double v : density_hessian<3>(I, 0, Objective::deviation).value) CHECK(std::abs(v) < 1e-14);
    const auto A = density_hessian<3>(I, 0, Objective::squared);
    const Mat<3> rotation = {{{0, 1, 2}, {-1, 0, 3}, {-2, -3, 0}}}, shear = {{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}};
    CHECK(frobenius_squared<3>(apply<3>(A, rotation)) < 1e-26);
    CHECK(frobenius_squared<3>(apply<3>(A, I)) < 1e-26);
    CHECK(inner<3>(shear, apply<3>(A, shear)) > 1);
}
