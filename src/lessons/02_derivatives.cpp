// Lesson 2: the derivatives of eta by hand, and the test that finds every mistake in them.
//
// F is a 2 x 2 Jacobian of height d, H a direction in which it changes. This program compares eta(F + h H) with its
// Taylor polynomials, differences eta near the barrier, and looks where its second derivative is negative.
//
//   02_derivatives [d] [symmetric] [transposed]      transposed: with a wrong gradient
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/small_matrix.hpp"
#include "energy/densities.hpp"

using namespace almesh;

namespace {

using Matrix = Mat<2>;

double d = 0.8;
bool transposed = false, symmetric = false;

Matrix sheared(double height) { return {{{1, 0.3}, {symmetric ? 0.3 : 0, height}}}; }

// The scalar product A : B of matrices, and a A + b B.
double product(const Matrix& A, const Matrix& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}
double norm(const Matrix& A) { return std::sqrt(product(A, A)); }
Matrix sum(double a, const Matrix& A, double b, const Matrix& B) {
    Matrix C;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) C[i][j] = a * A[i][j] + b * B[i][j];
    return C;
}

double eta_without_barrier(const Matrix& F) { return product(F, F) / (2 * determinant(F)); }
double eta(const Matrix& F) { return determinant(F) > 0 ? eta_without_barrier(F) : INFINITY; }

// eta_F = 2 r F + S r' C, with S = |F|^2, r = 1 / (2 D), D = det F, C = dD/dF.
Matrix eta_F(const Matrix& F) {
    const double D = determinant(F), S = product(F, F), r = 1 / (2 * D), r1 = -1 / (2 * D * D);
    const Matrix C = transposed ? transpose<2>(cofactor(F)) : cofactor(F);
    return sum(2 * r, F, S * r1, C);
}

// eta_FF H: the derivative of eta_F along H. C is linear in F, so its derivative along H is cofactor(H).
Matrix eta_FF(const Matrix& F, const Matrix& H) {
    const double D = determinant(F), S = product(F, F);
    const double r = 1 / (2 * D), r1 = -1 / (2 * D * D), r2 = 1 / (D * D * D);
    const Matrix C = cofactor(F);
    const double S_H = 2 * product(F, H), D_H = product(C, H);  // how S and D change along H
    const Matrix of_first = sum(2 * r, H, 2 * r1 * D_H, F);
    const Matrix of_second = sum(S_H * r1 + S * r2 * D_H, C, S * r1, cofactor(H));
    return sum(1, of_first, 1, of_second);
}

// How the errors of the Taylor polynomials of degree 0, 1, 2 fall with h.
void slope_test(std::FILE* csv) {
    const Matrix F = sheared(d), H = {{{0.2, -0.5}, {0.4, -0.7}}};
    const double first = product(eta_F(F), H), second = product(H, eta_FF(F, H));
    std::printf("         h   degree 0  order   degree 1  order   degree 2  order\n");
    if (csv) std::fprintf(csv, "h,degree_0,degree_1,degree_2\n");
    double before[3] = {INFINITY, INFINITY, INFINITY};
    for (double h = 0.1; h > 5e-4; h /= 2) {
        const double value = eta(sum(1, F, h, H));
        const double taylor[3] = {eta(F), eta(F) + h * first, eta(F) + h * first + 0.5 * h * h * second};
        std::printf("%10.3e", h);
        if (csv) std::fprintf(csv, "%.6g", h);
        for (int k = 0; k < 3; ++k) {
            const double error = std::abs(value - taylor[k]), order = std::log2(before[k] / error);
            std::printf(std::isfinite(order) ? " %10.3e %6.2f" : " %10.3e      -", error, order);
            if (csv) std::fprintf(csv, ",%.6g", error);
            before[k] = error;
        }
        std::printf("\n");
        if (csv) std::fprintf(csv, "\n");
    }
}

// d eta / d height as the triangle gets flat, and the central difference with h = 0.01 with and without the barrier.
void approach_the_barrier() {
    const Matrix H = {{{0, 0}, {0, 1}}};
    const double h = 0.01;
    const auto difference = [&](auto f, const Matrix& F) {
        return (f(sum(1, F, h, H)) - f(sum(1, F, -h, H))) / (2 * h);
    };
    std::printf("\n  height       eta    d eta/dh   d2 eta/dh2  difference  without barrier\n");
    for (const double height : {1.0, 0.1, 0.02, 0.0125, 0.005, 0.0005}) {
        const Matrix F = sheared(height);
        std::printf("%8g %9.4g %11.4g %12.4g %11.4g %16.4g\n", height, eta(F), product(eta_F(F), H),
                    product(H, eta_FF(F, H)), difference(eta, F), difference(eta_without_barrier, F));
    }
}

// d2 f(eta) / dH2 for f = eta, eta^2 and (eta - 1)^2, |H| = 1.
void print_curvatures(const char* name, const Matrix& F, Matrix H) {
    H = sum(1 / norm(H), H, 0, H);
    const double slope = product(eta_F(F), H), curvature = product(H, eta_FF(F, H)), e = eta(F);
    const double square = 2 * slope * slope + 2 * e * curvature,
                 deviation = 2 * slope * slope + 2 * (e - 1) * curvature;
    std::printf("  %-22s %9.4f %9.4f %9.4f\n", name, curvature, square, deviation);
}

void second_derivatives() {
    const Matrix I = {{{1, 0}, {0, 1}}}, J = {{{0, -1}, {1, 0}}}, F = {{{1, 0}, {0, 0.5}}}, G = eta_F(F);
    std::printf("\nsecond derivative of            eta     eta^2 (eta-1)^2\n");
    print_curvatures("at I: scaling", I, I);
    print_curvatures("      rotation", I, J);
    print_curvatures("      stretch", I, {{{1, 0}, {0, -1}}});
    print_curvatures("      shear", I, {{{0, 1}, {1, 0}}});
    print_curvatures("at diag(1, 1/2): F", F, F);
    print_curvatures("      eta_F", F, G);
    print_curvatures("      F + eta_F / 20", F, sum(1, F, 0.05, G));
}

// Central differences of eta along the height, for all h: between truncation and rounding.
void write_differences(const char* path) {
    std::FILE* const file = std::fopen(path, "w");
    std::fprintf(file, "height,h,error\n");
    const Matrix H = {{{0, 0}, {0, 1}}};
    for (const double height : {0.8, 0.08, 0.008})
        for (double h = 1; h > 1e-12; h /= 1.5) {
            const Matrix F = sheared(height);
            const double exact = product(eta_F(F), H), value = eta(sum(1, F, h, H)) - eta(sum(1, F, -h, H));
            std::fprintf(file, "%g,%.6g,%.6g\n", height, h, std::abs(value / (2 * h) / exact - 1));
        }
    std::fclose(file);
}

}  // namespace

int main(int count, char** argument) {
    for (int i = 1; i < count; ++i) {
        const std::string word = argument[i];
        (word == "symmetric" ? symmetric : transposed) |= word == "symmetric" || word == "transposed";
        if (std::isdigit(static_cast<unsigned char>(word[0]))) d = std::atof(argument[i]);
    }
    if (count > 1) return slope_test(nullptr), 0;
    std::filesystem::create_directories("outputs/lessons/02-derivatives");
    std::FILE* const csv = std::fopen("outputs/lessons/02-derivatives/slopes.csv", "w");
    slope_test(csv);
    std::fclose(csv);
    approach_the_barrier();
    second_derivatives();
    write_differences("outputs/lessons/02-derivatives/differences.csv");
}
