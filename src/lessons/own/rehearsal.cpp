// Before the run: what each part has to do that the others rely on, first of each alone, then of the energy with its
// derivatives made of them, against differences. Not the checks of the exercises once more: these ask for all that an
// exercise says, here it is what this solver needs.
#include <cmath>
#include <cstdio>

#include "base/text.hpp"
#include "lessons/own/parts.hpp"

namespace almesh::own {
namespace {

template <class Text>
const Text& shown(const Text& text) { return text; }

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

template <class... Text>
void need(const char* part, bool holds, const Text&... text) {
    if (!holds) throw PartFails(part, concat(shown(text)...));
}

bool near(double value, double expected, double tolerance) {  // not for nan
    return std::abs(value - expected) <= tolerance * std::max(1.0, std::abs(expected));
}

Mat<2> sum(Mat<2> A, double t, const Mat<2>& B) {
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) A[i][j] += t * B[i][j];
    return A;
}

Vector sum(Vector x, double t, const Vector& d) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * d[i];
    return x;
}

double product_of(const Mat<2>& A, const Mat<2>& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}

const Mat<2> F_0 = {{{1.4, 0.3}, {-0.2, 0.8}}}, H_0 = {{{0.3, -1}, {0.7, 0.5}}};

void try_derivatives() {
    const double D = determinant(F_0), S = product_of(F_0, F_0);
    need("distortion", near(eta({{{1, 0}, {0, 1}}}), 1, 1e-14), "eta of the identity is ", eta({{{1, 0}, {0, 1}}}),
         ", expected 1");
    need("distortion", near(eta(F_0), S / (2 * D), 1e-13), "eta of (1.4, 0.3; -0.2, 0.8) is ", eta(F_0), ", expected ",
         S / (2 * D), ": 1.4 with delta = 0 and det F > 0 is |F|^2 / (2 det F)");
    const double h = 1e-6, slope = (eta(sum(F_0, h, H_0)) - eta(sum(F_0, -h, H_0))) / (2 * h);
    const double found = product_of(eta_F(F_0), H_0);
    need("gradient", near(found, slope, 1e-7), "eta_F : H is ", found, " where eta changes by ", slope, " along H");
    const auto W_F = [](const Mat<2>& F) { return sum(Mat<2>{}, 2 * eta(F), eta_F(F)); };
    const Mat<2> ahead = W_F(sum(F_0, h, H_0)), behind = W_F(sum(F_0, -h, H_0)), second = W_FF(F_0, H_0);
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            const double change = (ahead[i][j] - behind[i][j]) / (2 * h);
            need("hessian", near(second[i][j], change, 1e-6), "entry ", i + 1, " ", j + 1, " of W_FF H is ",
                 second[i][j], " where W_F changes by ", change, " along H, W = eta^2: 2.4, or 2.5 with eta + 1");
        }
}

void try_projection() {
    const Mat<2> part = positive_part({{{2, 0}, {0, -1}}});
    need("projection", near(part[0][0], 2, 1e-13) && near(part[1][1], 0, 1e-13) && near(part[0][1], 0, 1e-13),
         "of diag(2, -1) it leaves diag(", part[0][0], ", ", part[1][1], "), expected diag(2, 0)");
    const Mat<2> full = positive_part({{{1, 2}, {2, 1}}});
    need("projection", near(full[0][0], 1.5, 1e-13) && near(full[0][1], 1.5, 1e-13) && near(full[1][1], 1.5, 1e-13),
         "of (1 2; 2 1) it leaves (", full[0][0], " ", full[0][1], "; ", full[1][0], " ", full[1][1],
         "), expected (1.5 1.5; 1.5 1.5)");
    const Mat<4> A = second_derivative(F_0, true);  // v'Av >= 0
    for (int k = 0; k < 40; ++k) {
        Mat<2> v;
        for (int i = 0; i < 4; ++i) v[i / 2][i % 2] = std::sin(1.0 + 7 * i + 3 * k * (i + 1));
        double value = 0;
        for (int i = 0; i < 16; ++i) value += v[i / 8][i / 4 % 2] * A[i / 4][i % 4] * v[i / 2 % 2][i % 2];
        need("projection", value >= -1e-12, "the projected W_FF is not positive semidefinite: v'Av = ", value);
    }
}

void try_line_search(const Problem& problem) {
    for (const bool shrinks : {true, false}) {  // all areas times (1 - 2 t) (1 + t), and times (1 + 2 t) (1 - t)
        Vector d = problem.mesh.x;
        for (std::size_t i = 0; i < d.size(); i += 2) (shrinks ? d[i] : d[i + 1]) *= -1, d[i] *= 2;
        const double until = valid_until(problem, problem.mesh.x, d), expected = shrinks ? 0.5 : 1;
        need("line_search", until > 0 && until <= expected + 1e-9, "all triangles invert at t = ", expected,
             ", 4.2 sees the first at ", until);
    }
    for (const double limit : {2.0, 0.6, 0.2, 0.01}) {  // lower than Armijo's line up to the limit
        const auto phi = [limit, calls = 0](double t) mutable {
            if (++calls > 200) throw PartFails("line_search", "it asks for the energy more than 200 times");
            return t == 0 ? 0 : t < limit ? -t * (1 - t / 2 / limit) : INFINITY;
        };
        const double t = accepted_step(phi), expected = std::min(1.0, std::exp2(std::floor(std::log2(limit))));
        need("line_search", t == expected || (limit == 2 && t == 2), "with energies that are infinite from t = ", limit,
             " on it takes t = ", t, ", expected ", expected, ": the first of 1, 1/2, 1/4, ... (4.5)");
    }
    const double t = accepted_step([](double s) { return s == 1 ? -1e-5 : s * (s - 1); });
    need("line_search", t > 0 && t < 1, "where the energy falls by 1e-5 of what the slope promises it takes t = ", t,
         ", expected less than 1: Armijo asks for 1e-4 (4.5)");
}

void try_trace(const Problem& problem) {
    const double edges = static_cast<double>(problem.edges.size());
    const Vector of_ones = mass_times(problem, Vector(problem.mesh.x.size(), 1.0));
    need("trace", of_ones.size() == problem.mesh.x.size(), "M u has ", of_ones.size(), " numbers, expected ",
         problem.mesh.x.size());
    double total = 0;
    for (std::size_t i = 0; i < of_ones.size(); i += 2) total += of_ones[i];
    need("trace", near(total, edges, 1e-12), "the entries of M add up to ", total, ", expected ", edges,
         ", one for each edge (7.2 times |1|)");
    Vector unit(of_ones.size(), 0.0);
    unit[2 * problem.on[0]] = 1;
    const double diagonal = mass_times(problem, unit)[2 * problem.on[0]];
    need("trace", near(diagonal, 2.0 / 3, 1e-12), "a diagonal entry of M is ", diagonal, ", expected 2/3: two edges");
}

void try_update() {
    const double found = updated(3, 100, 0.01);
    need("update", near(found, 2, 1e-12), "lambda = 3, mu = 100, c = 0.01 become ", found,
         ", expected lambda - mu c = 2: 7.1 with c_2 = 0");
}

void try_schedule() {
    const Constants constants;
    const auto ends = [&](double c_squared, double g) { return !goes_on(c_squared, g, constants); };
    need("schedule", !ends(1, 0) && !ends(0, 1) && !ends(1, 1) && ends(0, 0), "8.3 goes on unless both tests hold: ",
         "|c|^2 large ", ends(1, 0) ? "ends" : "goes on", ", |grad| large ", ends(0, 1) ? "ends" : "goes on",
         ", both small ", ends(0, 0) ? "ends" : "goes on");
    const Settings first = {10, 100, constants.omega0, constants.epsilon0};
    const Settings raised = next(first, 1, 100, constants), kept = next(first, 0, 100, constants);
    need("schedule", !raised.updates_lambda && kept.updates_lambda,
         "8.4 updates lambda where |c|^2 <= epsilon, and only there");
    need("schedule", near(raised.mu, 1e4, 1e-12) && near(kept.mu, 100, 1e-12), "8.4 goes from mu = 100 to ",
         raised.mu, " and ", kept.mu, ", expected 10000 where |c|^2 is too large and 100 else");
    for (const Settings& s : {raised, kept})
        need("schedule", s.omega < first.omega && s.epsilon < first.epsilon, "8.4 does not tighten: omega ",
             first.omega, " becomes ", s.omega, ", epsilon ", first.epsilon, " becomes ", s.epsilon);
}

void try_certificate() {
    const Corners p = {{{0, 0}, {1, 0}, {0, 1}}}, beyond = {{{0, 0}, {1, 0}, {0, -1}}};
    const Corners opposite = {{{1, 1}, {0, 1}, {1, 0}}};  // turned by 180 degrees: all in one point half way
    need("certificate", valid_on_the_way(p, p), "a triangle that stays where it is is not certified");
    need("certificate", !valid_on_the_way(p, beyond), "a triangle that is inverted at the end is certified");
    const double c = std::cos(2.5), s = std::sin(2.5);  // by 143 degrees: small half way, but not inverted
    need("certificate", valid_on_the_way(p, {{{0, 0}, {c, s}, {-s, c}}}), "a triangle that turns by 143 degrees is ",
         "not certified: its middle coefficient is negative, which proves nothing; halve");
    need("certificate", !valid_on_the_way(p, opposite), "a triangle that shrinks to a point on the way is certified: ",
         "sound ends prove nothing");
}

// A positive definite system with a known solution, and one that is not positive definite.
void try_solver(const Problem& problem, const Lagrangian& L) {
    BlockCsr H = L.hessian(problem.mesh.x, true);
    Vector x(problem.mesh.x.size()), b(x.size()), found;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + 3.0 * static_cast<double>(i));
    multiply(H, x.data(), b.data());
    need("solver", solve(H, b, found), "it takes a positive definite matrix for one that is not");
    const Vector error = sum(found, -1, x);
    const double relative = std::sqrt(dot(error, error) / dot(x, x));
    need("solver", relative < 1e-6, "the solution of a system is off by ", relative, " of itself");
    for (double& entry : H.value) entry = -entry;
    need("solver", !solve(H, b, found), "it solves a system with -H, which is not positive definite");
}

// Differences of the energy, along a direction, against its derivatives. L has multipliers and a penalty.
void try_assembly(const Problem& problem, const Lagrangian& L) {
    for (int e = 0; e < static_cast<int>(problem.triangles.size()); ++e) {
        const Mat<2> F = L.F(e, problem.mesh.x);
        need("assembly", near(F[0][0], 1, 1e-9) && near(F[1][1], 1, 1e-9) && near(F[0][1], 0, 1e-9) &&
                             near(F[1][0], 0, 1e-9),
             "F of triangle ", e, " at rest is (", F[0][0], ", ", F[0][1], "; ", F[1][0], ", ", F[1][1],
             "), expected the identity: hat_gradients, 3.1");
    }
    Vector x = problem.mesh.x, d(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        d[i] = 0.01 * std::cos(5.0 + 2.0 * static_cast<double>(i));
        x[i] += 0.01 * std::sin(3.0 * static_cast<double>(i));
    }
    const double h = 1e-4, slope = (L.value(sum(x, h, d)) - L.value(sum(x, -h, d))) / (2 * h);
    const Vector g = L.gradient(x);
    need("assembly", g.size() == x.size(), "the gradient has ", g.size(), " numbers, expected ", x.size(), ": 3.3");
    need("assembly", near(dot(g, d), slope, 1e-5), "g.d is ", dot(g, d), " where the energy changes by ", slope,
         " along d: assemble, 3.3");
    const Vector change = sum(L.gradient(sum(x, h, d)), -1, L.gradient(sum(x, -h, d)));
    Vector Hd(x.size());
    multiply(L.hessian(x, false), d.data(), Hd.data());
    const Vector error = sum(Hd, -1 / (2 * h), change);
    const double relative = std::sqrt(dot(error, error) / dot(Hd, Hd));
    need("assembly", relative < 1e-5, "H d differs from the change of the gradient along d by ", relative,
         " of itself: add_to, 3.4");
}

}  // namespace

void rehearse(const Problem& problem) {
    try_derivatives();
    try_projection();
    try_line_search(problem);
    try_trace(problem);
    try_update();
    try_schedule();
    try_certificate();
    Lagrangian L(problem);
    L.mu = 1000;
    for (std::size_t i = 0; i < L.lambda.size(); ++i) L.lambda[i] = std::sin(static_cast<double>(i));
    try_assembly(problem, L);
    try_solver(problem, L);
}

}  // namespace almesh::own
