#include "constraint/surface.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>

#include "geometry/face_patches.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A rotation without special directions, then a shift far from the origin compared to the size.
Vec<3> placed(const Vec<3>& x) {
    const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(1.1), e = std::sin(1.1);
    const Vec<3> y = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
    return {y[0] + 50, d * y[1] - e * y[2] - 20, e * y[1] + d * y[2] + 30};
}

std::vector<Vec<3>> sampled(const std::function<Vec<3>(double, double)>& surface, double u_end, double v_end) {
    std::vector<Vec<3>> points;
    for (int i = 0; i <= 6; ++i)
        for (int j = 0; j <= 5; ++j) points.push_back(placed(surface(u_end * i / 6, v_end * j / 5)));
    return points;
}

Vec<3> on_torus(double u, double v) {
    const double r = 3 + 0.8 * std::cos(v);
    return {r * std::cos(u), r * std::sin(u), 0.8 * std::sin(v)};
}

const struct {
    const char* name;
    std::function<Vec<3>(double, double)> surface;
    double u_end, v_end;
} primitives[] = {
    {"plane", [](double u, double v) -> Vec<3> { return {u, v, 0}; }, 2, 3},
    {"sphere of radius 2", [](double u, double v) -> Vec<3> {
         return {2 * std::cos(u) * std::cos(v), 2 * std::sin(u) * std::cos(v), 2 * std::sin(v)};
     }, 2, 1},
    {"cylinder of radius 1.5", [](double u, double v) -> Vec<3> { return {1.5 * std::cos(u), 1.5 * std::sin(u), v}; },
     6, 4},
    {"cylinder of radius 1.5", [](double u, double v) -> Vec<3> { return {1.5 * std::cos(u), 1.5 * std::sin(u), v}; },
     1.5, 1},  // a piece of it
    {"torus of radii 3 and 0.8", on_torus, 6, 6},
};

}  // namespace

TEST_CASE("planes, spheres, cylinders and tori are found where points lie on them, turned and far from the origin") {
    for (const auto& primitive : primitives) {
        const std::string name = primitive.name;
        CAPTURE(name);
        const std::vector<Vec<3>> points = sampled(primitive.surface, primitive.u_end, primitive.v_end);
        const Vec<3> normal = cross(points[1] - points[0], points[6] - points[0]);
        const auto found = fit_surface(3, points, normal);
        REQUIRE(found);
        CHECK(found->name() == name);
        for (const Vec<3>& x : points) CHECK(length(found->closest(x).position - x) < 1e-8);
    }
    std::vector<Vec<3>> bumpy = sampled(primitives[2].surface, 6, 4);
    bumpy[17][1] += 1e-3;
    CHECK(!fit_surface(3, bumpy, {0, 0, 1}));
    CHECK(!fit_surface(3, {}, {0, 0, 1}));
    CHECK(!fit_surface(3, {{1, 2, 3}}, {0, 0, 1}));
    const auto line = fit_surface(2, {{0, 0, 0}, {1, 1, 0}, {3, 3, 0}}, {1, -1, 0});
    REQUIRE(line);
    CHECK(line->name() == "straight line");
    std::vector<Vec<3>> arc;
    for (int k = 0; k < 5; ++k) arc.push_back({7 + 2 * std::cos(0.3 * k), 2 * std::sin(0.3 * k), 0});
    const auto circle = fit_surface(2, arc, {1, 0, 0});
    REQUIRE(circle);
    CHECK(circle->name() == "circle of radius 2");
}

TEST_CASE("the closest-point projection is on the surface; slope and curvature are derivatives") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    for (const auto& primitive : primitives) {
        const std::string name = primitive.name;
        CAPTURE(name);
        const std::vector<Vec<3>> points = sampled(primitive.surface, primitive.u_end, primitive.v_end);
        const auto found = fit_surface(3, points, cross(points[1] - points[0], points[6] - points[0]));
        REQUIRE(found);
        for (int k = 0; k < 20; ++k) {
            const Vec<3> x = points[2 * k] + 0.2 * Vec<3>{number(random), number(random), number(random)};
            const SurfacePoint at = found->closest(x);
            CHECK(length(cross(x - at.position, at.normal)) < 1e-9);
            CHECK(length(at.normal) == doctest::Approx(1));
            CHECK(length(found->closest(at.position).position - at.position) < 1e-9);
            const Vec<3> d = {number(random), number(random), number(random)};
            const double h = 1e-5;
            const SurfacePoint plus = found->closest(x + h * d), minus = found->closest(x - h * d);
            const Vec<3> turn = 0.5 / h * (plus.normal - minus.normal);
            const Vec<3> change = d - 0.5 / h * (plus.position - minus.position);
            for (int i = 0; i < 3; ++i) {
                CHECK(turn[i] == doctest::Approx(dot(at.curvature[i], d)).epsilon(1e-5));
                CHECK(change[i] == doctest::Approx(dot(at.slope[i], d)).epsilon(1e-5));
            }
        }
    }
}

TEST_CASE("along a mesh's own faces: a point on them, with normals that turn continuously") {
    const Mesh mesh = ring_mesh(24, 2, 2);
    const PatchBasis basis(1, 1);
    std::vector<Patch> patches;
    std::vector<std::vector<int>> nodes;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (mesh.boundaries[mesh.face_boundary[f]] != "outer") continue;
        patches.push_back(FacePatches(mesh).of(f, mesh.x)[0]);
        nodes.emplace_back(mesh.face(f), mesh.face(f) + 2);
    }
    const auto faces = surface_of_faces(basis, patches, nodes);
    Vec<3> before{};
    for (int k = 0; k <= 2000; ++k) {
        const double t = 2 * std::acos(-1.0) * k / 2000;
        const SurfacePoint at = faces->closest({1.95 * std::cos(t), 1.95 * std::sin(t), 0});
        CHECK(length(at.position) <= 2 + 1e-12);
        CHECK(length(at.position) >= 2 * std::cos(std::acos(-1.0) / 24) - 1e-12);
        CHECK(std::abs(at.normal[0] * std::cos(t) + at.normal[1] * std::sin(t)) > 0.999);
        if (k > 0) CHECK(length(at.normal - before) < 0.02);
        before = at.normal;
    }
}

TEST_CASE("flat faces are rounded: through their corners, and far nearer to the curve or surface that these are from") {
    const auto height = [](double x, double y) { return 0.3 * x * x + 0.2 * std::sin(2 * x) * std::cos(y); };
    double error[2][2];
    for (const int dim : {2, 3})
        for (const int finer : {0, 1}) {
            const int k = finer ? 16 : 8;
            Mesh mesh = dim == 2 ? square_mesh(k) : cube_mesh(k);
            for (int i = 0; i < mesh.nodes(); ++i) {
                double* const x = point(mesh.x, i, dim);
                x[dim - 1] += height(x[0], dim == 3 ? x[1] : 0);
            }
            const PatchBasis basis(dim - 1, 1);
            std::vector<Patch> patches;
            std::vector<std::vector<int>> nodes;
            for (int f = 0; f < mesh.face_count(); ++f) {
                if (mesh.boundaries[mesh.face_boundary[f]] != "bottom") continue;
                patches.push_back(FacePatches(mesh).of(f, mesh.x)[0]);
                nodes.emplace_back(mesh.face(f), mesh.face(f) + dim);
            }
            const auto faces = surface_of_faces(basis, patches, nodes);
            for (const Patch& patch : patches)
                for (const Vec<3>& corner : patch) CHECK(length(faces->closest(corner).position - corner) < 1e-14);
            double& largest = error[dim - 2][finer] = 0;
            for (int i = 0; i <= 50; ++i) {  // away from the rim
                const double x = 0.3 + 0.4 * i / 50, y = dim == 3 ? 0.3 + 0.4 * (7 * i % 50) / 50 : 0, z = height(x, y);
                const Vec<3> at = dim == 3 ? Vec<3>{x, y, z} : Vec<3>{x, z, 0};
                largest = std::max(largest, length(faces->closest(at).position - at));
            }
        }
    CHECK(error[0][0] < 1e-5);
    CHECK(error[0][1] < error[0][0] / 16);
    CHECK(error[1][0] < 5e-4);
    CHECK(error[1][1] < error[1][0] / 3);
}

TEST_CASE("in the plane a mesh's own faces are one curve with a continuous curvature, but for its corners and ends") {
    const auto surface_through = [](const std::vector<Vec<3>>& x, bool closed) {
        std::vector<Patch> patches;
        std::vector<std::vector<int>> nodes;
        const int count = static_cast<int>(x.size());
        for (int i = 0; i < (closed ? count : count - 1); ++i) {
            patches.push_back({x[i], x[(i + 1) % count]});
            nodes.push_back({i, (i + 1) % count});
        }
        return surface_of_faces(PatchBasis(1, 1), patches, nodes);
    };
    const auto curvature = [](const Surface& surface, const Vec<3>& x) {
        const SurfacePoint at = surface.closest(x);
        CHECK(length(at.position - x) < 1e-5);
        return at.curvature[0][0] + at.curvature[1][1];
    };
    std::vector<Vec<3>> egg;
    for (int i = 0; i < 24; ++i) {
        const double t = 2 * std::acos(-1.0) * (i + 0.3 * (i % 2)) / 24, r = 1 + 0.2 * std::cos(t) + 0.1 * std::cos(2 * t);
        egg.push_back({r * std::cos(t), r * std::sin(t), 0});
    }
    for (const bool closed : {true, false}) {
        const auto faces = surface_through(egg, closed);
        for (int i = 0; i < 24; ++i) {
            if (!closed && (i == 0 || i == 23)) continue;
            const Vec<3> before = egg[i] - 1e-6 * unit(egg[i] - egg[(i + 23) % 24]),
                         after = egg[i] + 1e-6 * unit(egg[(i + 1) % 24] - egg[i]);
            CHECK(std::abs(curvature(*faces, after) - curvature(*faces, before)) < 1e-4);
        }
    }
    std::vector<Vec<3>> square;
    for (int i = 0; i < 16; ++i) {  // four faces on each side, no two of the same length
        const double s = (i % 4 + 0.1 * (i % 4) * (i % 4)) / 4.9, side[4] = {s, 1, 1 - s, 0};
        square.push_back({side[i / 4], side[(i / 4 + 3) % 4], 0});
    }
    const auto sides = surface_through(square, true);
    for (const Vec<3>& x : {Vec<3>{0.03, 0, 0}, Vec<3>{0.5, 0, 0}, Vec<3>{1, 0.97, 0}, Vec<3>{0, 0.4, 0}}) {
        CHECK(length(sides->closest(x).position - x) < 1e-14);
        CHECK(std::abs(curvature(*sides, x)) < 1e-12);
    }
}

TEST_CASE("the projection on a mesh's own faces: along the normal, its slope the derivative, itself on the surface") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    Mesh bowl = cube_mesh(3);
    for (int i = 0; i < bowl.nodes(); ++i) {
        double* const x = &bowl.x[3 * i];
        x[2] += 0.3 * (x[0] - 0.5) * (x[0] - 0.5) + 0.2 * std::sin(2 * x[1]);
    }
    for (const Mesh& mesh : {ring_mesh(24, 2, 2), bowl, raise_degree(bowl, 2)}) {
        const int dim = mesh.dim;
        CAPTURE(dim);
        CAPTURE(mesh.degree);
        const PatchBasis basis(dim - 1, mesh.degree);
        std::vector<Patch> patches;
        std::vector<std::vector<int>> nodes;
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (mesh.boundaries[mesh.face_boundary[f]] != (dim == 2 ? "outer" : "bottom")) continue;
            patches.push_back(FacePatches(mesh).of(f, mesh.x)[0]);
            nodes.emplace_back(mesh.face(f), mesh.face(f) + mesh.face_nodes(0));
        }
        const auto faces = surface_of_faces(basis, patches, nodes);
        for (int k = 0; k < 40; ++k) {
            const double t = number(random);
            const Vec<3> x = dim == 2 ? Vec<3>{1.93 * std::cos(3 * t), 1.93 * std::sin(3 * t), 0}
                                      : Vec<3>{0.5 + 0.3 * t, 0.5 + 0.3 * number(random), 0.3 + 0.05 * number(random)};
            const SurfacePoint at = faces->closest(x);
            CHECK(length(cross(x - at.position, at.normal)) < 1e-12);
            CHECK(length(faces->closest(at.position).position - at.position) < 1e-13);
            const Vec<3> d = {number(random), number(random), dim == 2 ? 0 : number(random)};
            const double h = 1e-6;
            const SurfacePoint plus = faces->closest(x + h * d), minus = faces->closest(x - h * d);
            const Vec<3> change = d - 0.5 / h * (plus.position - minus.position);
            const Vec<3> turn = 0.5 / h * (plus.normal - minus.normal);
            for (int i = 0; i < dim; ++i) {
                CHECK(change[i] == doctest::Approx(dot(at.slope[i], d)).epsilon(1e-6));
                CHECK(std::abs(turn[i] - dot(at.curvature[i], d)) < 0.2);
            }
        }
    }
}
