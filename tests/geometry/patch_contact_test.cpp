#include <doctest/doctest.h>

#include <cmath>

#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "support/patches.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Contact contact(const PatchBasis& basis, const Patch& a, const Patch& b, bool corners_meet = false) {
    return patch_contact(basis.bernstein, a, b, contact_tolerance(a, b, 0), corners_meet);
}

}  // namespace

TEST_CASE("segments and arcs in the plane") {
    for (int degree : {1, 4}) {
        const PatchBasis basis(1, degree);
        const auto of = [&](Vec<3> a, Vec<3> b, Vec<3> c, Vec<3> d, bool corners_meet = false) {
            return contact(basis, segment(basis, a, b), segment(basis, c, d), corners_meet);
        };
        CHECK(of({0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}) == Contact::crossing);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0, 1.1e-9, 0}, {1, 1.1e-9, 0}) == Contact::apart);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0, 0.9e-9, 0}, {1, 0.9e-9, 0}) == Contact::touching);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0.3, 1, 0}) == Contact::touching);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, true) == Contact::apart);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}) == Contact::touching);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0.5, -0.9e-9, 0}, {0.5, 1, 0}) == Contact::touching);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0.5, -1.1e-9, 0}, {0.5, 1, 0}) == Contact::crossing);
        CHECK(of({0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {2, 0, 0}) == Contact::touching);  // along each other
    }
    const PatchBasis basis(1, 4);
    const Patch wall = arc(basis, 1, 0, 1);
    const auto with_wall = [&](const Patch& other) { return contact(basis, wall, other); };
    CHECK(with_wall(arc(basis, 1.00001, 0, 1)) == Contact::apart);
    CHECK(with_wall(arc(basis, 1, 1, 2)) == Contact::touching);
    const Vec<3> low = {std::cos(0.1), std::sin(0.1), 0}, high = {std::cos(0.9), std::sin(0.9), 0};
    CHECK(with_wall(segment(basis, {0.99 * low[0], 0.99 * low[1], 0}, {0.99 * high[0], 0.99 * high[1], 0})) ==
          Contact::apart);
    CHECK(with_wall(segment(basis, {0.99, 0, 0}, {std::cos(1) + 0.001, std::sin(1), 0})) == Contact::crossing);
}

TEST_CASE("triangles in space") {
    for (int degree : {1, 3}) {
        const PatchBasis basis(2, degree);
        const Patch base = triangle(basis, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const auto of = [&](Vec<3> a, Vec<3> b, Vec<3> c, bool corners_meet = false) {
            return contact(basis, base, triangle(basis, a, b, c), corners_meet);
        };
        CHECK(of({0.2, 0.2, -1}, {0.3, 0.2, 1}, {0.2, 0.4, 1}) == Contact::crossing);
        CHECK(of({0.8, 0.8, -1}, {0.9, 0.8, 1}, {0.8, 0.9, 1}) == Contact::apart);
        CHECK(of({0, 0, 1e-7}, {1, 0, 1e-7}, {0, 1, 1e-7}) == Contact::apart);
        CHECK(of({0, 0, 0}, {0.5, 0.5, 1}, {0.5, 0.5, 2}, true) == Contact::apart);  // shared corner
        CHECK(of({0, 0, 0}, {0.5, 0.2, 1}, {0.5, 0.2, -1}, true) == Contact::crossing);  // through it, shared corner
    }
    const PatchBasis basis(2, 4);
    const auto cap = [&](double height, double slope) {
        return interpolated(basis, [&](double s, double t) {
            return Vec<3>{s, t, height + slope * s - 0.3 * (s * s + t * t)};
        });
    };
    CHECK(contact(basis, cap(0, 0), cap(0.02, 0)) == Contact::apart);
    CHECK(contact(basis, cap(0, 0), cap(-0.1, 0.5)) == Contact::crossing);
    CHECK(contact(basis, cap(0, 0), cap(1e-8, 0)) == Contact::undecided);
}

TEST_CASE("patches that touch along a curve are left undecided") {
    const PatchBasis basis(1, 2);
    const Patch wall = arc(basis, 1, 0, 1);
    CHECK(contact(basis, wall, wall) != Contact::crossing);
}

TEST_CASE("elements that touch at a side, an edge or a vertex are apart; they overlap beyond the tolerance") {
    for (const int dim : {2, 3})
        for (const int degree : {1, 2}) {
            const PatchBasis basis(dim, degree), other_basis(dim == 2 ? quadrilateral() : hexahedron(), degree);
            const auto solid = [dim](const PatchBasis& of, const CellType& cell, int p, const Vec<3>& shift) {
                std::vector<Vec<3>> nodes;
                const LagrangeBasis lagrange(cell, p);
                for (int i = 0; i < of.nodes; ++i) {
                    const std::array<double, 3> xi = lagrange.point(i);
                    nodes.push_back(Vec<3>{xi[0], xi[1], dim == 3 ? xi[2] : 0} + shift);
                }
                return Solid{cell, of, make_patch(of, nodes)};
            };
            const Solid simplex_here = solid(basis, simplex(dim), degree, {});
            const auto with = [&](const Vec<3>& shift, double tolerance) {
                const Solid other = solid(basis, simplex(dim), degree, shift);
                const Solid block = solid(other_basis, dim == 2 ? quadrilateral() : hexahedron(), degree, shift);
                const bool overlaps = solid_contact(simplex_here, block, {0, 0, 0}, tolerance) != Contact::apart;
                CHECK(overlaps == (solid_contact(simplex_here, other, {0, 0, 0}, tolerance) != Contact::apart));
                return overlaps;
            };
            CHECK(!with({1, 0, 0}, 1e-9));
            CHECK(!with({0.2, -1, 0}, 1e-9));
            CHECK(!with({0.5, 0.5, 0}, 1e-9));
            CHECK(with({0.5 - 1e-6, 0.5 - 1e-6, 0}, 1e-9));
            CHECK(!with({0.5 - 1e-10, 0.5 - 1e-10, 0}, 1e-9));
            CHECK(with({0.1, 0.1, 0}, 1e-9));
        }
}
