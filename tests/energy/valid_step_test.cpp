#include "energy/valid_step.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"
#include "support/determinant.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

double fraction(const Mesh& mesh, const std::vector<double>& from, const std::vector<double>& to,
                std::vector<Inversion>& inversions) {
    return ValidStep(mesh.cell(), mesh.degree).fraction(mesh.elements, mesh.element_count(), from, to, inversions);
}

double fraction(const Mesh& mesh, const std::vector<double>& from, const std::vector<double>& to) {
    std::vector<Inversion> inversions;
    return fraction(mesh, from, to, inversions);
}

std::vector<double> between(const std::vector<double>& from, const std::vector<double>& to, double s) {
    std::vector<double> x = from;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += s * (to[i] - from[i]);
    return x;
}

// Least determinant of the first element at a lattice of points.
double least_determinant(const Mesh& mesh, const std::vector<double>& x) {
    const LagrangeBasis basis(mesh.dim, mesh.degree);
    double least = std::numeric_limits<double>::infinity();
    for (const MultiIndex& a : gmsh_node_order(mesh.dim, 12)) {
        const double xi[3] = {a[1] / 12.0, a[2] / 12.0, a[3] / 12.0};
        const double det = mesh.dim == 2 ? determinant_at<2>(basis, mesh.element(0), x, xi)
                                         : determinant_at<3>(basis, mesh.element(0), x, xi);
        least = std::min(least, det);
    }
    return least;
}

Mesh one_element(int dim, int degree) {
    const std::vector<double> x =
        dim == 2 ? std::vector<double>{0, 0, 1, 0, 0, 1} : std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::vector<int> element(dim + 1);
    for (int i = 0; i <= dim; ++i) element[i] = i;
    return raise_degree(linear_mesh(dim, x, element, [](const double*) { return "wall"; }), degree);
}

}  // namespace

TEST_CASE("a step that does nothing is valid, and so are small ones, in every degree") {
    for (const int degree : {1, 2, 3, 4})
        for (const Mesh& linear : {ring_mesh(10, 3, 4), cube_mesh(2)}) {
            const Mesh mesh = raise_degree(linear, degree);
            CHECK(fraction(mesh, mesh.x, mesh.x) == 1);
            CHECK(fraction(mesh, mesh.x, wavy(mesh.x, mesh.dim, 0.02)) == 1);
        }
}

// Both ends are valid, with the same shape; half way every element has shrunk to a point.
TEST_CASE("half a turn is a step through an inversion though both of its ends are valid") {
    for (const int degree : {1, 2, 4})
        for (const Mesh& linear : {square_mesh(2), cube_mesh(1)}) {
            const Mesh mesh = raise_degree(linear, degree);
            std::vector<double> turned = mesh.x;
            for (int i = 0; i < mesh.nodes(); ++i)
                for (int a = 0; a < 2; ++a) turned[i * mesh.dim + a] *= -1;
            std::vector<Inversion> inversions;
            const double s = fraction(mesh, mesh.x, turned, inversions);
            CHECK(s > 0.4);
            CHECK(s < 0.5);
            CHECK(inversions.empty());  // nothing is folded at the end
        }
}

TEST_CASE("a straight element is followed up to where its determinant vanishes first") {
    const Mesh mesh = one_element(2, 1);
    const std::vector<double> to = {0, 0, 1, 0, 0, -3};  // vanishes at 1/4
    CHECK(fraction(mesh, mesh.x, to) == doctest::Approx(0.25).epsilon(0.01));
    CHECK(fraction(mesh, mesh.x, to) < 0.25);
    const std::vector<double> far = between(mesh.x, to, 0.24);
    CHECK(fraction(mesh, mesh.x, far) == 1);
}

// Up to the fraction that is found the element has a positive determinant wherever it is looked at; and not far beyond
// there is a point where it has not.
TEST_CASE("random steps of curved elements: no folded point before the end that is found, and one soon after it") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> moved(-1, 1);
    int cut = 0, close = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const Mesh mesh = one_element(2 + trial % 2, 2 + trial / 2 % 3);
        std::vector<double> to = mesh.x;
        for (double& v : to) v += (0.1 + 0.002 * trial) * moved(random);
        std::vector<Inversion> inversions;
        const double s = fraction(mesh, mesh.x, to, inversions);
        for (int k = 0; k <= 20; ++k) REQUIRE(least_determinant(mesh, between(mesh.x, to, s * k / 20)) > 0);
        const bool folded = least_determinant(mesh, to) <= 0;
        if (folded) REQUIRE(s < 1);
        if (folded) REQUIRE(inversions.size() == 1);
        if (folded) CHECK(inversions[0].ratio == 0);
        for (const Inversion& inversion : inversions) {
            const double xi[3] = {inversion.at[1], inversion.at[2], inversion.at[3]};
            const LagrangeBasis basis(mesh.dim, mesh.degree);
            const double det = mesh.dim == 2 ? determinant_at<2>(basis, mesh.element(0), to, xi)
                                             : determinant_at<3>(basis, mesh.element(0), to, xi);
            CHECK(inversion.ratio < 0.1);
            CHECK((inversion.ratio == 0) == (det < 1e-9));
        }
        if (s == 1) continue;
        ++cut;
        for (int k = 1; k <= 10; ++k)
            if (least_determinant(mesh, between(mesh.x, to, std::min(1.0, s + 0.01 * k))) < 0.05) {
                ++close;
                break;
            }
    }
    CHECK(cut > 100);
    CHECK(close > 0.9 * cut);
}

TEST_CASE("steps have the same fraction and inversions for any number of threads, and elements of aspect 1e6 pass") {
    const Mesh mesh = raise_degree(ring_mesh(60, 30, 4), 3);
    std::vector<double> to = wavy(mesh.x, 2, 0.02);
    for (int i = 0; i < mesh.nodes(); i += 97) to[2 * i] += 0.4;
    std::vector<std::size_t> counts;
    for (const double s : for_threads([&] {
             std::vector<Inversion> inversions;
             const double found = fraction(mesh, mesh.x, to, inversions);
             counts.push_back(inversions.size());
             return found;
         })) {
        CHECK(s < 1);
        CHECK(s == fraction(mesh, mesh.x, to));
    }
    CHECK(counts[0] > 0);
    CHECK(counts[0] == counts[1]);
    CHECK(counts[0] == counts[2]);

    for (const int degree : {1, 3}) {
        Mesh thin = raise_degree(square_mesh(4), degree);
        for (std::size_t i = 1; i < thin.x.size(); i += 2) thin.x[i] *= 1e-6;
        std::vector<double> turned = thin.x;  // by half a degree
        const double c = std::cos(0.0087), s = std::sin(0.0087);
        for (int i = 0; i < thin.nodes(); ++i) {
            turned[2 * i] = c * thin.x[2 * i] - s * thin.x[2 * i + 1];
            turned[2 * i + 1] = s * thin.x[2 * i] + c * thin.x[2 * i + 1];
        }
        CHECK(fraction(thin, thin.x, turned) == 1);
    }
}

// Its determinant is linear, 1 - 4 s at one vertex and 1 + 4 s at another; its mean, that of the straight triangle, 1.
TEST_CASE("a curved element keeps a fifth of its least determinant in a step, or a fiftieth of its mean") {
    const Mesh mesh = one_element(2, 2);
    const auto with_least = [&mesh](double determinant) {
        std::vector<double> x = mesh.x;
        x[2 * 3] -= 0.25 * (1 - determinant);  // the middle of the first edge
        return x;
    };
    const auto step = [&](double from, double to) { return fraction(mesh, with_least(from), with_least(to)); };
    CHECK(step(1, 0.025) == 1);
    CHECK(step(1, 0.015) < 1);
    CHECK(step(1, 0.015) > 0.9);
    CHECK(step(0.01, 0.0025) == 1);
    CHECK(step(0.01, 0.0015) < 1);
    // Nearer to an inversion than a millionth of the mean no element comes; one that is there may stay.
    CHECK(step(2e-6, 1.2e-6) == 1);
    CHECK(step(2e-6, 0.8e-6) < 1);
    CHECK(step(0.5e-6, 0.5e-6) == 1);
}

// Straight and curved cells of every type, which tumble and fold on the way: no s up to the fraction has a determinant
// that is not positive at a lattice of points, and just after it there is one near zero.
TEST_CASE("steps of every cell end before it folds anywhere, and not long before") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const CellType& cell : cell_types()) {
        if (cell.dim < 2) continue;
        const Quadrature points = element_quadrature(cell, 3, 6);
        int cut = 0, close = 0, trials = 0;
        for (const int degree : {1, 2, 3}) {
            const LagrangeBasis basis(cell, degree);
            const ValidStep valid_step(cell, degree);
            std::vector<int> node(basis.count);
            std::iota(node.begin(), node.end(), 0);
            const auto least = [&](const std::vector<double>& x) {
                double value = std::numeric_limits<double>::infinity();
                for (int q = 0; q < points.count; ++q) {
                    const double* const xi = &points.xi[q * cell.dim];
                    value = std::min(value, cell.dim == 2 ? determinant_at<2>(basis, node.data(), x, xi)
                                                          : determinant_at<3>(basis, node.data(), x, xi));
                }
                return value;
            };
            for (int trial = 0; trial < 8; ++trial) {
                std::vector<double> from, to;
                for (int i = 0; i < basis.count; ++i) {
                    std::array<double, 3> xi = basis.point(i);
                    for (int k = 0; k < 2 && cell.is_collapsed; ++k) xi[k] *= 1 - xi[2];
                    for (int k = 0; k < cell.dim; ++k) {
                        from.push_back(xi[k]);
                        to.push_back(xi[k] + 0.7 / degree * any(random));
                    }
                }
                std::vector<Inversion> inversions;
                const double s = valid_step.fraction(node, 1, from, to, inversions);
                for (int k = 0; k <= 10; ++k) CHECK(least(between(from, to, s * k / 10)) > 0);
                ++trials;
                if (least(to) <= 0) CHECK(s < 1);
                if (s == 1) continue;
                ++cut;
                for (int k = 1; k <= 10; ++k)
                    if (least(between(from, to, std::min(1.0, s + 0.01 * k))) < 0.1) {
                        ++close;
                        break;
                    }
            }
        }
        CAPTURE(cell.vertices);
        CHECK(cut > trials / 4);
        CHECK(close > 0.8 * cut);
    }
}

// Turned by 180 degrees about an edge, on straight lines: at both ends it is the unit cube, halfway it has no volume.
TEST_CASE("a hexahedron that is turned through itself is stopped though both ends are valid; a shift passes") {
    const LagrangeBasis basis(hexahedron(), 1);
    std::vector<int> node(8);
    std::iota(node.begin(), node.end(), 0);
    std::vector<double> from, turned, shifted;
    for (int i = 0; i < 8; ++i)
        for (int a = 0; a < 3; ++a) {
            const double v = basis.point(i)[a];
            from.push_back(v);
            turned.push_back(a == 2 ? v : -v);
            shifted.push_back(v + 5);
        }
    std::vector<Inversion> inversions;
    const ValidStep valid_step(hexahedron(), 1);
    const double s = valid_step.fraction(node, 1, from, turned, inversions);
    CHECK(s < 0.5);
    CHECK(s > 0.3);
    CHECK(valid_step.fraction(node, 1, from, shifted, inversions) == 1);
}

// From the cube to a hexahedron with eight positive corners that is folded along an edge between them.
TEST_CASE("a step that folds a hexahedron along an edge between positive corners is cut, and the place is told") {
    const LagrangeBasis basis(hexahedron(), 1);
    std::vector<int> node(8);
    std::iota(node.begin(), node.end(), 0);
    const std::vector<double> to = {1.2, 0.6, 1.3, 1.9, -1.0, -1.0, 2.0, 2.0, -0.9, -0.8, -0.9, -1.0,
                                    -1.0, 1.0, 0.7, 1.6, -1.0, 2.0, 2.0, -0.1, 1.7, 0.7, 2.0, 2.0};
    std::vector<double> from;
    for (int i = 0; i < 8; ++i)
        for (int a = 0; a < 3; ++a) from.push_back(basis.point(i)[a]);
    std::vector<Inversion> inversions;
    CHECK(ValidStep(hexahedron(), 1).fraction(node, 1, from, to, inversions) < 1);
    REQUIRE(inversions.size() == 1);
    CHECK(inversions[0].ratio == 0);
    const double xi[3] = {inversions[0].at[1], inversions[0].at[3], inversions[0].at[5]};
    CHECK(determinant_at<3>(basis, node.data(), to, xi) < 0);
}
