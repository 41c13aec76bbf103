// Solutions of the exercises of lesson 2.
#include <cmath>

#include "lessons/exercises/02.hpp"

namespace almesh::lessons {
namespace {

template <int n>
Mat<n> sum(double a, const Mat<n>& A, double b, const Mat<n>& B) {
    Mat<n> C;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) C[i][j] = a * A[i][j] + b * B[i][j];
    return C;
}

double contract(const Mat<2>& A, const Mat<2>& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}

// Also for 2.4, which holds whether 2.2 does or not.
Mat<2> gradient(const Mat<2>& F) {
    const double D = determinant(F), S = frobenius_squared<2>(F);
    return sum<2>(1 / D, F, -S / (2 * D * D), cofactor(F));
}

}  // namespace

double observed_order(const std::function<double(double)>& f, double slope, double h) {
    const auto error = [&](double t) { return std::abs(f(t) - f(0) - t * slope); };
    return std::log2(error(h) / error(h / 2));
}

Mat<2> eta_gradient_2d(const Mat<2>& F) {
    return gradient(F);
}

Mat<2> gradient_by_ideal(const Mat<2>& A, const Mat<2>& B) {
    // In 2D eta(F) = eta(F^-1) (lesson 1, on paper): A may as well be the triangle that moves, with the ideal B.
    const Mat<2> B_inverse = inverse<2>(B);
    return multiply<2>(eta_gradient_2d(multiply<2>(A, B_inverse)), transpose<2>(B_inverse));
}

Mat<3> eta_gradient_3d(const Mat<3>& F) {
    const double D = determinant(F), S = frobenius_squared<3>(F);
    const double r = 1 / (3 * std::cbrt(D * D)), r1 = -2 * r / (3 * D);
    return sum<3>(2 * r, F, S * r1, cofactor(F));
}

Mat<3> sized_gradient_3d(const Mat<3>& F) {
    const double D = determinant(F), eta = frobenius_squared<3>(F) / (3 * std::cbrt(D * D));
    return sum<3>((D + 1 / D) / 2, eta_gradient_3d(F), eta * (1 - 1 / (D * D)) / 2, cofactor(F));
}

Mat<2> eta_second_2d(const Mat<2>& F, const Mat<2>& H) {
    const Mat<2> C = cofactor(F);
    const double D = determinant(F), S = frobenius_squared<2>(F), D_H = contract(C, H), S_H = 2 * contract(F, H);
    const Mat<2> of_first = sum<2>(1 / D, H, -D_H / (D * D), F);
    const Mat<2> of_second = sum<2>(-S_H / (2 * D * D) + S * D_H / (D * D * D), C, -S / (2 * D * D), cofactor(H));
    return sum<2>(1, of_first, 1, of_second);
}

Mat<2> falling_curvature(const Mat<2>& F) {
    // H = F + t G, G = eta_F: as eta_FF F = -G the curvature is -2 t |G|^2 + t^2 G : eta_FF G. It is least at this t.
    const Mat<2> G = gradient(F);
    return sum<2>(1, F, contract(G, G) / contract(G, eta_second_2d(F, G)), G);
}

Mat<2> second_of_deviation(double eta, const Mat<2>& eta_F, const Mat<2>& eta_FF_H, const Mat<2>& H) {
    return sum<2>(2 * contract(eta_F, H), eta_F, 2 * (eta - 1), eta_FF_H);
}

double fourth_order(const Mat<2>& H) {
    // eta = 1 + second h^2 + O(h^3), half of H : eta_FF H: neither a scaling nor a rotation counts.
    const double stretch = H[0][0] - H[1][1], shear = H[0][1] + H[1][0];
    const double second = (stretch * stretch + shear * shear) / 2;
    return second * second;
}

static Hyper sum(double s, const Hyper& a, double t, const Hyper& b) {
    return {s * a.value + t * b.value, s * a.one + t * b.one, s * a.two + t * b.two, s * a.both + t * b.both};
}

Hyper product(const Hyper& a, const Hyper& b) {
    return {a.value * b.value, a.value * b.one + a.one * b.value, a.value * b.two + a.two * b.value,
            a.value * b.both + a.one * b.two + a.two * b.one + a.both * b.value};
}

// f(x), given f, f' and f'' at its value: Taylor's formula ends with the second-order term.
static Hyper chain(const Hyper& x, double f, double f1, double f2) {
    return {f, f1 * x.one, f1 * x.two, f1 * x.both + f2 * x.one * x.two};
}

Hyper quotient(const Hyper& a, const Hyper& b) {
    const double inverse = 1 / b.value;
    return product(a, chain(b, inverse, -inverse * inverse, 2 * inverse * inverse * inverse));
}

Hyper root(const Hyper& a) {
    const double r = std::sqrt(a.value);
    return chain(a, r, 0.5 / r, -0.25 / (r * a.value));
}

Hyper eta_delta(const Mat<2>& F, const Mat<2>& H, const Mat<2>& K, double delta) {
    Hyper f[2][2], S;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            f[i][j] = {F[i][j], H[i][j], K[i][j], 0};
            S = sum(1, S, 1, product(f[i][j], f[i][j]));
        }
    const Hyper D = sum(1, product(f[0][0], f[1][1]), -1, product(f[0][1], f[1][0]));
    const Hyper r = root(sum(1, product(D, D), 4 * delta * delta, {1}));
    // D + r loses its digits where D < 0, in all four parts.
    const Hyper twice_sigma = D.value > 0 ? sum(1, D, 1, r) : quotient({4 * delta * delta}, sum(1, r, -1, D));
    return quotient(S, twice_sigma);
}

}  // namespace almesh::lessons
