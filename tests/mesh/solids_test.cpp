// Meshes of hexahedra, prisms, pyramids and tetrahedra: raised, refined, prolonged.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "mesh/mesh.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("a straight mesh of solid cells is raised with the nodes shared, its volume is that of the block") {
    for (const Mesh& linear : solid_meshes())
        for (int degree = 2; degree <= 4; ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const std::vector<double> y = straight_sided(mesh);
            for (std::size_t i = 0; i < y.size(); ++i) CHECK(std::abs(y[i] - mesh.x[i]) < 1e-14);
            std::set<std::array<long long, 3>> places;  // no two nodes in one place
            for (int i = 0; i < mesh.nodes(); ++i) {
                std::array<long long, 3> place;
                for (int a = 0; a < 3; ++a) place[a] = std::llround(1e9 * mesh.x[3 * i + a]);
                CHECK(places.insert(place).second);
            }
            CHECK(volume(mesh, mesh.x) == doctest::Approx(volume(linear, linear.x)).epsilon(1e-13));
            CHECK(linear_part(mesh).x == linear.x);
        }
}

TEST_CASE("refined solid cells fill the same volume, six pyramids and four tetrahedra each pyramid") {
    for (const Mesh& linear : solid_meshes(0))
        for (int times = 1; times <= 2; ++times) {
            const Mesh fine = refine(linear, times);
            double all = 0;
            for (int e = 0; e < fine.element_count(); ++e) {
                CHECK(volume(fine, fine.x, e) > 0);
                all += volume(fine, fine.x, e);
            }
            CHECK(all == doctest::Approx(volume(linear, linear.x)).epsilon(1e-13));
            for (const ElementGroup& group : linear.element_groups()) {
                int count = 0, pyramids = 0;
                for (const ElementGroup& of : linear.element_groups())
                    if (of.cell == &pyramid()) pyramids = of.count;
                for (const ElementGroup& of : fine.element_groups())
                    if (of.cell == group.cell) count = of.count;
                const int of_tetrahedra = times == 1 ? 4 * pyramids : (32 + 24) * pyramids;
                const int own = group.cell == &pyramid() ? 6 : 8;
                CHECK(count == group.count * (times == 1 ? own : own * own) +
                                   (group.cell == &simplex(3) ? of_tetrahedra : 0));
            }
        }
}

TEST_CASE("a field that the coarse functions have is prolonged exactly to refined and raised solid cells") {
    for (const Mesh& linear : solid_meshes()) {
        const auto field_on = [](const Mesh& mesh) {
            std::vector<double> u(mesh.x.size());
            for (std::size_t i = 0; i < u.size(); i += 3) {
                u[i] = 1 + 2 * mesh.x[i] - mesh.x[i + 1] + 3 * mesh.x[i + 2];
                u[i + 1] = mesh.x[i + 2] - mesh.x[i];
            }
            return u;
        };
        for (const Mesh& fine : {refine(linear, 1), raise_degree(refine(linear, 1), 2), refine(linear, 2),
                                 raise_degree(linear, 3), raise_degree(linear, 4)}) {
            const std::vector<double> u = prolong(linear, linear.x, fine, fine.x, field_on(linear));
            const std::vector<double> exact = field_on(fine);
            for (std::size_t i = 0; i < u.size(); ++i) CHECK(std::abs(u[i] - exact[i]) < 1e-12);
        }
    }
}
