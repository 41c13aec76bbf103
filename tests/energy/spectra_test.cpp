#include "energy/spectra.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "lessons/plain_energy.hpp"
#include "support/random_matrices.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// check(batch) for batches that hold each of the cases, every one in another lane each time.
template <int n, class Check>
void in_every_lane(const std::vector<Mat<n>>& cases, const Check& check) {
    for (std::size_t first = 0; first < cases.size(); ++first) {
        Mat<n, Lanes> batch;
        for (int l = 0; l < lanes; ++l) set_lane<n>(batch, l, cases[(first + l) % cases.size()]);
        check(batch);
    }
}

template <int n>
std::vector<Mat<n>> matrices(std::mt19937& random) {
    std::vector<Mat<n>> cases = {Mat<n>{}};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {  // rank one, along the axes
            cases.push_back(Mat<n>{});
            cases.back()[i][j] = i < j ? 2 : -0.5;
        }
    const std::vector<Vec<3>> values = {
        {1, 1, 1},    {2, 2, 2},         {2, 2, 0.1},   {3, 1, 1},    {1, 1e-8, 1},
        {1, 1e-8, 0}, {1, 1e-12, 1e-12}, {1, 1, -1e-8}, {5, 3, -0.1}, {1, 1 + 1e-12, 1 - 1e-12}};
    for (const Vec<3>& s : values) {
        Vec<n> some;
        for (int k = 0; k < n; ++k) some[k] = s[3 - n + k];
        cases.push_back(with_singular_values<n>(random, some));
        Mat<n> diagonal{};
        for (int k = 0; k < n; ++k) diagonal[k][k] = some[k];
        cases.push_back(diagonal);
    }
    for (int trial = 0; trial < 50; ++trial) cases.push_back(random_matrix<n>(random));
    return cases;
}

// Largest entry of |A - B|.
template <int n>
double distance(const Mat<n>& A, const Mat<n>& B) {
    double most = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) most = std::max(most, std::abs(A[i][j] - B[i][j]));
    return most;
}

template <int n>
Mat<n> identity() {
    Mat<n> I{};
    for (int i = 0; i < n; ++i) I[i][i] = 1;
    return I;
}

template <int n>
void check_singular_values() {
    std::mt19937 random(5);
    in_every_lane<n>(matrices<n>(random), [](const Mat<n, Lanes>& F) {
        const SingularValues<n> svd = singular_values(F);
        for (int l = 0; l < lanes; ++l) {
            const Mat<n> U = lane_of<n>(svd.U, l), V = lane_of<n>(svd.V, l), single = lane_of<n>(F, l);
            Mat<n> US = U;
            for (auto& row : US)
                for (int k = 0; k < n; ++k) row[k] *= svd.s[k][l];
            CHECK(distance<n>(multiply<n>(US, transpose<n>(V)), single) <
                  1e-14 * std::sqrt(frobenius_squared<n>(single)) + 1e-299);
            CHECK(distance<n>(multiply<n>(U, transpose<n>(U)), identity<n>()) < 2e-15);
            CHECK(distance<n>(multiply<n>(V, transpose<n>(V)), identity<n>()) < 4e-15);
            CHECK(determinant(U) == doctest::Approx(1));
            CHECK(determinant(V) == doctest::Approx(1));
            for (int k = 1; k < n; ++k) CHECK(svd.s[k - 1][l] >= std::abs(svd.s[k][l]) * (1 - 1e-14));
        }
    });
}

// Symmetric matrices with eigenvalues of both signs, one, equal ones, zeros.
template <int n>
std::vector<Mat<n>> symmetric_matrices(std::mt19937& random) {
    std::vector<Mat<n>> cases = {Mat<n>{}};
    const std::vector<Vec<3>> values = {{1, 2, 3},    {-1, -2, -3}, {1, 1, 1},        {-1, -1, -1},
                                        {1, -1, 2},   {1, -1, -1},  {0, 0, -5},       {0, 0, 5},
                                        {1e8, 1, -1}, {-1e8, 1, 1}, {1, 1e-8, -1e-8}, {2, -3, 0}};
    for (const Vec<3>& value : values)
        for (int trial = 0; trial < 4; ++trial) {
            const Mat<n> Q = trial == 0 ? identity<n>() : random_rotation<n>(random);
            Mat<n> A{};
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j)
                    for (int k = 0; k < n; ++k) A[i][j] += value[k] * Q[i][k] * Q[j][k];
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < i; ++j) A[i][j] = A[j][i];
            cases.push_back(A);
        }
    return cases;
}

template <int n>
void check_negative_part() {
    std::mt19937 random(6);
    in_every_lane<n>(symmetric_matrices<n>(random), [](const Mat<n, Lanes>& A) {
        for (const double part : {0.0, 0.3, 1.0}) {
            const Mat<n, Lanes> B = filtered(A, part);
            for (int l = 0; l < lanes; ++l) {
                Mat<n> expected = lane_of<n>(A, l);
                const double scale = std::sqrt(frobenius_squared<n>(expected));
                if (part == 1) CHECK(distance<n>(lane_of<n>(B, l), expected) <= 1e-14 * scale);
                project(n, &expected[0][0], part);
                CHECK(distance<n>(lane_of<n>(B, l), expected) <= 1e-14 * scale);
            }
        }
    });
}

// The matrix of lane l in every lane.
template <int n>
Mat<n, Lanes> alone(const Mat<n, Lanes>& batch, int l) {
    Mat<n, Lanes> same;
    for (int k = 0; k < lanes; ++k) set_lane<n>(same, k, lane_of<n>(batch, l));
    return same;
}

template <int n>
void check_lanes_alone() {
    std::mt19937 random(8);
    in_every_lane<n>(matrices<n>(random), [](const Mat<n, Lanes>& F) {
        const SingularValues<n> svd = singular_values(F);
        for (int l = 0; l < lanes; ++l) {
            const SingularValues<n> single = singular_values(alone<n>(F, l));
            CHECK(lane_of<n>(svd.U, l) == lane_of<n>(single.U, l));
            CHECK(lane_of<n>(svd.V, l) == lane_of<n>(single.V, l));
            for (int k = 0; k < n; ++k) CHECK(double(svd.s[k][l]) == double(single.s[k][l]));
        }
    });
    in_every_lane<n>(symmetric_matrices<n>(random), [](const Mat<n, Lanes>& A) {
        const Mat<n, Lanes> P = filtered(A, 0);
        for (int l = 0; l < lanes; ++l) CHECK(lane_of<n>(P, l) == lane_of<n>(filtered(alone<n>(A, l), 0), l));
    });
}

}  // namespace

TEST_CASE("a matrix gets the same bits whatever is in the lanes beside it: 2D") { check_lanes_alone<2>(); }
TEST_CASE("a matrix gets the same bits whatever is in the lanes beside it: 3D") { check_lanes_alone<3>(); }
TEST_CASE("singular values rebuild the matrix from rotations: 2D") { check_singular_values<2>(); }
TEST_CASE("singular values rebuild the matrix from rotations: 3D") { check_singular_values<3>(); }
TEST_CASE("negative eigenvalues are made smaller as by the plain eigensolver: 2D") { check_negative_part<2>(); }
TEST_CASE("negative eigenvalues are made smaller as by the plain eigensolver: 3D") { check_negative_part<3>(); }
