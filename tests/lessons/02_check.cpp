#include "lessons/exercises/02.hpp"

#include "energy/densities.hpp"
#include "lessons/exercise.hpp"
#include "lessons/random_inputs.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(observed_order, eta_gradient_2d, gradient_by_ideal, eta_gradient_3d, sized_gradient_3d, eta_second_2d,
        falling_curvature, second_of_deviation, fourth_order, product, quotient, root, eta_delta);

template <int n>
Mat<n> sum(double a, const Mat<n>& A, double b, const Mat<n>& B) {
    Mat<n> C;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) C[i][j] = a * A[i][j] + b * B[i][j];
    return C;
}

template <int n>
double product_of(const Mat<n>& A, const Mat<n>& B) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum += A[i][j] * B[i][j];
    return sum;
}

// eta_F = 2 r F + S r' C
template <int n>
Mat<n> gradient_of_eta(const Mat<n>& F) {
    const double D = determinant(F), S = frobenius_squared<n>(F), r = n == 2 ? 1 / (2 * D) : 1 / (3 * std::cbrt(D * D));
    return sum<n>(2 * r, F, -2 * r * S / (n * D), cofactor(F));
}

// eta_FF H = 2 r H + 2 r' (C : H) F + 2 r' (F : H) C + S r'' (C : H) C + S r' C_F H
Mat<2> second_of_eta(const Mat<2>& F, const Mat<2>& H) {
    const Mat<2> C = cofactor(F);
    const double D = determinant(F), S = frobenius_squared<2>(F), C_H = product_of<2>(C, H), F_H = product_of<2>(F, H);
    const Mat<2> of_F = sum<2>(1 / D, H, -C_H / (D * D), F);
    const Mat<2> of_C = sum<2>((S * C_H / D - F_H) / (D * D), C, -S / (2 * D * D), cofactor(H));
    return sum<2>(1, of_F, 1, of_C);
}

// Any direction; its entries are at most 1.
template <int n>
Mat<n> random_direction() {
    Mat<n> H;
    for (auto& row : H)
        for (double& entry : row) entry = random_inputs().uniform(-1, 1);
    return H;
}

// Each entry, to 1e-9 of the largest.
template <int n>
void compare(const std::string& what, const Mat<n>& found, const Mat<n>& expected, const std::string& hint = "") {
    double largest = 0;
    for (const auto& row : expected)
        for (const double entry : row) largest = std::max(largest, std::abs(entry));
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            expect(std::abs(found[i][j] - expected[i][j]) <= 1e-9 * largest, "entry ", i + 1, " ", j + 1, " of ", what,
                   " is ", found[i][j], ", expected ", expected[i][j], hint.empty() ? "" : ": ", hint);
}

const Mat<2> F2 = {{{1, 0.3}, {-0.2, 0.6}}}, H2 = {{{0.4, -0.5}, {0.8, 0.7}}};

double rounded(double order) { return std::round(100 * order) / 100; }  // for messages

// The order of the first-order Taylor polynomial of eta along H.
template <int n>
double order_of_gradient(const Mat<n>& F, const Mat<n>& H, const Mat<n>& gradient) {
    return order_of(
        [&](double h) {
            return std::abs(distortion<n>(sum<n>(1, F, h, H), 0.0) - distortion<n>(F, 0.0) -
                            h * product_of<n>(gradient, H));
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
    Random& random = random_inputs();
    const auto f = [](double t) { return std::exp(2 * t); };
    expect_close("the order for exp(2 t) and its slope 2", observed_order(f, 2, 1e-2), 2, 0.05,
                 "how does the ratio of the errors at h and h / 2 tell it?");
    expect_close("the order for exp(2 t) and the wrong slope 3", observed_order(f, 3, 1e-2), 1, 0.05,
                 "a wrong slope must be told by an order of 1");
    for (int i = 0; i < 8; ++i) {
        const double p = i < 3 ? 2 + i % 2 : random.uniform(1.2, 4), h = random.uniform(0.1, 1);
        const double a = random.uniform(-2, 2), b = random.uniform(-2, 2), c = random.scale(0.5, 3) * (i % 2 ? 1 : -1);
        const double order = observed_order([=](double t) { return a + b * t + c * std::pow(t, p); }, b, h);
        expect_close(concat("the order for ", in_short(a), " + ", in_short(b), " t + ", in_short(c), " t^", in_short(p),
                            " and its slope, h = ", in_short(h), ","),
                     order, p, 1e-6, "the error may be negative, f(0) need not be 0, the order need not be whole");
    }
    for (int i = 0; i < 4; ++i) {
        const double k = random.uniform(0.5, 2), slope = random.uniform(-1, 3) * k, h = random.uniform(0.3, 1);
        const auto error = [=](double t) { return std::abs(std::exp(k * t) - 1 - t * slope); };
        if (error(h) < 0.01 || error(h / 2) < 0.01) continue;
        expect_close(concat("the order for exp(", in_short(k), " t) and the slope ", in_short(slope), ", h = ",
                            in_short(h), ","),
                     observed_order([=](double t) { return std::exp(k * t); }, slope, h),
                     std::log2(error(h) / error(h / 2)), 1e-9, "from the errors at this h and at h / 2");
    }
}

// Random F, det F > 0: of the size 1, then of others; the last ones nearly flat.
template <int n>
std::vector<Mat<n>> random_matrices() {
    Random& random = random_inputs();
    std::vector<Mat<n>> all;
    for (int k = 0; k < 12; ++k) {
        Vec<n> s;
        for (double& entry : s) entry = random.scale(0.3, 3);
        if (k >= 9) s[0] = random.scale(1e-3, 1e-2);
        const double size = k < 4 || k >= 9 ? 1 : k == 4 ? 1e-6 : k == 5 ? 1e6 : random.scale(1e-6, 1e6);
        all.push_back(scaled<n>(size, random_with<n>(s)));
    }
    return all;
}

EXERCISE("2.2", "the gradient of eta in 2D") {
    const Mat<2> gradient = eta_gradient_2d(F2);
    const double order = order_of_gradient<2>(F2, H2, gradient);
    expect(order > 1.8, "eta(F + h H) - eta(F) - h eta_F : H falls as h^", rounded(order), ", expected h^2",
           hint_2d(gradient));
    const double along_F = product_of<2>(gradient, F2);
    expect_close("eta_F : F", along_F, 0, 1e-12, "eta does not change with the size of F");
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            Mat<2> E{};
            E[i][j] = 1;
            const double of_entry = order_of_gradient<2>(F2, E, gradient);
            expect(of_entry > 1.8, "entry ", i + 1, " ", j + 1, " of eta_F is wrong: the order is ", rounded(of_entry),
                   ", expected 2");
        }
    for (const Mat<2>& F : random_matrices<2>())
        compare<2>("eta_F of " + shown<2>(F), eta_gradient_2d(F), gradient_of_eta<2>(F));
    compare<2>("eta_F of a rotation by 180 degrees", sum<2>(1, eta_gradient_2d({{{-1, 0}, {0, -1}}}), 1, turn(0)),
               turn(0), "it is zero where eta is 1");
    for (int k = 0; k < 8; ++k) {
        const Mat<2> A = edges(random_triangle(k < 3 ? 1 : random_inputs().scale(1e-3, 1e3))),
                     B = edges(random_triangle(k < 3 ? 1 : random_inputs().scale(1e-3, 1e3)));
        const Mat<2> A_inverse = inverse<2>(A), F = multiply<2>(B, A_inverse);
        const Mat<2> transported = multiply<2>(multiply<2>(transpose<2>(F), gradient_of_eta<2>(F)),
                                               transpose<2>(A_inverse));
        compare<2>("the gradient by A where A = " + shown<2>(A) + ", B = " + shown<2>(B), gradient_by_ideal(A, B),
                   scaled<2>(-1, transported), "what is dF where A changes by dA? or: is eta(A B^-1) another number?");
    }
}

EXERCISE("2.3", "the gradient of eta in 3D") {
    const Mat<3> F3 = {{{1, 0.2, 0}, {-0.3, 0.8, 0.4}, {0.1, -0.2, 1.3}}};
    const Mat<3> H3 = {{{0.3, -1, 0.2}, {0.5, 0.1, 0}, {1, 0.7, -0.4}}}, gradient = eta_gradient_3d(F3);
    const double order = order_of_gradient<3>(F3, H3, gradient), along_F = product_of<3>(gradient, F3);
    expect(std::abs(along_F) < 1e-12, "eta_F : F is ", along_F,
           ", expected 0, because size does not matter: check the power of D");
    expect(order > 1.8, "eta(F + h H) - eta(F) - h eta_F : H falls as h^", rounded(order), ", expected h^2");
    for (const Mat<3>& F : random_matrices<3>())
        compare<3>("eta_F of " + shown<3>(F), eta_gradient_3d(F), gradient_of_eta<3>(F));
    const char* const of_sized = "the gradient of eta (D + 1/D) / 2 at ";
    for (int k = 0; k < 8; ++k) {
        const double size = random_inputs().scale(0.2, 5);
        const Mat<3> F = random_with<3>({size, size * random_inputs().scale(0.5, 2), k < 2 ? size : 1.2});
        const double D = determinant(F), factor = (D + 1 / D) / 2;
        const double eta = frobenius_squared<3>(F) / (3 * std::cbrt(D * D));
        compare<3>(of_sized + shown<3>(F), sized_gradient_3d(F),
                   sum<3>(factor, gradient_of_eta<3>(F), eta * (1 - 1 / (D * D)) / 2, cofactor(F)),
                   "a product of two functions of F, the second one of D alone");
    }
    const Mat<3> R = random_rotation<3>();
    compare<3>(of_sized + shown<3>(R) + ", plus that rotation,", sum<3>(1, sized_gradient_3d(R), 1, R), R,
               "it is least for rotations");
}

EXERCISE("2.4", "the second derivative of eta") {
    const Mat<2> K2 = {{{0.1, 1}, {-0.6, 0.2}}};
    const double H_K = product_of<2>(H2, eta_second_2d(F2, K2)), K_H = product_of<2>(K2, eta_second_2d(F2, H2));
    expect_close(
        "H : eta_FF K", H_K, K_H, 1e-12,
        "a second derivative is symmetric, K : eta_FF H = H : eta_FF K; is one of the two mixed terms missing?");
    const double slope = product_of<2>(gradient_of_eta<2>(F2), H2), half = product_of<2>(H2, eta_second_2d(F2, H2)) / 2;
    const double order = order_of(
        [&](double h) {
            return std::abs(distortion<2>(sum<2>(1, F2, h, H2), 0.0) - distortion<2>(F2, 0.0) - h * slope -
                            h * h * half);
        },
        1e-2, 5);
    expect(order > 2.8, "eta(F + h H) less its second-order Taylor polynomial falls as h^", rounded(order),
           ", expected h^3", half == 0 ? "; eta_FF H is zero" : "");
    for (const Mat<2>& F : random_matrices<2>()) {
        compare<2>("eta_FF F at F = " + shown<2>(F), eta_second_2d(F, F), scaled<2>(-1, gradient_of_eta<2>(F)),
                   "eta_F(s F) = eta_F(F) / s");
        const Mat<2> H = random_direction<2>();
        compare<2>("eta_FF H at F = " + shown<2>(F) + ", H = " + shown<2>(H), eta_second_2d(F, H), second_of_eta(F, H));
        if (frobenius_squared<2>(F) < 2.02 * determinant(F)) continue;
        const Mat<2> fall = falling_curvature(F);
        const double of_fall = product_of<2>(fall, second_of_eta(F, fall)), squared = frobenius_squared<2>(fall);
        expect(squared > 0 && std::isfinite(squared), "the direction of negative curvature at F = ", shown<2>(F),
               " is ", shown<2>(fall), ", expected one with a length");
        expect(of_fall < 0, "H : eta_FF H is ", of_fall, " at F = ", shown<2>(F), " for your H = ", shown<2>(fall),
               ", expected a negative number: along F there is no curvature; how far from F towards eta_F may H go?");
    }
}

EXERCISE("2.5", "the second derivative of (eta - 1)^2") {
    Random& random = random_inputs();
    for (int k = 0; k < 10; ++k) {
        const double eta = k == 0 ? 1 : k < 5 ? random.uniform(1, 3) : 1 + random.scale(1e-3, 1e3);
        const Mat<2> G = random_direction<2>(), GH = random_direction<2>(), H = random_direction<2>();
        const Mat<2> second = second_of_deviation(eta, G, GH, H);
        const Mat<2> inner = scaled<2>(2 * (eta - 1), GH), expected = sum<2>(2 * product_of<2>(G, H), G, 1, inner);
        double without = 0;  // f''
        for (int i = 0; i < 4; ++i) without += std::abs(second[i / 2][i % 2] - inner[i / 2][i % 2]);
        expect(without > 1e-12, "at eta = ", eta, " it is f' eta_FF H alone: the chain rule has one more term");
        compare<2>(concat("W_FF H at eta = ", in_short(eta), ", eta_F = ", shown<2>(G), ", eta_FF H = ", shown<2>(GH),
                          ", H = ", shown<2>(H)),
                   second, expected, "the chain rule twice, f = (eta - 1)^2");
    }
    const Mat<2> at_one = second_of_deviation(1, {}, random_direction<2>(), H2);
    expect(frobenius_squared<2>(at_one) < 1e-24, "at eta = 1, eta_F = 0, entry 1 1 is ", at_one[0][0],
           ", expected 0: there the second derivative of (eta - 1)^2 vanishes");
    for (int k = 0; k < 10; ++k) {
        Mat<2> H = scaled<2>(random.scale(0.1, 10), random_direction<2>());
        if (k >= 8) H[1] = {-H[0][1], H[0][0]};  // a rotation and a scaling
        const double stretch = H[0][0] - H[1][1], shear = H[0][1] + H[1][0];
        const double expected = std::pow(stretch * stretch + shear * shear, 2) / 4, found = fourth_order(H);
        expect(std::abs(found - expected) <= 1e-10 * std::pow(frobenius_squared<2>(H), 2), "c for H = ", shown<2>(H),
               " is ", found, ", expected ", expected,
               ": eta(I + h H) - 1 begins with h^2; which number is its coefficient?");
    }
}

// Each part of a number, to 1e-10 of what it is a sum of; `hint`: of what a wrong one shows.
void expect_parts(const std::string& what, const Hyper& found, const Hyper& expected, const Hyper& size,
                  const char* hint) {
    const std::pair<const char*, double Hyper::*> parts[] = {
        {"the value", &Hyper::value}, {"the part e1", &Hyper::one}, {"the part e2", &Hyper::two},
        {"the part e1 e2", &Hyper::both}};
    for (const auto& [name, part] : parts)
        expect(std::abs(found.*part - expected.*part) <= 1e-10 * size.*part, name, " of ", what, " is ", found.*part,
               ", expected ", expected.*part, ": ", hint);
}

Hyper random_number() {
    const auto any = [] { return random_inputs().uniform(-5, 5); };
    const double value = random_inputs().scale(0.3, 30);
    return {value, any(), any(), any()};
}

std::string in_parts(const Hyper& a) {
    return concat("(", listed(std::array<double, 4>{a.value, a.one, a.two, a.both}), ")");
}

void check_numbers() {
    const Hyper size = {1e2, 1e4, 1e4, 1e6};  // of quotients: powers of the divisor, which is not below 0.3
    for (int k = 0; k < 6; ++k) {
        Hyper a = k == 0 ? Hyper{2, 3, 5, 7} : random_number(), b = k == 0 ? Hyper{11, 13, 17, 19} : random_number();
        if (k % 2) b.value = -b.value;
        const Hyper ab = {a.value * b.value, a.value * b.one + a.one * b.value, a.value * b.two + a.two * b.value,
                          a.value * b.both + a.one * b.two + a.two * b.one + a.both * b.value};
        expect_parts(concat(in_parts(a), " times ", in_parts(b)), product(a, b), ab, size,
                     "multiply out: e1 of one times e2 of the other is e1 e2 too, e1 times e1 is 0");
        expect_parts(concat(in_parts(ab), " divided by ", in_parts(b)), quotient(ab, b), a, size,
                     "a quotient is the number whose product with the divisor is the dividend; f = 1 / x has an f'' "
                     "too");
        const Hyper squared = {a.value * a.value, 2 * a.value * a.one, 2 * a.value * a.two,
                               2 * a.value * a.both + 2 * a.one * a.two};
        expect_parts(concat("the root of ", in_parts(squared)), root(squared), a, size,
                     "the number whose product with itself it is; the root has an f'' too");
    }
}

struct ByHand {
    Hyper eta, size;  // size: the sums of the absolute values
};

// With r = sqrt(D^2 + 4 delta^2), sigma' = sigma / r and sigma'' = 2 delta^2 / r^3.
ByHand eta_delta_by_hand(const Mat<2>& F, const Mat<2>& H, const Mat<2>& K, double delta) {
    const double D = determinant(F), S = frobenius_squared<2>(F), r = std::sqrt(D * D + 4 * delta * delta);
    const double s = D > 0 ? (D + r) / 2 : 2 * delta * delta / (r - D);
    const double s1 = s / r, s2 = 2 * delta * delta / (r * r * r);
    const Mat<2> C = cofactor(F);
    const double D_H = product_of<2>(C, H), D_K = product_of<2>(C, K), D_HK = product_of<2>(cofactor(H), K);
    const double S_H = 2 * product_of<2>(F, H), S_K = 2 * product_of<2>(F, K), H_K = product_of<2>(H, K);
    const double s_H = s1 * D_H, s_K = s1 * D_K;
    const double terms[] = {H_K,
                            -(S_H * s_K) / (2 * s),
                            -(S_K * s_H) / (2 * s),
                            -S * s2 * D_H * D_K / (2 * s),
                            -S * s1 * D_HK / (2 * s),
                            S * s_H * s_K / (s * s)};
    ByHand by_hand = {{S / (2 * s), (S_H - S * s_H / s) / (2 * s), (S_K - S * s_K / s) / (2 * s), 0}, {}};
    for (const double term : terms) by_hand.eta.both += term / s;
    const double f = std::sqrt(S), h = std::sqrt(frobenius_squared<2>(H)), k = std::sqrt(frobenius_squared<2>(K));
    const double of_h = (f * h + S * s1 * f * h / (2 * s)) / s, of_k = (f * k + S * s1 * f * k / (2 * s)) / s;
    by_hand.size = {S / (2 * s), of_h, of_k, 0};
    by_hand.size.both = (h * k + (2 * S * h * k * s1 + S * S * h * k * s2 / 2 + S * h * k * s1 / 2) / s +
                         S * S * h * k * s1 * s1 / (s * s)) / s;
    return by_hand;
}

EXERCISE("2.6", "an hour: derivatives without formulas") {
    check_numbers();
    Random& random = random_inputs();
    for (int k = 0; k < 24; ++k) {
        const Vec<2> s = {random.scale(0.3, 3) * (k % 2 ? 1 : -1), random.scale(0.3, 3)};
        const double delta = k < 4 ? 1 : k < 12 ? random.scale(0.01, 1) : random.scale(1e-7, 1e-3);
        const double two = std::ldexp(1, k % 5);
        const Mat<2> F = k == 10   ? Mat<2>{}
                         : k == 11 ? Mat<2>{{{two, 2 * two}, {-two, -2 * two}}}
                         : k < 20  ? random_with<2>(s)
                                   : random_with<2>({1e-3 * s[0], s[1]});  // k odd: det F < 0, and small
        const Mat<2> H = random_direction<2>(), K = random_direction<2>();
        const auto [expected, size] = eta_delta_by_hand(F, H, K, delta);
        const bool digits = determinant(F) < 0 && delta < 1e-3;  // of D + r few are left
        expect_parts(concat("eta_delta at F = ", shown<2>(F), ", where det F = ", in_short(determinant(F)),
                            ", with delta = ", in_short(delta)),
                     eta_delta(F, H, K, delta), expected, size,
                     digits ? "det + sqrt(det^2 + 4 delta^2) cancels where det < 0, in all four parts: as in 1.4"
                            : "|F|^2 / (2 sigma_delta) of F + e1 H + e2 K in these numbers from the start");
    }
}

}  // namespace
}  // namespace almesh::lessons
