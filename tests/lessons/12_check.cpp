#include "lessons/exercises/12.hpp"

#include <algorithm>
#include <cmath>

#include "lessons/exercise.hpp"
#include "lessons/moved_circle.hpp"

namespace almesh::lessons {

// Of the judge the densities are those of the answers, which run in children.
MEMBER_ANSWERS(CubicDensity, f, f1, f2)
MEMBER_ANSWERS(BarrierDensity, f, f1, f2)

namespace {

ANSWERS(blended);

// Derivatives by their order of accuracy: the error of the Taylor polynomial falls with the third power of the step.
template <class Density>
void check_derivatives(const Density& density, double eta) {
    const auto error = [&](double h) {
        const double taylor = density.f(eta) + h * density.f1(eta) + 0.5 * h * h * density.f2(eta);
        return std::abs(density.f(eta + h) - taylor) + 1e-15;
    };
    const double order = order_of(error, 0.02, 4);
    expect(order > 2.8, "at eta = ", eta, " the error of f + h f' + h^2 f''/2 is of order ", order,
           " in h, expected 3: ", order < 1.5 ? "f' is not the derivative of f" : "f'' is not the derivative of f'");
    expect(density.f1(eta) > 0, "f' is ", density.f1(eta), " at eta = ", eta, ": f has to grow with the distortion");
    expect(density.f2(eta) >= 0, "f'' is ", density.f2(eta), " at eta = ", eta, ": f has to be convex");
}

// The gradient with respect to F from the library's template, against differences.
template <class Density>
void check_gradient(const Density& density) {
    const Mat<2> F = {{{1.1, 0.2}, {-0.1, 0.9}}}, P = density_gradient<2>(F, 0.0, density);
    const double h = 1e-5;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            Mat<2> ahead = F, behind = F;
            ahead[i][j] += h;
            behind[i][j] -= h;
            const double slope =
                (density.f(distortion<2>(ahead, 0.0)) - density.f(distortion<2>(behind, 0.0))) / (2 * h);
            expect_close(concat("df/dF_", i, j), P[i][j], slope, 1e-6, "f and f' do not belong together");
        }
}

EXERCISE("12.1", "a cubic density") {
    const CubicDensity density{0.5};
    expect_close("f(1)", density.f(1), 0, 1e-14, "an undistorted element costs nothing");
    expect_close("f(3) with kappa = 0.5", density.f(3), 10, 1e-12);
    for (const double eta : {1.2, 2.0, 5.0}) check_derivatives(density, eta);
    check_gradient(density);
    expect_close("f(2) with kappa = 0", CubicDensity{0}.f(2), 1, 1e-12);
}

EXERCISE("12.2", "a barrier") {
    const BarrierDensity density{1.35};
    expect_close("f(1)", density.f(1), 0, 1e-14, "divide the argument of the logarithm by M - 1");
    expect_close("f'(1)", density.f1(1), 1 / 0.35, 1e-12);
    expect(std::isinf(density.f(1.35)) && std::isinf(density.f(2)), "f(2) is ", density.f(2),
           " with M = 1.35, expected infinity: a long step may jump over the barrier");
    for (const double eta : {1.05, 1.2}) check_derivatives(density, eta);
    check_gradient(density);
    const MovedCircle problem;
    const Minimum minimum = in_child([&] { return minimise(problem, density); });
    expect(minimum.converged, "Newton's method with it does not converge");
    double largest = 0;
    for (int e = 0; e < problem.mesh.element_count(); ++e) largest = std::max(largest, problem.eta(e, minimum.x));
    expect(largest < 1.35, "the minimum has an element with eta = ", largest, ", beyond M = 1.35");
}

// Where all these points go.
std::vector<Vec<2>> blended_all(std::vector<Vec<2>> points, double d) {
    return in_child([&] {
        for (Vec<2>& y : points) y = blended(y, d);
        return points;
    });
}

EXERCISE("12.3", "a valid start") {
    for (const double d : {8.0, -19.0}) {
        for (double angle = 0.05; angle < 6.3; angle += 0.31) {
            const Vec<2> u = {std::cos(angle), std::sin(angle)};
            const Vec<2> inner = blended(u, d), outer = blended({21 * u[0], 21 * u[1]}, d);
            expect_close("a point of the inner circle is off in x by", inner[0] - u[0] - d, 0, 1e-12);
            expect_close("a point of the inner circle is off in y by", inner[1] - u[1], 0, 1e-12);
            expect_close(concat("d = ", d, ": a point of the outer circle moves in x by"), outer[0] - 21 * u[0], 0,
                         1e-12, "only the inner one moves: let the motion fade with |y|");
            expect_close("a point of the outer circle moves in y by", outer[1] - 21 * u[1], 0, 1e-12);
            const double h = 1e-6;
            std::vector<Vec<2>> around;
            for (double r = 1.01; r < 21; r += 0.4)
                for (const Vec<2>& by : {Vec<2>{-h, 0}, Vec<2>{h, 0}, Vec<2>{0, -h}, Vec<2>{0, h}})
                    around.push_back({r * u[0] + by[0], r * u[1] + by[1]});
            const std::vector<Vec<2>> moved = blended_all(around, d);
            for (std::size_t i = 0; i < moved.size(); i += 4) {
                const double x = around[i][0] + h, y = around[i][1];
                const Vec<2>&a = moved[i], &b = moved[i + 1], &c = moved[i + 2], &e = moved[i + 3];
                const double det = ((b[0] - a[0]) * (e[1] - c[1]) - (b[1] - a[1]) * (e[0] - c[0])) / (4 * h * h);
                expect(det > 1e-6, "d = ", d, ": det of the map is ", det, " at (", x, ", ", y,
                       "): the motion fades too fast there");
            }
            Vec<2> last = inner;
            std::vector<Vec<2>> ray;
            for (double r = 1.001; r < 21; r += 0.001) ray.push_back({r * u[0], r * u[1]});
            const std::vector<Vec<2>> images = blended_all(ray, d);
            for (std::size_t i = 0; i < ray.size(); ++i) {
                const Vec<2>& now = images[i];
                expect(std::hypot(now[0] - last[0], now[1] - last[1]) < 0.5, "the map jumps near (", ray[i][0], ", ",
                       ray[i][1], ")");
                last = now;
            }
        }
    }
}

EXERCISE("12.4", "an ellipse (ellipse.deck)") {
    expect_only("ellipse", {"mesh = ../../../meshes/circle.msh", "boundary outer = fixed"}, {"boundary inner"});
    const auto summary = run_deck("ellipse");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    expect(summary.at("certified_valid") == "yes", "an element is not certified valid");
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(read_mesh("outputs/lessons/answers/ellipse/final.msh"), notes);
    int count = 0;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int k = 0; k < 2; ++k) {
            if (mesh.boundaries[mesh.face_boundary[f]] != "inner") continue;
            const double* const x = point(mesh.x, mesh.face(f)[k], 2);
            const double level = x[0] * x[0] / 4 + 4 * x[1] * x[1];
            expect_close(concat("(x/2)^2 + (2y)^2 at the boundary node (", x[0], ", ", x[1], ")"), level, 1, 1e-6,
                         "stretch x, squeeze y; each by 2");
            ++count;
        }
    expect(count == 64, "the final mesh has ", count / 2, " faces on the boundary inner, expected 32");
}

EXERCISE("12.5", "row 3 of Table 1 (table_row.deck)") {
    expect_only("table_row", {"mesh = ../../../meshes/circle.msh", "boundary inner = translate 8 0",
                              "boundary outer = fixed", "algorithm = paper", "length_scale = 1", "mu0 = 24",
                              "omega0 = 0.1", "epsilon0 = 1e-4", "omega_star = 1e-6",
                              "epsilon_star = 1e-14"}, {"refine", "objective"});
    const auto summary = run_deck("table_row");
    expect(number(summary, "elements") == 26272, "the mesh has ", number(summary, "elements"),
           " triangles, the row has 26272: each refinement makes four of one");
    expect(summary.at("status") == "converged", "the run ends with ", summary.at("status"));
    const double q = number(summary, "relative_quality");
    expect(std::abs(q - 0.937) < 0.001, "q is ", q, ", the paper has 0.937",
           std::abs(q - 0.9259) < 0.001 ? ": that is the minimum of Eq. 5; which functional are the tables of?" : "");
    expect(number(summary, "al_iterations") <= 8, number(summary, "al_iterations"), " iterations, the paper has 6");
}

}  // namespace
}  // namespace almesh::lessons
