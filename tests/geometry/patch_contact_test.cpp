#include <doctest/doctest.h>

#include <cmath>

#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("segments and arcs in the plane") {
    for (int degree : {1, 4}) {
        const PatchBasis basis(1, degree);
        const auto contact = [&](Vec<3> a, Vec<3> b, Vec<3> c, Vec<3> d) {
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
    const auto with_wall = [&](const Patch& other) { return patch_contact(basis.bernstein, wall, other); };
    CHECK(with_wall(arc(basis, 1.00001, 0, 1)) == Contact::apart);
    CHECK(with_wall(arc(basis, 1, 1, 2)) == Contact::apart);
    const Vec<3> low = {std::cos(0.1), std::sin(0.1), 0}, high = {std::cos(0.9), std::sin(0.9), 0};
    CHECK(with_wall(segment(basis, {0.99 * low[0], 0.99 * low[1], 0}, {0.99 * high[0], 0.99 * high[1], 0})) ==
          Contact::apart);
    CHECK(with_wall(segment(basis, {0.99, 0, 0}, {std::cos(1) + 0.001, std::sin(1), 0})) == Contact::crossing);
}

TEST_CASE("triangles in space") {
    for (int degree : {1, 3}) {
        const PatchBasis basis(2, degree);
        const Patch base = triangle(basis, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const auto contact = [&](Vec<3> a, Vec<3> b, Vec<3> c) {
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
        return interpolated(basis, [&](double s, double t) {
            return Vec<3>{s, t, height + slope * s - 0.3 * (s * s + t * t)};
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
