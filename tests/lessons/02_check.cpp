#include "lessons/exercises/02.hpp"

#include "energy/densities.hpp"
#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(observed_order, eta_gradient_2d, eta_gradient_3d, eta_second_2d, second_of_deviation, product,
        quotient, root, eta_delta);

template <int n>
Mat<n> moved(const Mat<n>& F, double h, const Mat<n>& H) {
    Mat<n> sum;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum[i][j] = F[i][j] + h * H[i][j];
    return sum;
}

template <int n>
double inner(const Mat<n>& A, const Mat<n>& B) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += A[i][j] * B[i][j];
    return sum;
}

const Mat<2> F2 = {{{1, 0.3}, {-0.2, 0.6}}}, H2 = {{{0.4, -0.5}, {0.8, 0.7}}};
const Mat<3> F3 = {{{1, 0.2, 0}, {-0.3, 0.8, 0.4}, {0.1, -0.2, 1.3}}},
             H3 = {{{0.3, -1, 0.2}, {0.5, 0.1, 0}, {1, 0.7, -0.4}}};

double rounded(double order) { return std::round(100 * order) / 100; }  // for messages

// The order of the first-order Taylor polynomial of eta along H.
template <int n>
double order_of_gradient(const Mat<n>& F, const Mat<n>& H, const Mat<n>& gradient) {
    return order_of(
        [&](double h) {
            return std::abs(distortion<n>(moved<n>(F, h, H), 0.0) - distortion<n>(F, 0.0) -
                            h * inner<n>(gradient, H));
        },
        1e-2, 5);
}

std::string hint_2d(const Mat<2>& gradient) {
    const double D = determinant(F2), S = frobenius_squared<2>(F2);
    const Mat<2> C = cofactor(F2), T = transpose<2>(C);
    const auto is = [&](double a, double b, const Mat<2>& of_C) {
        double error = 0;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) error += std::abs(gradient[i][j] - a * F2[i][j] - b * of_C[i][j]);
        return error < 1e-9;
    };
    if (is(0, 0, C)) return "; it is zero";
    if (is(1 / D, -S / (2 * D * D), T)) return "; C is transposed: dD/dF_ij is the cofactor of F_ij, C = D F^{-T}";
    if (is(1 / D, S / (2 * D * D), C)) return "; the sign of r' is wrong: r falls as D grows";
    if (is(1 / D, 0, C)) return "; D changes with F too: the term S r' C is missing";
    if (is(0.5 / D, -S / (2 * D * D), C)) return "; a factor 2 is missing: the derivative of |F|^2 is 2 F";
    return "";
}

EXERCISE("2.1", "the order of a Taylor polynomial") {
    const auto f = [](double t) { return std::exp(2 * t); };
    expect_close("the order for exp(2 t) and its slope 2", observed_order(f, 2, 1e-2), 2, 0.05,
                 "log2 of the ratio of the errors at h and h / 2");
    expect_close("the order for exp(2 t) and the wrong slope 3", observed_order(f, 3, 1e-2), 1, 0.05,
                 "a wrong slope must be told by an order of 1");
    const auto g = [](double t) { return std::cos(t) - 5 * t; };
    expect_close("the order for cos t - 5 t and its slope -5", observed_order(g, -5, 1e-2), 2, 0.05,
                 "take the absolute value of the error; it may be negative");
    const auto odd = [](double t) { return t + t * t * t; };
    expect_close("the order for t + t^3 and its slope 1", observed_order(odd, 1, 1e-2), 3, 0.05,
                 "f'' = 0 there, so the error is of third order");
}

EXERCISE("2.2", "the gradient of eta in 2D") {
    const Mat<2> gradient = eta_gradient_2d(F2);
    const double order = order_of_gradient<2>(F2, H2, gradient);
    expect(order > 1.8, "eta(F + h H) - eta(F) - h eta_F : H falls as h^", rounded(order), ", expected h^2",
           hint_2d(gradient));
    const double along_F = inner<2>(gradient, F2);
    expect_close("eta_F : F", along_F, 0, 1e-12, "eta does not change with the size of F");
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            Mat<2> E{};
            E[i][j] = 1;
            const double of_entry = order_of_gradient<2>(F2, E, gradient);
            expect(of_entry > 1.8, "entry ", i + 1, " ", j + 1, " of eta_F is wrong: the order is ", rounded(of_entry),
                   ", expected 2");
        }
}

EXERCISE("2.3", "the gradient of eta in 3D") {
    const Mat<3> gradient = eta_gradient_3d(F3), expected = density_gradient<3>(F3, 0.0, Power{Shape(), true});
    const double f1 = 2 * (distortion<3>(F3, 0.0) - 1), order = order_of_gradient<3>(F3, H3, gradient);
    const double along_F = inner<3>(gradient, F3);
    expect(std::abs(along_F) < 1e-12, "eta_F : F is ", along_F,
           ", expected 0, because size does not matter: check the power of D, r = 1 / (3 D^{2/3})");
    expect(order > 1.8, "eta(F + h H) - eta(F) - h eta_F : H falls as h^", rounded(order), ", expected h^2");
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            expect_close(concat("entry ", i + 1, " ", j + 1, " of eta_F"), gradient[i][j], expected[i][j] / f1, 1e-10);
}

EXERCISE("2.4", "the second derivative of eta") {
    const double eta = distortion<2>(F2, 0.0);
    const auto gradient = [](const Mat<2>& F) {
        Mat<2> P = density_gradient<2>(F, 0.0, Power{Shape(), false});
        for (auto& row : P)
            for (double& entry : row) entry /= 2 * distortion<2>(F, 0.0);
        return P;
    };
    const Mat<2> K = {{{0.1, 1}, {-0.6, 0.2}}};
    const double H_K = inner<2>(H2, eta_second_2d(F2, K)), K_H = inner<2>(K, eta_second_2d(F2, H2));
    expect_close(
        "H : eta_FF K", H_K, K_H, 1e-12,
        "a second derivative is symmetric, K : eta_FF H = H : eta_FF K; is one of the two mixed terms missing?");
    const double order = order_of(
        [&](double h) {
            return std::abs(distortion<2>(moved<2>(F2, h, H2), 0.0) - eta - h * inner<2>(gradient(F2), H2) -
                            0.5 * h * h * inner<2>(H2, eta_second_2d(F2, H2)));
        },
        1e-2, 5);
    expect(order > 2.8, "eta(F + h H) less its second-order Taylor polynomial falls as h^", rounded(order),
           ", expected h^3", K_H == 0 ? "; eta_FF H is zero" : "");
    const Mat<2> along_F = eta_second_2d(F2, F2), eta_F = gradient(F2);
    expect_close("eta_FF F + eta_F, entry 1 2,", along_F[0][1] + eta_F[0][1], 0, 1e-12, "eta_F(s F) = eta_F(F) / s");
    for (const Mat<2>& direction : {K, H2})
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                const double h = 1e-4;
                const double difference =
                    (gradient(moved<2>(F2, h, direction))[i][j] - gradient(moved<2>(F2, -h, direction))[i][j]) /
                    (2 * h);
                expect_close(concat("entry ", i + 1, " ", j + 1, " of eta_FF H"), eta_second_2d(F2, direction)[i][j],
                             difference, 1e-6, "compared with differences of eta_F");
            }
}

EXERCISE("2.5", "the second derivative of (eta - 1)^2") {
    const Mat<2> G = {{{1, 2}, {3, -1}}}, GH = {{{0.5, -1}, {2, 4}}};  // any numbers will do
    const double slope = inner<2>(G, H2);
    const Mat<2> at_one = second_of_deviation(1, {}, GH, H2);
    expect_close("at eta = 1, eta_F = 0, entry 1 1", at_one[0][0], 0, 1e-12,
                 "there the second derivative of (eta - 1)^2 vanishes");
    for (const double eta : {1.0, 1.5, 4.0}) {
        const Mat<2> second = second_of_deviation(eta, G, GH, H2);
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) {
                const double outer = 2 * slope * G[i][j], inner = 2 * (eta - 1) * GH[i][j];
                const std::string what = concat("entry ", i + 1, " ", j + 1, " at eta = ", eta);
                expect(std::abs(second[i][j] - inner) > 1e-9 || outer == inner, what,
                       " lacks the term f'' (eta_F : H) eta_F of the chain rule");
                expect_close(what, second[i][j], outer + inner, 1e-12, "f'' (eta_F : H) eta_F + f' eta_FF H");
            }
    }
}

// Each part of a number; `hint`: of what a wrong one shows.
void expect_parts(const std::string& what, const Hyper& found, const Hyper& expected, const char* hint) {
    const std::pair<const char*, double Hyper::*> parts[] = {
        {"the value", &Hyper::value}, {"the part e1", &Hyper::one}, {"the part e2", &Hyper::two},
        {"the part e1 e2", &Hyper::both}};
    for (const auto& [name, part] : parts)
        expect(std::abs(found.*part - expected.*part) <= 1e-10 * std::abs(expected.*part), name, " of ", what, " is ",
               found.*part, ", expected ", expected.*part, ": ", hint);
}

// By hand: with r = sqrt(D^2 + 4 delta^2), sigma' = sigma / r and sigma'' = 2 delta^2 / r^3.
Hyper eta_delta_by_hand(const Mat<2>& F, const Mat<2>& H, const Mat<2>& K, double delta) {
    const double D = determinant(F), S = frobenius_squared<2>(F), r = std::sqrt(D * D + 4 * delta * delta);
    const double s = D > 0 ? (D + r) / 2 : 2 * delta * delta / (r - D);
    const double s1 = s / r, s2 = 2 * delta * delta / (r * r * r);
    const double D_H = inner<2>(cofactor(F), H), D_K = inner<2>(cofactor(F), K), S_H = 2 * inner<2>(F, H),
                 S_K = 2 * inner<2>(F, K), s_H = s1 * D_H, s_K = s1 * D_K,
                 s_HK = s2 * D_H * D_K + s1 * inner<2>(cofactor(H), K);
    return {S / (2 * s), (S_H - S * s_H / s) / (2 * s), (S_K - S * s_K / s) / (2 * s),
            (inner<2>(H, K) - (S_H * s_K + S_K * s_H + S * s_HK) / (2 * s) + S * s_H * s_K / (s * s)) / s};
}

EXERCISE("2.6", "an hour: derivatives without formulas") {
    const Hyper a = {2, 3, 5, 7}, b = {11, 13, 17, 19};
    expect_parts("(2, 3, 5, 7) times (11, 13, 17, 19)", product(a, b), {22, 59, 89, 231},
                 "multiply out: e1 of one times e2 of the other is e1 e2 too, e1 times e1 is 0");
    expect_parts("(2, 3, 5, 7) times (11, 13, 17, 19), divided by (11, 13, 17, 19),", quotient(product(a, b), b), a,
                 "a quotient is the number whose product with the divisor is the dividend; f = 1 / x has an f'' too");
    expect_parts("the root of (2, 3, 5, 7), squared,", product(root(a), root(a)), a,
                 "f(x) = f + f' one e1 + f' two e2 + (f' both + f'' one two) e1 e2, and f'' = -1 / (4 x^{3/2})");
    const Mat<2> K = {{{0.1, 1}, {-0.6, 0.2}}};
    for (const Mat<2>& F : {F2, Mat<2>{{{1, 0.3}, {0.5, -0.8}}}, Mat<2>{{{0.3, 0.9}, {0.1, 0.3}}}})
        for (const double delta : {1.0, 0.1, 1e-6}) {
            const Hyper expected = eta_delta_by_hand(F, H2, K, delta), found = eta_delta(F, H2, K, delta);
            const double D = determinant(F);
            const bool digits = D < -0.1 && delta < 1e-3;  // of D + r none are left
            if (std::abs(D) < 0.1 && delta < 1e-3) continue;
            expect_parts(concat("eta_delta where det F = ", D, ", delta = ", delta), found, expected,
                         digits ? "det + sqrt(det^2 + 4 delta^2) cancels where det < 0, in all four parts: as in 1.4"
                                : "|F|^2 / (2 sigma_delta) of F + e1 H + e2 K in these numbers from the start");
        }
}

}  // namespace
}  // namespace almesh::lessons
