// Meshes of quadrilaterals, alone and among triangles: built, raised, refined, cut, prolonged, certified.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "io/msh.hpp"
#include "mesh/build.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/part.hpp"
#include "mesh/sides.hpp"

using namespace almesh;

namespace {

// k x k squares of the unit square, of which every third one is two triangles if `mixed`; boundaries bottom and rest.
RawMesh squares(int k, bool mixed, bool turned = false) {
    RawMesh raw;
    raw.path = "squares.msh";
    raw.groups = {{1, 1, "bottom"}, {1, 2, "rest"}, {2, 3, "inside"}};
    for (int j = 0; j <= k; ++j)
        for (int i = 0; i <= k; ++i)
            raw.nodes.push_back({1 + i + j * (k + 1), {1.0 * i / k, 1.0 * j / k, 0}, 0});
    const auto add = [&](const CellType& cell, int physical, std::vector<int> nodes) {
        raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, cell.dim,
                                1, physical, 0, &cell});
        raw.element_nodes.insert(raw.element_nodes.end(), nodes.begin(), nodes.end());
    };
    const auto at = [k](int i, int j) { return i + j * (k + 1); };
    for (int j = 0; j < k; ++j)
        for (int i = 0; i < k; ++i) {
            const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if (mixed && (i + j) % 3 == 0) {
                add(simplex(2), 3, {a, b, c});
                add(simplex(2), 3, {a, c, d});
            } else if (turned && i % 2) {
                add(quadrilateral(), 3, {a, d, c, b});
            } else {
                add(quadrilateral(), 3, {a, b, c, d});
            }
        }
    for (int i = 0; i < k; ++i) {
        add(simplex(1), 1, {at(i, 0), at(i + 1, 0)});
        add(simplex(1), 2, {at(i + 1, k), at(i, k)});
        add(simplex(1), 2, {at(k, i), at(k, i + 1)});
        add(simplex(1), 2, {at(0, i + 1), at(0, i)});
    }
    return raw;
}

Mesh mesh_of(const RawMesh& raw) {
    std::vector<std::string> notes;
    return build_mesh(raw, notes);
}

// A smooth map of the unit square that keeps it valid.
std::vector<double> mapped(const Mesh& mesh, double by) {
    std::vector<double> x = mesh.x;
    for (std::size_t i = 0; i < x.size(); i += 2) {
        x[i] += by * std::sin(2 * mesh.x[i + 1] + 1);
        x[i + 1] += by * std::cos(3 * mesh.x[i]);
    }
    return x;
}

}  // namespace

TEST_CASE("quadrilaterals come behind triangles, each in file order, with the boundary of both") {
    for (const bool mixed : {false, true}) {
        const Mesh mesh = mesh_of(squares(4, mixed));
        CHECK(mesh.element_count() == (mixed ? 22 : 16));
        CHECK(mesh.elements_text() == (mixed ? "12 triangles, 10 quadrilaterals" : "16 quadrilaterals"));
        CHECK(mesh.groups.size() == (mixed ? 2u : 1u));
        CHECK(mesh.face_count() == 16);
        CHECK(mesh.folded.empty());
        CHECK(volume(mesh, mesh.x) == doctest::Approx(1));
        for (int e = 1; e < mesh.element_count(); ++e)
            CHECK((mesh.file.element_id[e] > mesh.file.element_id[e - 1] || &mesh.cell(e) != &mesh.cell(e - 1)));
        for (int f = 0; f < mesh.face_count(); ++f)
            CHECK(side_number(mesh, mesh.face_element[f], mesh.face_vertices(f)) >= 0);
        CHECK(certify(mesh, mesh.x).min_certified_bound == doctest::Approx(1));
        CHECK(certify_injective(mesh, mesh.x, certify(mesh, mesh.x)).certified);
        CHECK(mesh_quality(mesh, mesh.x).min == doctest::Approx(mixed ? std::sqrt(3) / 2 : 1));
    }
}

TEST_CASE("quadrilaterals that are wound the other way are turned, with all their nodes") {
    const Mesh mesh = mesh_of(squares(4, false, true)), straight = mesh_of(squares(4, false));
    CHECK(volume(mesh, mesh.x) == doctest::Approx(1));
    CHECK(certify(mesh, mesh.x).valid);
    for (const int degree : {2, 3, 4}) {
        Mesh mirrored = raise_degree(straight, degree);
        for (int i = 0; i < mirrored.nodes(); ++i) mirrored.x[offset(i, 2)] *= -1;
        CHECK(!certify(mirrored, mirrored.x).valid);
        const Mesh turned = mesh_of(parse_msh(msh_text(mirrored, mirrored.x), "a.msh"));
        CHECK(certify(turned, turned.x).valid);
        CHECK(turned.elements != mirrored.elements);
    }
}

TEST_CASE("a quadrilateral that is given twice is one element") {
    RawMesh raw = squares(2, false);
    raw.elements[1].first = raw.elements[0].first;
    std::vector<std::string> notes;
    CHECK(build_mesh(raw, notes).element_count() == 3);
    const auto tells = [&](const char* what) {
        return std::any_of(notes.begin(), notes.end(),
                           [&](const std::string& note) { return note.find(what) != std::string::npos; });
    };
    CHECK(tells("given more than once"));
    CHECK(tells("1 quadrilateral given again left out: the groups of what is given first count"));
}

TEST_CASE("raised meshes keep their shape, straight or curved, and edges are shared by both kinds of cells") {
    for (const bool mixed : {false, true})
        for (const int degree : {2, 3, 4}) {
            const Mesh linear = mesh_of(squares(3, mixed));
            const Mesh raised = raise_degree(linear, degree);
            CHECK(raised.nodes() == std::pow(3 * degree + 1, 2));
            CHECK(raised.face_nodes(0) == degree + 1);
            CHECK(certify(raised, raised.x).min_certified_bound == doctest::Approx(1));
            const std::vector<double> y = straight_sided(raised);
            for (std::size_t i = 0; i < y.size(); ++i) CHECK(y[i] == doctest::Approx(raised.x[i]));
            Mesh curved = raise_degree(linear, 2);
            curved.x = mapped(curved, 0.05);
            const Mesh again = raise_degree(curved, degree);
            const LagrangeBasis from(quadrilateral(), 2), to(quadrilateral(), degree);
            const double xi[] = {0.3, 0.8};
            std::vector<double> N(from.count), M(to.count);
            from.values(xi, N.data());
            to.values(xi, M.data());
            const int e = linear.element_count() - 1;
            for (int a = 0; a < 2; ++a) {
                double p = 0, q = 0;
                for (int i = 0; i < from.count; ++i) p += N[i] * point(curved.x, curved.element(e)[i], 2)[a];
                for (int i = 0; i < to.count; ++i) q += M[i] * point(again.x, again.element(e)[i], 2)[a];
                CHECK(p == doctest::Approx(q).epsilon(1e-13));
            }
            CHECK(certify(again, again.x).valid);
            CHECK(linear_part(again).element_count() == linear.element_count());
        }
}

TEST_CASE("refined meshes have four children of each cell, in place, and fields are prolonged exactly") {
    for (const bool mixed : {false, true}) {
        const Mesh coarse = mesh_of(squares(3, mixed));
        const Mesh fine = refine(coarse, 2);
        CHECK(fine.element_count() == 16 * coarse.element_count());
        CHECK(fine.nodes() == 13 * 13);
        CHECK(fine.face_count() == 4 * coarse.face_count());
        CHECK(volume(fine, fine.x) == doctest::Approx(1));
        CHECK(certify(fine, fine.x).valid);
        for (int e = 0; e < fine.element_count(); ++e) CHECK(&fine.cell(e) == &coarse.cell(e / 16));
        std::vector<double> field;  // linear in x and y
        for (int i = 0; i < coarse.nodes(); ++i)
            field.insert(field.end(), {1 + 2 * coarse.x[2 * i] - coarse.x[2 * i + 1], coarse.x[2 * i + 1]});
        const std::vector<double> there = prolong(coarse, coarse.x, fine, fine.x, field);
        for (int i = 0; i < fine.nodes(); ++i) {
            CHECK(there[2 * i] == doctest::Approx(1 + 2 * fine.x[2 * i] - fine.x[2 * i + 1]));
            CHECK(there[2 * i + 1] == doctest::Approx(fine.x[2 * i + 1]));
        }
        // On bilinear cells that are no parallelograms: positions themselves are a field of the space.
        Mesh bent = coarse;
        bent.x = mapped(coarse, 0.05);
        const Mesh of_bent = refine(bent, 1), raised = raise_degree(of_bent, 3);
        const std::vector<double> x = prolong(bent, bent.x, raised, straight_sided(raised), bent.x);
        for (std::size_t i = 0; i < x.size(); ++i) CHECK(x[i] == doctest::Approx(raised.x[i]).epsilon(1e-12));
    }
}

TEST_CASE("a part of a mixed mesh has its cells, and its cut as a boundary") {
    const Mesh mesh = raise_degree(mesh_of(squares(4, true)), 2);
    std::vector<char> chosen(mesh.element_count(), 0);
    chosen[2] = chosen[15] = chosen[16] = 1;
    const std::vector<char> around = surroundings(mesh, chosen, 0);
    const Mesh part = part_of(mesh, around, "cut");
    CHECK(part.element_count() == std::count(around.begin(), around.end(), 1));
    CHECK(certify(part, part.x).min_certified_bound == doctest::Approx(1));
    int sides = 0;
    for_sides(part, [&](int, int, int) { ++sides; });
    CHECK((sides + part.face_count()) % 2 == 0);
    for (int f = 0; f < part.face_count(); ++f)
        CHECK(side_number(part, part.face_element[f], part.face_vertices(f)) >= 0);
    const Restriction found = restriction_to(std::vector<char>(mesh.nodes(), 1), mesh);
    CHECK(found.elements.size() == mesh.elements.size());
}

TEST_CASE("the certificate of quadrilaterals agrees with dense samples of det J") {
    std::mt19937 random(7);
    int valid = 0, invalid = 0;
    for (int degree = 1; degree <= 4; ++degree) {
        const Mesh mesh = raise_degree(mesh_of(squares(1, false)), degree);
        const LagrangeBasis basis(quadrilateral(), degree);
        for (int k = 0; k < 150; ++k) {
            std::vector<double> x = mesh.x;
            std::uniform_real_distribution<double> by(-0.7 / degree, 0.7 / degree);
            for (double& v : x) v += by(random);
            double least = std::numeric_limits<double>::infinity();
            std::vector<double> dN(2 * basis.count);
            for (int s = 0; s <= 40; ++s)
                for (int t = 0; t <= 40; ++t) {
                    const double xi[] = {s / 40.0, t / 40.0};
                    basis.gradients(xi, dN.data());
                    double J[2][2] = {};
                    for (int i = 0; i < basis.count; ++i)
                        for (int a = 0; a < 2; ++a)
                            for (int b = 0; b < 2; ++b) J[a][b] += x[2 * mesh.element(0)[i] + a] * dN[2 * i + b];
                    least = std::min(least, J[0][0] * J[1][1] - J[0][1] * J[1][0]);
                }
            least /= std::abs(volume(mesh, x, 0));
            const Certificate certificate = certify(mesh, x);
            CHECK(certificate.undecided == 0);
            CHECK(certificate.min_certified_bound <= least + 1e-9);
            if (least > 0.05) CHECK(certificate.valid);
            if (least <= 0) CHECK(!certificate.valid);
            ++(certificate.valid ? valid : invalid);
        }
    }
    CHECK(valid > 100);
    CHECK(invalid > 100);
}

TEST_CASE("the certificate does not depend on where the mesh is") {
    for (const int degree : {1, 3}) {
        const Mesh mesh = raise_degree(mesh_of(squares(4, true)), degree);
        std::vector<double> x = mapped(mesh, 0.05), far = x;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::round(x[i] * 1048576) / 1048576;  // exact far away, too
        for (std::size_t i = 0; i < x.size(); ++i) far[i] = x[i] + 1048576;
        CHECK(certify(mesh, far).certified_bound == certify(mesh, x).certified_bound);
        CHECK(certify_injective(mesh, far, certify(mesh, far)).certified);
    }
}

TEST_CASE("a quadrilateral that is inverted at one corner is not valid, however large it is elsewhere") {
    Mesh mesh = mesh_of(squares(1, false));
    std::vector<double> x = mesh.x;
    x[2 * mesh.element(0)[2]] = x[2 * mesh.element(0)[2] + 1] = 0.4;  // the arrow head
    const Certificate certificate = certify(mesh, x);
    CHECK(!certificate.valid);
    CHECK(certificate.undecided == 0);
}
