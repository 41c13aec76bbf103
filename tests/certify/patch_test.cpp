#include "certify/patch.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "certify/closest_point.hpp"
#include "certify/patch_contact.hpp"
#include "certify/patch_normal.hpp"

using namespace almesh;

namespace {

// Patch of degree p through the points map(l), l the nodes of the reference face.
template <class Map>
Patch interpolated(const PatchBasis& basis, int dim, const Map& map) {
    std::vector<double> nodes;
    for (const MultiIndex& a : basis.bernstein.index) {
        const Point x = map(1.0 * a[1] / basis.bernstein.degree, 1.0 * a[2] / basis.bernstein.degree);
        nodes.insert(nodes.end(), x.begin(), x.begin() + dim);
    }
    return make_patch(basis, nodes.data(), dim);
}

Patch segment(const PatchBasis& basis, Point a, Point b) {
    return interpolated(basis, 2, [&](double t, double) {
        return Point{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0};
    });
}

Patch triangle(const PatchBasis& basis, Point a, Point b, Point c) {
    return interpolated(basis, 3, [&](double s, double t) {
        Point x = a;
        for (int k = 0; k < 3; ++k) x[k] += s * (b[k] - a[k]) + t * (c[k] - a[k]);
        return x;
    });
}

// An arc of a circle of radius r from angle a to angle b.
Patch arc(const PatchBasis& basis, double r, double a, double b) {
    return interpolated(basis, 2, [&](double t, double) {
        return Point{r * std::cos(a + t * (b - a)), r * std::sin(a + t * (b - a)), 0};
    });
}

}  // namespace

TEST_CASE("corners are kept to the bit, halves join, and the hull encloses") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0.1, 0.7);
    CHECK(patch.point(0)[0] == std::cos(0.1));
    const auto [near, far] = bisect(basis.bernstein, patch, 0, 1);
    CHECK(near.point(0) == patch.point(0));
    CHECK(far.point(1) == patch.point(1));
    CHECK(near.point(1) == far.point(0));
    CHECK(std::abs(std::hypot(near.point(1)[0], near.point(1)[1]) - 1) < 1e-4);
    CHECK(size_of(patch, 1) == doctest::Approx(2 * std::sin(0.3)));
    CHECK(deviation(basis.bernstein, patch) >= 1 - std::cos(0.3));
    CHECK(deviation(basis.bernstein, segment(basis, {0, 0, 0}, {1, 2, 0})) < 1e-15);
    CHECK(overlap(box_of(patch), box_of(near)));
}

TEST_CASE("normals point right of a curve and out of a counter-clockwise triangle; cones have their measure") {
    const PatchBasis line(1, 3), face(2, 3);
    const PatchNormal normal_2(2, 3), normal_3(3, 3);
    const auto n = normal_2.coefficients(segment(line, {0, 0, 0}, {2, 0, 0}));
    for (double v : n[1]) CHECK(v == doctest::Approx(-2));
    CHECK(normal_2.cone(segment(line, {0, 0, 0}, {2, 0, 0}), {0, 1, 0}) == doctest::Approx(1));
    const Patch corner = triangle(face, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(normal_3.cone(corner, {0, 0, 0}) == doctest::Approx(1.0 / 6));
    CHECK(normal_3.cone(corner, {1, 1, 1}) == doctest::Approx(-1.0 / 3));
    // A sector of the unit disc, up to the interpolation error of degree 3.
    CHECK(normal_2.cone(arc(line, 1, 0, 0.5), {0, 0, 0}) == doctest::Approx(0.25).epsilon(1e-4));
}

TEST_CASE("segments and arcs in the plane") {
    for (int degree : {1, 4}) {
        const PatchBasis basis(1, degree);
        const auto contact = [&](Point a, Point b, Point c, Point d) {
            return patch_contact(basis.bernstein, segment(basis, a, b), segment(basis, c, d));
        };
        CHECK(contact({0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}) == Contact::crossing);
        CHECK(contact({0, 0, 0}, {1, 0, 0}, {0, 1e-9, 0}, {1, 1e-9, 0}) == Contact::apart);
        CHECK(contact({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0.3, 1, 0}) == Contact::apart);       // shared corner
        CHECK(contact({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}) == Contact::apart);     // touching
        CHECK(contact({0, 0, 0}, {1, 0, 0}, {0.5, -1e-6, 0}, {0.5, 1, 0}) == Contact::crossing);
        CHECK(contact({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {2, 0, 0}) == Contact::apart);       // along each other
    }
    const PatchBasis basis(1, 4);
    const Patch wall = arc(basis, 1, 0, 1);
    CHECK(patch_contact(basis.bernstein, wall, arc(basis, 1.00001, 0, 1)) == Contact::apart);
    CHECK(patch_contact(basis.bernstein, wall, arc(basis, 1, 1, 2)) == Contact::apart);
    CHECK(patch_contact(basis.bernstein, wall, segment(basis, {std::cos(0.1), std::sin(0.1), 0}, {std::cos(0.9), std::sin(0.9), 0})) == Contact::apart);
    CHECK(patch_contact(basis.bernstein, wall, segment(basis, {0.99, 0, 0}, {std::cos(1) + 0.001, std::sin(1), 0})) == Contact::crossing);
}

TEST_CASE("triangles in space") {
    for (int degree : {1, 3}) {
        const PatchBasis basis(2, degree);
        const Patch base = triangle(basis, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const auto contact = [&](Point a, Point b, Point c) {
            return patch_contact(basis.bernstein, base, triangle(basis, a, b, c));
        };
        CHECK(contact({0.2, 0.2, -1}, {0.3, 0.2, 1}, {0.2, 0.4, 1}) == Contact::crossing);
        CHECK(contact({0.8, 0.8, -1}, {0.9, 0.8, 1}, {0.8, 0.9, 1}) == Contact::apart);
        CHECK(contact({0, 0, 1e-7}, {1, 0, 1e-7}, {0, 1, 1e-7}) == Contact::apart);
        CHECK(contact({0, 0, 0}, {0.5, 0.5, 1}, {0.5, 0.5, 2}) == Contact::apart);       // shared corner
        CHECK(contact({0, 0, 0}, {0.5, 0.2, 1}, {0.5, 0.2, -1}) == Contact::crossing);   // through it, shared corner
    }
    const PatchBasis basis(2, 4);
    const auto cap = [&](double height, double slope) {
        return interpolated(basis, 3, [&](double s, double t) {
            return Point{s, t, height + slope * s - 0.3 * (s * s + t * t)};
        });
    };
    CHECK(patch_contact(basis.bernstein, cap(0, 0), cap(0.02, 0)) == Contact::apart);
    CHECK(patch_contact(basis.bernstein, cap(0, 0), cap(-0.1, 0.5)) == Contact::crossing);
    CHECK(patch_contact(basis.bernstein, cap(0, 0), cap(1e-8, 0)) == Contact::undecided);
}

TEST_CASE("patches that touch along a curve are left undecided") {
    const PatchBasis basis(1, 2);
    const Patch wall = arc(basis, 1, 0, 1);
    CHECK(patch_contact(basis.bernstein, wall, wall) != Contact::crossing);
}

TEST_CASE("the closest point is found from any start on a curve with one minimum") {
    const PatchBasis basis(1, 4);
    const Patch patch = arc(basis, 1, 0, 0.5);
    const FaceProjector projector(1, 4);
    std::vector<Point> control, work(2 * projector.count());
    for (int k = 0; k < projector.count(); ++k) control.push_back(patch.point(k));
    for (double start : {0.0, 0.3, 1.0}) {
        const Point x = {1.2 * std::cos(0.2), 1.2 * std::sin(0.2), 0}, beyond = {1.1, -0.3, 0};
        CHECK(std::sqrt(projector.squared_distance(control.data(), x, {1 - start, start, 0}, work)) ==
              doctest::Approx(0.2).epsilon(1e-5));
        CHECK(std::sqrt(projector.squared_distance(control.data(), beyond, {1 - start, start, 0}, work)) ==
              doctest::Approx(std::hypot(0.1, 0.3)).epsilon(1e-14));
    }
}
