#include "geometry/patch.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("corners are kept to the bit, halves join, and the hull encloses") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0.1, 0.7);
    CHECK(patch[0][0] == std::cos(0.1));
    const auto [near, far] = bisect(basis.bernstein, patch, 0, 1);
    CHECK(near[0] == patch[0]);
    CHECK(far[1] == patch[1]);
    CHECK(near[1] == far[0]);
    CHECK(std::abs(std::hypot(near[1][0], near[1][1]) - 1) < 1e-4);
    CHECK(size_of(patch, 1) == doctest::Approx(2 * std::sin(0.3)));
    CHECK(deviation(basis.bernstein, patch) >= 1 - std::cos(0.3));
    CHECK(deviation(basis.bernstein, segment(basis, {0, 0, 0}, {1, 2, 0})) < 1e-15);
    CHECK(overlap(box_of(patch), box_of(near)));
}

TEST_CASE("normals point right of a curve and out of a counter-clockwise triangle; cones have their measure") {
    const PatchBasis line(1, 3), face(2, 3);
    const PatchNormal normal_2(1, 3), normal_3(2, 3);
    const auto n = normal_2.coefficients(segment(line, {0, 0, 0}, {2, 0, 0}));
    for (const Vec<3>& v : n) CHECK(v[1] == doctest::Approx(-2));
    CHECK(normal_2.cone(segment(line, {0, 0, 0}, {2, 0, 0}), {0, 1, 0}) == doctest::Approx(1));
    const Patch corner = triangle(face, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(normal_3.cone(corner, {0, 0, 0}) == doctest::Approx(1.0 / 6));
    CHECK(normal_3.cone(corner, {1, 1, 1}) == doctest::Approx(-1.0 / 3));
    // A sector of the unit disc, up to the interpolation error of degree 3.
    CHECK(normal_2.cone(arc(line, 1, 0, 0.5), {0, 0, 0}) == doctest::Approx(0.25).epsilon(1e-4));
}

TEST_CASE("a straight patch holds what its corners enclose") {
    const PatchBasis basis(2, 1);
    const Patch patch = {{1e6, 1e6, 0}, {1e6 + 1, 1e6, 0}, {1e6, 1e6 + 1e-3, 0}};
    const auto is_held = [&](double s, double t) {
        return holds(basis.bernstein, patch, {1e6 + s, 1e6 + 1e-3 * t, 0});
    };
    CHECK(is_held(0.3, 0.3));
    CHECK(is_held(0.5, 0.499));
    CHECK(!is_held(0.5, 0.501));
    CHECK(!is_held(-1e-3, 0.5));
    CHECK(!is_held(0.5, -1e-3));
    const PatchBasis space(3, 1);
    const Patch tetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    CHECK(holds(space.bernstein, tetrahedron, {0.3, 0.3, 0.3}));
    CHECK(holds(space.bernstein, tetrahedron, {0, 0, 0}));
    CHECK(!holds(space.bernstein, tetrahedron, {0.34, 0.34, 0.34}));
}

// The unit square's lower half, its lower side lifted or lowered to a parabola of this height in the middle.
TEST_CASE("a curved patch holds what is behind its curved side, near and far from it") {
    for (const int degree : {2, 3}) {
        const PatchBasis basis(2, degree);
        for (const double height : {0.2, -0.2, 1e-3}) {
            const Patch patch = interpolated(basis, [&](double s, double t) {
                return Vec<3>{s, t + height * 4 * s * (1 - s - t), 0};
            });
            for (const double near : {0.1, 1e-3, 1e-6}) {
                CAPTURE(degree);
                CAPTURE(height);
                CAPTURE(near);
                CHECK(holds(basis.bernstein, patch, {0.5, height + near, 0}));
                CHECK(!holds(basis.bernstein, patch, {0.5, height - near, 0}));
                CHECK(holds(basis.bernstein, patch, {near / 2, 0.5, 0}));
                CHECK(!holds(basis.bernstein, patch, {-near, 0.5, 0}));
                CHECK(holds(basis.bernstein, patch, {0.25 - near, 0.75, 0}));
                CHECK(!holds(basis.bernstein, patch, {0.25 + near, 0.75, 0}));
            }
        }
    }
}

TEST_CASE("a curved patch so far away that its halves have no more digits, or of no size, is decided all the same") {
    const PatchBasis basis(2, 2);
    const Patch far = interpolated(basis, [](double s, double t) { return Vec<3>{1e6 + 1e-6 * s, 1e6 + 1e-6 * t, 0}; });
    CHECK(holds(basis.bernstein, far, {1e6 + 3e-7, 1e6 + 3e-7, 0}));
    CHECK(!holds(basis.bernstein, far, {1e6 + 2e-6, 1e6 + 3e-7, 0}));
    CHECK(holds(basis.bernstein, Patch(6, {1, 1, 0}), {1, 1, 0}));
}

// A tetrahedron in an oblique plane, 1e-8 high, bent within it: far too many pieces are near the points around.
TEST_CASE("what is next to a patch that is nearly flat counts as in it where pieces do not tell in time") {
    const PatchBasis basis(3, 2);
    const Vec<3> a{0.8, 0.6, 0}, b{-0.36, 0.48, 0.8}, c{0.48, -0.64, 0.6};  // orthonormal
    Patch flat;
    for (const MultiIndex& m : basis.bernstein.index) {
        const double s = 0.5 * m[1], t = 0.5 * m[2], u = 0.5 * m[3];
        flat.push_back((s + 0.3 * u + 0.4 * s * t) * a + (t + 0.3 * u - 0.4 * t * u) * b + (1e-8 * u) * c);
    }
    const auto near = [&](double height) { return 0.4 * a + 0.4 * b + height * c; };
    CHECK(holds(basis.bernstein, flat, near(2e-8)));
    CHECK(!holds(basis.bernstein, flat, near(1e-3)));
}

// A tetrahedron with one edge bent until det J vanishes at its end.
TEST_CASE("what is next to a patch with a strongly bent edge is told from it") {
    const PatchBasis basis(3, 2);
    const Patch bent = {{0, 0, 0},   {0, 1, 0},     {0, 1, 1},       {1, 1, 1},                         {0, 0.5, 0},
                        {0, 1, 0.5}, {0, 0.5, 0.5}, {0.5, 0.5, 0.5}, {2.1640625, 2.6640625, 2.6640625}, {0.5, 1, 0.5}};
    CHECK(!holds(basis.bernstein, bent, {0.7030981773144, 1.0364231773146, 1.3697481773145}));
    CHECK(!holds(basis.bernstein, bent, {0.5, 0.2, 0.7}));
    CHECK(holds(basis.bernstein, bent, {0.25, 0.75, 0.6}));
}

// Half of a stretched bilinear quadrilateral, turned by 45 degrees. The diagonal goes beyond its second end and back.
TEST_CASE("a patch with an edge that turns back on itself does not hold points beside it") {
    const PatchBasis basis(2, 2);
    const auto turned = [](double x, double y) { return Vec<3>{x - y, x + y, 0}; };
    const Patch patch = interpolated(basis, [&](double s, double t) {
        const double u = s, v = s + t;  // corners (0, 0), (1, 1), (0, 1) of the unit square
        return turned(u * v * 0.3 + (1 - u) * v, u * (1 - v) * -0.01 + u * v * -0.009);
    });
    for (int i = 1; i < 20; ++i) {
        CAPTURE(i);
        const double x = 0.05 * i;
        CHECK(holds(basis.bernstein, patch, turned(x, -1e-5)));
        for (const double y : {1e-5, 1e-3, 0.1}) CHECK(!holds(basis.bernstein, patch, turned(x, y)));
    }
}

// Cells of every type, in layers stretched 1 : 50000, turned by an odd angle, and bent in degree 2.
TEST_CASE("cells hold what is in them and not what is next to them, thin ones too") {
    for (const CellType& cell : cell_types()) {
        if (cell.dim < 2 || cell.is_simplex()) continue;
        for (const int degree : {1, 2}) {
            CAPTURE(cell.vertices);
            CAPTURE(degree);
            const PatchBasis basis(cell, degree);
            const LagrangeBasis lagrange(cell, degree);
            const int up = cell.dim - 1;
            const auto placed = [&](Vec<3> p) {
                p[up] += degree == 2 ? 3 * p[0] * (1 - p[0]) : 0;
                p[up] *= 2e-5;
                const double c = std::cos(0.7), s = std::sin(0.7);
                return Vec<3>{1 + c * p[0] - s * p[up], s * p[0] + c * p[up], cell.dim == 3 ? p[1] : 0};
            };
            std::vector<Vec<3>> nodes;
            Vec<3> centre{};
            for (int i = 0; i < lagrange.count; ++i) {
                Vec<3> xi = lagrange.point(i);
                for (int k = 0; k < 2 && cell.is_collapsed; ++k) xi[k] *= 1 - xi[2];
                nodes.push_back(placed(xi));
                if (i < cell.vertices) centre = centre + 1.0 / cell.vertices * xi;
            }
            const Patch patch = make_patch(basis, nodes);
            const auto is_held = [&](double height) {
                Vec<3> at = centre;
                at[up] += height;
                return holds(basis.bernstein, patch, placed(at));
            };
            CHECK(is_held(0));
            CHECK(is_held(0.1));
            CHECK(is_held(-0.15));
            for (const double height : {1.0, 0.9, -0.6, -1.0, 100.0}) CHECK(!is_held(height));
        }
    }
}
