// Each part in two versions: the student's, who calls the answers to exercises, and the library's. BORROWED names the
// parts that are the library's: -DBORROWED='"solver trace"'. What is not chosen is not linked, so that an answer that
// is missing or does not compile stops nobody who has borrowed the part.
#include "lessons/own/parts.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <string_view>

#include "constraint/trace_space.hpp"
#include "energy/distortion_energy.hpp"
#include "lessons/eta_squared.hpp"
#include "lessons/plain_energy.hpp"
#include "linalg/linear_solver.hpp"
#include "method/line_search.hpp"
#include "method/schedule.hpp"

// The answers to each lesson are compiled with a namespace of its own in place of almesh::lessons, so that functions
// with which two of them help themselves may have the same name.
#define lessons lesson_01
#include "lessons/exercises/01.hpp"
#undef lessons
#define lessons lesson_02
#include "lessons/exercises/02.hpp"
#undef lessons
#define lessons lesson_03
#include "lessons/exercises/03.hpp"
#undef lessons
#define lessons lesson_04
#include "lessons/exercises/04.hpp"
#undef lessons
#define lessons lesson_07
#include "lessons/exercises/07.hpp"
#undef lessons
#define lessons lesson_08
#include "lessons/exercises/08.hpp"
#undef lessons
#define lessons lesson_09
#include "lessons/exercises/09.hpp"
#undef lessons
#define lessons lesson_10
#include "lessons/exercises/10.hpp"
#undef lessons

#ifndef BORROWED
#define BORROWED ""
#endif

namespace almesh::own {
namespace {

// Whether the part is the student's.
constexpr bool yours(std::string_view part) {
    std::string_view borrowed = BORROWED;
    while (!borrowed.empty()) {
        const std::size_t end = std::min(borrowed.find(' '), borrowed.size());
        if (borrowed.substr(0, end) == part) return false;
        borrowed.remove_prefix(std::min(end + 1, borrowed.size()));
    }
    return true;
}

// The part that is at work for as long as this object is there; after an exception the one that threw it stays.
class AtWork {
public:
    explicit AtWork(const char* part) : outer_(part_at_work) { part_at_work = part; }
    ~AtWork() {
        if (std::uncaught_exceptions() == exceptions_) part_at_work = outer_;
    }

private:
    const char* outer_;
    int exceptions_ = std::uncaught_exceptions();
};

struct Eta {  // eta itself as a density
    using Measure = Shape;
    double f(double eta) const { return eta; }
    double f1(double) const { return 1; }
    double f2(double) const { return 0; }
};

}  // namespace

const char* volatile part_at_work = "";

double eta(const Mat<2>& F) {
    const AtWork at_work("distortion");
    if (!(determinant(F) > 0)) return std::numeric_limits<double>::infinity();
    if constexpr (yours("distortion")) return lesson_01::eta_regularised(F, 0);  // 1.4
    else return distortion<2>(F, 0);
}

Mat<2> eta_F(const Mat<2>& F) {
    const AtWork at_work("gradient");
    if constexpr (yours("gradient")) return lesson_02::eta_gradient_2d(F);  // 2.2
    else return density_gradient<2>(F, 0, Eta());
}

// 2.5 has (eta - 1)^2: eta^2 is that of an eta that is greater by 1.
Mat<2> W_FF(const Mat<2>& F, const Mat<2>& H) {
    const AtWork at_work("hessian");
    if constexpr (yours("hessian"))
        return lesson_02::second_of_deviation(eta(F) + 1, eta_F(F), lesson_02::eta_second_2d(F, H), H);  // 2.5, 2.4
    else return lessons::W_FF(F, H);
}

// Of the library: the rows of the inverse of the matrix of edges.
Corners hat_gradients(const Corners& y) {
    const AtWork at_work("assembly");
    if constexpr (yours("assembly")) return lesson_03::hat_gradients(y);  // 3.1
    const Mat<2> B = inverse<2>({{{y[1][0] - y[0][0], y[2][0] - y[0][0]}, {y[1][1] - y[0][1], y[2][1] - y[0][1]}}});
    return {Vec<2>{-B[0][0] - B[1][0], -B[0][1] - B[1][1]}, B[0], B[1]};
}

// The row offsets are the student's; the columns, which no exercise asks for, are the library's.
BlockCsr empty_hessian(const Problem& problem) {
    const AtWork at_work("assembly");
    BlockCsr H = matrix_of_cells(problem.nodes(), 2, problem.mesh.elements, 3);
    if constexpr (yours("assembly")) {
        std::vector<int> row = lesson_03::row_offsets(problem.nodes(), problem.triangles);  // 3.2
        if (row != H.row) throw PartFails("assembly", "3.2 has other row offsets for this mesh than the library");
        H.row = std::move(row);
    }
    return H;
}

Vector assembled(const Problem& problem, const std::vector<Corners>& of_triangles) {
    const AtWork at_work("assembly");
    if constexpr (yours("assembly"))
        return lesson_03::assemble(problem.nodes(), problem.triangles, of_triangles);  // 3.3
    Vector g(problem.mesh.x.size(), 0.0);
    for (std::size_t k = 0; k < problem.mesh.elements.size(); ++k)  // node k % 3 of element k / 3
        for (const int a : {0, 1}) g[2 * problem.mesh.elements[k] + a] += of_triangles[k / 3][k % 3][a];
    return g;
}

void add_to(BlockCsr& H, const Triangle& triangle, const ElementMatrix& of_triangle) {
    const AtWork at_work("assembly");
    if constexpr (yours("assembly")) return lesson_03::add_to(H, triangle, of_triangle);  // 3.4
    for (int r = 0; r < 6; ++r)
        for (int s = 0; s < 6; ++s)
            H.block(H.find(triangle[r / 2], triangle[s / 2]))[r % 2 * 2 + s % 2] += of_triangle[r][s];
}

Mat<2> positive_part(const Mat<2>& A) {
    const AtWork at_work("projection");
    if constexpr (yours("projection")) return lesson_04::positive_part(A);  // 4.3
    double entries[4] = {A[0][0], A[0][1], A[1][0], A[1][1]};
    project(2, entries);
    return {{{entries[0], entries[1]}, {entries[2], entries[3]}}};
}

double valid_until(const Problem& problem, const Vector& x, const Vector& d) {
    const AtWork at_work("line_search");
    double t = std::numeric_limits<double>::infinity();
    if constexpr (yours("line_search")) {
        for (const Triangle& e : problem.triangles)
            t = std::min(t, lesson_04::first_inversion(corners(e, x), corners(e, d)));  // 4.2
        return t;
    }
    Vector to = x;
    for (std::size_t i = 0; i < x.size(); ++i) to[i] += d[i];
    const double fraction = problem.energy->valid_fraction(x, to);
    return fraction < 1 ? fraction : t;
}

// A single step of Newton's method in one variable, 4.5, is the line search: from t = 0 with the slope -1 and the
// curvature 1 of the quadratic model along d it goes to t = 1, 1/2, ...; there the slope it is told is 0, and it ends.
double accepted_step(const std::function<double(double)>& phi) {
    const AtWork at_work("line_search");
    if constexpr (yours("line_search"))
        return lesson_04::minimise(phi, [](double t) { return t == 0 ? -1.0 : 0.0; }, [](double) { return 1.0; }, 0);
    Vector t = {0}, trial = {0};
    line_search([&](const Vector& at) { return phi(at[0]); }, [](const Vector&, const Vector&) { return 1.0; }, 0, -1,
                {1}, t, trial);
    return t[0];
}

Vector mass_times(const Problem& problem, const Vector& u) {
    const AtWork at_work("trace");
    if constexpr (yours("trace")) {
        Vector Mu = lesson_07::wall_forces(problem.edges, u);  // 7.2: M u / |1|
        for (double& entry : Mu) entry *= problem.one();
        return Mu;
    }
    Vector Mu(u.size(), 0.0);
    const TraceSpace& trace = *problem.trace;
    for (int i = 0; i < trace.count(); ++i)
        for (int k = trace.M.row[i]; k < trace.M.row[i + 1]; ++k)
            for (const int a : {0, 1})
                Mu[2 * trace.nodes[i] + a] += trace.M.value[k] * u[2 * trace.nodes[trace.M.col[k]] + a];
    return Mu;
}

// 7.1 knows the constraint at two minima. If the second is to be 0, one update is enough: line 10.
double updated(double lambda, double mu, double c) {
    const AtWork at_work("update");
    if (c == 0) return lambda;
    if constexpr (yours("update")) return lesson_07::exact_multiplier(lambda, mu, c, 0);  // 7.1
    else return lambda - mu * c;
}

bool goes_on(double c_squared, double gradient_norm, const Constants& constants) {
    const AtWork at_work("schedule");
    const bool constrained = c_squared <= constants.epsilon_star, stationary = gradient_norm <= constants.omega_star;
    if constexpr (yours("schedule"))
        return lesson_08::goes_on(c_squared, gradient_norm, constants.epsilon_star, constants.omega_star);  // 8.3
    else return !Schedule({.algorithm = Algorithm::paper}, 0, 1, 1).ends(constrained, stationary);
}

// The library's schedule keeps m to itself: the one that is told by mu and by the number of updates since is found.
Settings next(const Settings& now, double c_squared, double mu0, const Constants& constants) {
    const AtWork at_work("schedule");
    if constexpr (yours("schedule")) {
        const auto s = lesson_08::next({now.mu, now.omega, now.epsilon}, c_squared, mu0, constants.omega0,
                                       constants.epsilon0);  // 8.4
        return {10 * s.mu / mu0, s.mu, s.omega, s.epsilon, s.updates_lambda};
    }
    Schedule schedule({.algorithm = Algorithm::paper, .mu0 = mu0, .omega0 = constants.omega0,
                       .epsilon0 = constants.epsilon0}, 0, 1, 1);
    double m = 10;
    for (; schedule.mu < 0.5 * now.mu; m *= 100) schedule.raise_penalty();
    while (schedule.omega > 2 * now.omega) schedule.tighten(0, 0);
    const bool updates = c_squared <= schedule.epsilon;
    if (updates) schedule.tighten(c_squared, 0);
    else schedule.raise_penalty(), m *= 100;
    return {m, schedule.mu, schedule.omega, schedule.epsilon, updates};
}

namespace {

// D A D with D = diag(A)^{-1/2}, as a matrix of numbers: conjugate gradients like a diagonal of ones.
BlockCsr scaled(const BlockCsr& A, Vector& D) {
    for (int i = 0; i < A.n; ++i)
        for (int a = 0; a < A.d; ++a) D.push_back(1 / std::sqrt(A.block(A.find(i, i))[a * A.d + a]));
    BlockCsr S;
    S.n = A.size();
    S.row = {0};
    for (int i = 0; i < S.n; ++i) {
        for (int k = A.row[i / A.d]; k < A.row[i / A.d + 1]; ++k)
            for (int b = 0; b < A.d; ++b) {
                S.col.push_back(A.col[k] * A.d + b);
                S.value.push_back(D[i] * A.block(k)[i % A.d * A.d + b] * D[S.col.back()]);
            }
        S.row.push_back(S.blocks());
    }
    return S;
}

// Steps of 10.4 until |r| <= 1e-12 |b|. The step length p.Ap > 0 has the sign of alpha: how far x goes along p.
bool conjugate_gradients(const BlockCsr& A, const Vector& b, Vector& x) {
    lesson_10::CgState state{Vector(b.size(), 0.0), b, b};
    const double enough = 1e-24 * dot(b, b);
    const int most = 2 * A.n;
    for (int step = 0; dot(state.r, state.r) > enough; ++step) {
        const Vector before = state.x, p = state.p;
        if constexpr (yours("solver")) lesson_10::cg_step(A, state);  // 10.4
        if (state.x.size() != b.size() || state.r.size() != b.size() || state.p.size() != b.size())
            throw PartFails("solver", "a vector has another length after a step of conjugate gradients");
        double along = 0;
        for (std::size_t i = 0; i < p.size(); ++i) along += p[i] * (state.x[i] - before[i]);
        if (!(along > 0)) return false;
        if (step == most)
            throw PartFails("solver", concat("|r| / |b| is still ", std::sqrt(dot(state.r, state.r) / dot(b, b)),
                                             " after ", most, " steps of conjugate gradients, expected 1e-12: without ",
                                             "rounding they need no more than ", A.n));
    }
    x = state.x;
    return true;
}

}  // namespace

bool solve(const BlockCsr& A, const Vector& b, Vector& x) {
    const AtWork at_work("solver");
    if constexpr (!yours("solver"))
        return LinearSolver(2, {.kind = SolverKind::cholesky}).solve(A, b, x).status == SolveStatus::success;
    Vector D, scaled_b = b;
    for (int i = 0; i < A.n; ++i)
        for (int a = 0; a < A.d; ++a)
            if (!(A.block(A.find(i, i))[a * A.d + a] > 0)) return false;
    const BlockCsr S = scaled(A, D);
    for (std::size_t i = 0; i < b.size(); ++i) scaled_b[i] *= D[i];
    if (!conjugate_gradients(S, scaled_b, x)) return false;
    for (std::size_t i = 0; i < b.size(); ++i) x[i] *= D[i];
    return true;
}

// The determinant is a quadratic of the part t of the way. Of the library: b_0, b_2 > 0 and b_1 > -sqrt(b_0 b_2).
bool valid_on_the_way(const Corners& from, const Corners& to) {
    const AtWork at_work("certificate");
    Corners middle;
    for (int v = 0; v < 3; ++v)
        for (const int a : {0, 1}) middle[v][a] = (from[v][a] + to[v][a]) / 2;
    const double q_0 = twice_the_area(from), q_m = twice_the_area(middle), q_1 = twice_the_area(to);
    if constexpr (yours("certificate"))
        return lesson_09::positive_everywhere(lesson_09::bezier_coefficients(q_0, q_m, q_1));  // 9.4, 9.3
    const double b_1 = 2 * q_m - (q_0 + q_1) / 2;
    return q_0 > 0 && q_1 > 0 && (b_1 > 0 || b_1 * b_1 < q_0 * q_1);
}

}  // namespace almesh::own
