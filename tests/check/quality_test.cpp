#include "check/quality.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/build.hpp"
#include "support/energy_checks.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh single(int dim, std::vector<double> x) {
    std::vector<int> element(dim + 1);
    std::iota(element.begin(), element.end(), 0);
    return linear_mesh(dim, std::move(x), element, [](const double*) { return "wall"; });
}

}  // namespace

TEST_CASE("regular simplices of any size have quality one") {
    const Mesh triangle = single(2, {0, 0, 1e-3, 0, 0.5e-3, std::sqrt(0.75) * 1e-3});
    CHECK(mesh_quality(triangle, triangle.x).min == doctest::Approx(1).epsilon(1e-14));
    const Mesh tetrahedron = single(3, {1, 1, 1, 1, -1, -1, -1, -1, 1, -1, 1, -1});
    CHECK(mesh_quality(tetrahedron, tetrahedron.x).min == doctest::Approx(1).epsilon(1e-14));
    CHECK(mesh_quality(tetrahedron, tetrahedron.x).histogram[9] == 1);
}

TEST_CASE("regular prisms, pyramids and cubes have quality one, in every degree and turned") {
    const double h = std::sqrt(0.75), top = std::sqrt(0.5);
    const std::vector<std::pair<const CellType*, std::vector<double>>> regular = {
        {&prism(), {0, 0, 0, 1, 0, 0, 0.5, h, 0, 0, 0, 1, 1, 0, 1, 0.5, h, 1}},
        {&pyramid(), {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, top}},
        {&hexahedron(), {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1}}};
    for (const auto& [cell, x] : regular) {
        RawMesh raw;
        raw.path = "regular.msh";
        raw.elements = {{1, 0, 0, 3, 1, 1, 0, cell}};
        for (int v = 0; v < cell->vertices; ++v) {
            raw.nodes.push_back({v + 1, {3 * x[3 * v + 1], -3 * x[3 * v], 3 * x[3 * v + 2]}, 0});
            raw.element_nodes.push_back(v);
        }
        std::vector<std::string> notes;
        for (int degree = 1; degree <= 3; ++degree) {
            const Mesh mesh = raise_degree(build_mesh(raw, notes), degree);
            const QualityStatistics of = mesh_quality(mesh, mesh.x);
            CHECK(of.min == doctest::Approx(1).epsilon(1e-13));
            CHECK(of.max_edge == doctest::Approx(3).epsilon(1e-13));
            CHECK(mesh_quality(mesh, stretched(mesh.x, 3)).min < 0.9);
        }
    }
}

TEST_CASE("quality of right simplices is the closed form of Eq. (1)") {
    // F maps the regular simplex to the unit one. Triangle: |F|^2 = 8/3, det F = 2/sqrt 3; tetrahedron: 9/2 and sqrt 2.
    const Mesh triangle = single(2, {0, 0, 1, 0, 0, 1});
    CHECK(mesh_quality(triangle, triangle.x).min == doctest::Approx(std::sqrt(0.75)));
    const Mesh tetrahedron = single(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    CHECK(mesh_quality(tetrahedron, tetrahedron.x).min == doctest::Approx(2 * std::cbrt(2.0) / 3));
}

TEST_CASE("size and skew: the root of the smaller ratio of sizes times the shape, over the elements") {
    const double height = std::sqrt(0.75);
    for (int degree : {1, 3}) {
        const Mesh triangle = with_degree(single(2, {0, 0, 1, 0, 0.5, height}), degree);
        const Mesh tetrahedron = with_degree(single(3, {1, 1, 1, 1, -1, -1, -1, -1, 1, -1, 1, -1}), degree);
        for (const Mesh& mesh : {triangle, tetrahedron}) {
            for (const double size : {0.5, 2.0, 1.0}) {
                const std::vector<double> x = mapped(mesh, [&](double* p) {
                    for (int a = 0; a < mesh.dim; ++a) p[a] *= size;
                });
                const double expected = std::sqrt(std::pow(std::min(size, 1 / size), mesh.dim));
                CHECK(size_skew(mesh, mesh.x, x).min == doctest::Approx(expected));
                CHECK(size_skew(mesh, x, mesh.x).mean == doctest::Approx(expected));
            }
            const std::vector<double> stretched = mapped(mesh, [](double* p) { p[0] *= 3; });
            CHECK(size_skew(mesh, mesh.x, stretched).min ==
                  doctest::Approx(std::sqrt(1.0 / 3) * mesh_quality(mesh, stretched).min));
            const std::vector<double> inverted = mapped(mesh, [](double* p) { p[0] *= -1; });
            CHECK(size_skew(mesh, mesh.x, inverted).min == 0);
        }
    }
    const Mesh two = linear_mesh(2, {0, 0, 1, 0, 0.5, height, 1.5, height}, {0, 1, 2, 1, 3, 2},
                                 [](const double*) { return "wall"; });
    std::vector<double> x = two.x;
    x[6] = 0.5, x[7] = 0;  // folds the second
    CHECK(size_skew(two, two.x, x).mean == doctest::Approx(0.5));
    CHECK(size_skew(two, two.x, x).min == 0);
}

TEST_CASE("quality does not depend on the degree of straight elements, and stretching gives 2 s / (1 + s^2)") {
    const double height = std::sqrt(0.75);
    for (int degree : {1, 3}) {
        const Mesh triangle = with_degree(single(2, {0, 0, 1, 0, 0.5, height}), degree);
        const Mesh tetrahedron = with_degree(single(3, {1, 1, 1, 1, -1, -1, -1, -1, 1, -1, 1, -1}), degree);
        for (const Mesh& mesh : {triangle, tetrahedron}) {
            CHECK(mesh_quality(mesh, mesh.x).min == doctest::Approx(1));
            const std::vector<double> x = mapped(mesh, [](double* p) { p[0] *= 3; });
            const double expected = mesh.dim == 2 ? 2 * 3.0 / (1 + 9) : 3 * std::cbrt(9.0) / (9 + 2);
            CHECK(mesh_quality(mesh, x).min == doctest::Approx(expected));
        }
    }
}

TEST_CASE("inverted elements have quality zero") {
    const Mesh mesh = square_mesh(4);
    std::vector<double> x = mesh.x;
    x[2 * 12] += 0.6;  // the centre node leaves its patch
    const QualityStatistics statistics = mesh_quality(mesh, x);
    CHECK(statistics.min == 0);
    CHECK(std::accumulate(statistics.histogram.begin(), statistics.histogram.end(), 0) == mesh.element_count());
    CHECK(mesh_quality(single(2, {0, 0, 1, 0, 0, 1}), {0, 0, 1, 0, 2, 0}).min == 0);
}

TEST_CASE("edges and the printed histogram") {
    const Mesh mesh = square_mesh(2);
    const QualityStatistics statistics = mesh_quality(mesh, mesh.x);
    CHECK(statistics.min_edge == doctest::Approx(0.5));
    CHECK(statistics.max_edge == doctest::Approx(std::sqrt(0.5)));
    CHECK(statistics.histogram[8] == 8);
    const std::string text = histogram_text(statistics);
    CHECK(std::count(text.begin(), text.end(), '\n') == 10);
    CHECK(text.find("0.8 - 0.9         8  " + std::string(50, '#') + "\n") != std::string::npos);
    CHECK(text.find("0.9 - 1.0         0\n") != std::string::npos);
}
