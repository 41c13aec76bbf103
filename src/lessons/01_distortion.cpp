// Lesson 1: the distortion of one triangle, and the barrier that keeps it valid.
//
// The ideal triangle has vertices a, b and c: it is equilateral, or as high as the program's argument says. The map phi
// that leaves a and b where they are and takes c to a point x is affine; its Jacobian F is one 2 x 2 matrix. This
// program puts x on a line across the edge ab and on a grid of the plane, and tabulates det F, eta and the regularised
// eta_delta.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/small_matrix.hpp"
#include "energy/densities.hpp"

using namespace almesh;

namespace {

using Point = Vec<2>;

const Point a = {0, 0}, b = {1, 0};
Point c = {0.5, std::sqrt(3.0) / 2};

// Columns b - a and x - a: what takes the reference triangle to the one with vertices a, b, x.
Mat<2> edges_to(Point x) { return {{{b[0] - a[0], x[0] - a[0]}, {b[1] - a[1], x[1] - a[1]}}}; }

// F = D phi: from the ideal triangle back to the reference one, from there to the physical one.
Mat<2> jacobian(Point x) {
    const Mat<2> A_inverse = inverse<2>(edges_to(c)), B = edges_to(x);
    Mat<2> F{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k) F[i][j] += B[i][k] * A_inverse[k][j];
    return F;
}

// Eq. 1: eta = |F|^2 / (n det F^{2/n}), n = 2; infinite where the triangle is inverted.
double eta(const Mat<2>& F) {
    const double det = determinant(F);
    return det > 0 ? frobenius_squared<2>(F) / (2 * det) : INFINITY;
}

// Eqs. 2 and 3: det F replaced by sigma_delta, which is positive everywhere.
double eta_delta(const Mat<2>& F, double delta) {
    const double det = determinant(F), sigma = 0.5 * (det + std::sqrt(det * det + 4 * delta * delta));
    return frobenius_squared<2>(F) / (2 * sigma);
}

void print_line_across_the_edge() {
    std::printf("  height of x     det F         eta   eta, delta 0.1\n");
    for (const double height : {2.0, 1.0, 0.8660254, 0.5, 0.1, 0.01, 0.0001, 0.0, -0.1, -0.5}) {
        const Mat<2> F = jacobian({0.5, height});
        std::printf("  %11.7g %9.4f %11.4f %12.4f\n", height, determinant(F), eta(F), eta_delta(F, 0.1));
    }
}

// cosh of the hyperbolic distance of x from c in the half plane above the edge ab, whose metric is |dx| / height.
double cosh_of_distance(Point x) {
    return std::cosh(2 * std::asinh(std::hypot(x[0] - c[0], x[1] - c[1]) / (2 * std::sqrt(x[1] * c[1]))));
}

// The same numbers from the program's own kernel, and from geometry.
void compare() {
    double largest = 0, from_cosh = 0;
    for (double height = 0.05; height < 3; height += 0.05) {
        const Mat<2> F = jacobian({0.3, height});
        largest = std::max(largest, std::abs(eta(F) - distortion<2>(F, 0.0)) / eta(F));
        largest = std::max(largest, std::abs(eta_delta(F, 0.1) - distortion<2>(F, 0.1)) / eta_delta(F, 0.1));
        from_cosh = std::max(from_cosh, std::abs(eta(F) - cosh_of_distance({0.3, height})) / eta(F));
    }
    std::printf("largest relative difference from the program's kernel: %.1e\n", largest);
    std::printf("largest relative difference from cosh of the hyperbolic distance: %.1e\n", from_cosh);
}

void write_map(const char* path) {
    std::FILE* const file = std::fopen(path, "w");
    std::fprintf(file, "x,y,det,eta,eta_delta\n");
    for (double y = -1.2; y < 2.4; y += 0.02)
        for (double x = -1.5; x < 2.5; x += 0.02) {
            const Mat<2> F = jacobian({x, y});
            std::fprintf(file, "%.2f,%.2f,%.6g,%.6g,%.6g\n", x, y, determinant(F), eta(F), eta_delta(F, 0.1));
        }
    std::fclose(file);
}

}  // namespace

int main(int count, char** argument) {
    if (count > 1) c[1] = std::atof(argument[1]);
    print_line_across_the_edge();
    compare();
    if (count > 1) return 0;
    std::filesystem::create_directories("outputs/lessons/01-distortion");
    write_map("outputs/lessons/01-distortion/map.csv");
    std::printf("outputs/lessons/01-distortion/map.csv: eta for every position of x\n");
}
