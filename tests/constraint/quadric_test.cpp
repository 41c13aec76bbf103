#include "constraint/surface.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

using namespace almesh;

namespace {

using Shape = std::function<Vec<3>(double, double)>;

// A rotation without special directions, then a shift far from the origin compared to the size; in 2D within the plane.
Vec<3> placed(const Vec<3>& x, int dim) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    const double d = dim == 2 ? 1 : std::cos(1.1), e = dim == 2 ? 0 : std::sin(1.1);
    const Vec<3> y = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
    return {y[0] + 50, d * y[1] - e * y[2] - 20, e * y[1] + d * y[2] + (dim == 2 ? 0 : 30)};
}

struct Sample {
    std::string name;
    int dim;
    Shape shape;
    double u[2], v[2];  // the piece that is sampled
    double reach;       // within which its closest points are told

    Vec<3> at(double s, double t) const {
        return placed(shape(u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])), dim);
    }

    std::vector<Vec<3>> points() const {
        std::vector<Vec<3>> points;
        const int rows = dim == 2 ? 0 : 5;
        for (int i = 0; i <= 10; ++i)
            for (int j = 0; j <= rows; ++j) points.push_back(at(i / 10.0, rows ? 1.0 * j / rows : 0));
        return points;
    }

    // By a grid of parameters around those of the best so far, finer and finer; somewhat beyond the piece too.
    Vec<3> closest(const Vec<3>& x) const {
        double s = 0.5, t = 0.5, width = 0.8, least = 1e300;
        for (; width > 1e-9; width *= 0.3) {
            const double s0 = s, t0 = t;
            for (int i = -12; i <= 12; ++i)
                for (int j = dim == 2 ? 0 : -12; j <= (dim == 2 ? 0 : 12); ++j) {
                    const double distance = length(at(s0 + width * i / 12, t0 + width * j / 12) - x);
                    if (distance >= least) continue;
                    least = distance, s = s0 + width * i / 12, t = t0 + width * j / 12;
                }
        }
        return at(s, t);
    }
};

const std::vector<Sample> samples = {
    {"ellipsoid", 3,
     [](double u, double v) -> Vec<3> {
         return {3 * std::cos(u) * std::cos(v), 2 * std::sin(u) * std::cos(v), 1.5 * std::sin(v)};
     }, {0, 4}, {-1, 1}, 0.4},
    {"cone", 3, [](double u, double v) -> Vec<3> { return {v * std::cos(u), v * std::sin(u), 2 * v}; },
     {0, 5}, {1, 3}, 0.4},
    {"elliptic cylinder", 3, [](double u, double v) -> Vec<3> { return {3 * std::cos(u), 2 * std::sin(u), v}; },
     {0, 5}, {-2, 2}, 0.4},
    {"paraboloid", 3, [](double u, double v) -> Vec<3> { return {u, v, 0.3 * u * u + 0.5 * v * v}; },
     {-2, 2}, {-2, 2}, 0.4},
    {"saddle", 3, [](double u, double v) -> Vec<3> { return {u, v, 0.3 * u * u - 0.2 * v * v}; },
     {-2, 2}, {-2, 2}, 0.4},
    {"hyperboloid", 3,
     [](double u, double v) -> Vec<3> {
         return {std::cosh(v) * std::cos(u), 1.5 * std::cosh(v) * std::sin(u), std::sinh(v)};
     }, {0, 4}, {-1, 1}, 0.2},
    {"ellipse", 2, [](double u, double) -> Vec<3> { return {3 * std::cos(u), 2 * std::sin(u), 0}; },
     {0, 5}, {0, 0}, 0.4},
    {"parabola", 2, [](double u, double) -> Vec<3> { return {u, 0.4 * u * u, 0}; }, {-1, 3}, {0, 0}, 0.4},
    {"hyperbola", 2, [](double u, double) -> Vec<3> { return {std::cosh(u), 2 * std::sinh(u), 0}; },
     {-1, 1}, {0, 0}, 0.4},
};

// Points near the middle of the piece, at most `reach` in each direction off it.
std::vector<Vec<3>> points_near(const Sample& sample, double reach, int count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<Vec<3>> points;
    for (int k = 0; k < count; ++k) {
        const Vec<3> off = {number(random), number(random), sample.dim == 2 ? 0 : number(random)};
        points.push_back(sample.at(0.5 + 0.3 * number(random), 0.5 + 0.3 * number(random)) + reach / 2 * off);
    }
    return points;
}

}  // namespace

TEST_CASE("quadrics and conics are found through their points, turned and far from the origin, and named") {
    for (const Sample& sample : samples) {
        CAPTURE(sample.name);
        const std::vector<Vec<3>> points = sample.points();
        for (const auto& found : {fit_quadric(sample.dim, points, 1e-8), fit_surface(sample.dim, points, {})}) {
            REQUIRE(found);
            CHECK(found->name() == (sample.dim == 2 ? "conic" : "quadric"));
            for (int k = 0; k <= 20; ++k) {  // between the points too
                const Vec<3> x = sample.at(0.05 * k, 0.37 + 0.01 * k);
                CHECK(length(found->closest(x).position - x) < 1e-8);
            }
        }
    }
}

TEST_CASE("the projection onto a quadric is the closest point") {
    for (const Sample& sample : samples) {
        CAPTURE(sample.name);
        const auto found = fit_quadric(sample.dim, sample.points(), 1e-8);
        REQUIRE(found);
        for (const Vec<3>& x : points_near(sample, sample.reach, 10)) {
            const SurfacePoint projection = found->closest(x);
            CHECK(length(projection.position - sample.closest(x)) < 1e-6);
            CHECK(length(found->closest(projection.position).position - projection.position) < 1e-12);
            CHECK(length(projection.normal) == doctest::Approx(1));
            CHECK(length(cross(x - projection.position, projection.normal)) < 1e-10);
        }
    }
}

TEST_CASE("slope and curvature at the projection on a quadric are derivatives") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    const double h = 1e-5;
    for (const Sample& sample : samples) {
        CAPTURE(sample.name);
        const auto found = fit_quadric(sample.dim, sample.points(), 1e-8);
        REQUIRE(found);
        for (const Vec<3>& x : points_near(sample, sample.reach, 10)) {
            const Vec<3> d = {number(random), number(random), sample.dim == 2 ? 0 : number(random)};
            const SurfacePoint at = found->closest(x);
            const SurfacePoint plus = found->closest(x + h * d), minus = found->closest(x - h * d);
            const Vec<3> change = d - 0.5 / h * (plus.position - minus.position);
            const Vec<3> turn = 0.5 / h * (plus.normal - minus.normal);
            for (int i = 0; i < 3; ++i) {
                CHECK(std::abs(change[i] - dot(at.slope[i], d)) < 1e-6);
                CHECK(std::abs(turn[i] - dot(at.curvature[i], d)) < 1e-6);
            }
        }
    }
}

TEST_CASE("far outside a quadric, and at its focal points, projections are told") {
    const auto ellipsoid = fit_quadric(3, samples[0].points(), 1e-8);
    REQUIRE(ellipsoid);
    for (const Vec<3>& direction : {Vec<3>{1, 0.4, 0.3}, Vec<3>{0.2, 1, -0.3}}) {
        const Vec<3> x = samples[0].at(0.3, 0.5) + 80 * direction;
        const SurfacePoint projection = ellipsoid->closest(x);
        CHECK(length(ellipsoid->closest(projection.position).position - projection.position) < 1e-9);
        CHECK(length(cross(x - projection.position, projection.normal)) < 1e-8 * length(x - projection.position));
    }
    for (const Vec<3>& inside : {Vec<3>{0, 0, 0}, Vec<3>{1, 0, 0}, Vec<3>{0.2, 0.1, 0}}) {
        const SurfacePoint projection = ellipsoid->closest(placed(inside, 3));
        CHECK(std::isfinite(length(projection.position)));
        CHECK(length(projection.normal) == doctest::Approx(1));
        for (int i = 0; i < 3; ++i) CHECK(std::isfinite(length(projection.curvature[i]) + length(projection.slope[i])));
    }
}

TEST_CASE("no quadric: too few points, one plane, two planes, points off it, an apex") {
    for (const int sample : {0, 6}) {
        std::vector<Vec<3>> points = samples[sample].points();
        const int dim = samples[sample].dim;
        std::vector<Vec<3>> few(points.begin(), points.begin() + (dim == 2 ? 7 : 11));
        CHECK(!fit_quadric(dim, few, 1e-8));
        points[points.size() / 2] = points[points.size() / 2] + Vec<3>{1e-3, 1e-3, dim == 2 ? 0 : 1e-3};
        CHECK(!fit_quadric(dim, points, 1e-8));
        CHECK(fit_quadric(dim, points, 1e-2));
    }
    std::vector<Vec<3>> flat, bent, cone;
    for (int i = -3; i <= 3; ++i)
        for (int j = 0; j <= 5; ++j) {
            flat.push_back(placed({1.0 * i, 1.0 * j, 0}, 3));
            bent.push_back(placed({1.0 * i, 1.0 * j, 0.5 * std::abs(i)}, 3));
            cone.push_back(placed(samples[1].shape(i, 0.4 * j), 3));
        }
    CHECK(!fit_quadric(3, flat, 1e-8));
    CHECK(!fit_quadric(3, bent, 1e-8));
    CHECK(!fit_quadric(3, cone, 1e-8));
}
