#include "check/infeasible.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/boundary.hpp"
#include "support/determinant.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// One element, the reference one.
Mesh one_element(int dim, int degree) {
    std::vector<double> x((dim + 1) * dim, 0.0);
    for (int k = 0; k < dim; ++k) x[(k + 1) * dim + k] = 1;
    std::vector<int> vertices = {0, 1, 2, 3};
    vertices.resize(dim + 1);
    return with_degree(linear_mesh(dim, x, vertices, [](const double*) { return "all"; }), degree);
}

int node_at(const Mesh& mesh, const Vec<3>& place) {
    for (int i = 0; i < mesh.nodes(); ++i) {
        double distance = 0;
        for (int a = 0; a < mesh.dim; ++a) distance += std::abs(point(mesh.x, i, mesh.dim)[a] - place[a]);
        if (distance < 1e-9) return i;
    }
    return -1;
}

using Face = std::vector<int>;  // its vertices, places in the element

std::vector<Face> faces_of_any_dimension(int dim) {
    std::vector<Face> faces;
    for (int subset = 1; subset < 1 << (dim + 1); ++subset) {
        faces.emplace_back();
        for (int k = 0; k <= dim; ++k)
            if (subset >> k & 1) faces.back().push_back(k);
    }
    return faces;
}

// Points of a face of the reference element, dim coordinates each; `fine` intervals along its edges.
std::vector<std::vector<double>> grid_on(const Face& face, int dim, int fine) {
    std::vector<std::vector<double>> points;
    const int m = static_cast<int>(face.size()) - 1;
    for (const MultiIndex& a : gmsh_node_order(std::max(m, 1), m == 0 ? 1 : fine)) {
        double l[4] = {};
        for (int k = 0; k <= m; ++k) l[face[k]] = static_cast<double>(a[k]) / (m == 0 ? 1 : fine);
        if (m == 0) l[face[0]] = 1;
        points.emplace_back(l + 1, l + 1 + dim);
    }
    return points;
}

// The nodes whose basis functions have a gradient somewhere on the face: on which the determinant there depends.
std::vector<int> nodes_that_count(const LagrangeBasis& basis, const Face& face) {
    std::vector<int> nodes;
    std::vector<double> dN(basis.count * basis.dim);
    for (int i = 0; i < basis.count; ++i) {
        double largest = 0;
        for (const std::vector<double>& xi : grid_on(face, basis.dim, 7)) {
            basis.gradients(xi.data(), dN.data());
            for (int k = 0; k < basis.dim; ++k) largest = std::max(largest, std::abs(dN[i * basis.dim + k]));
        }
        if (largest > 1e-9) nodes.push_back(i);
    }
    return nodes;
}

// An element with nodes moved at random, and places of some of them prescribed.
struct RandomElement {
    Mesh mesh;
    LagrangeBasis basis;
    std::vector<double> x;
    std::vector<char> prescribed;
    std::vector<Face> determined;

    RandomElement(int dim, int degree, std::mt19937& random)
        : mesh(one_element(dim, degree)), basis(dim, degree), x(mesh.x), prescribed(mesh.nodes(), 0) {
        const std::vector<Face> faces = faces_of_any_dimension(dim);
        std::uniform_real_distribution<double> number(-1, 1);
        move([](int) { return true; }, 0.35 / degree, random);
        for (const int i : nodes_that_count(basis, faces[random() % faces.size()])) prescribed[node(i)] = 1;
        for (int i = 0; i < mesh.nodes(); ++i)
            if (number(random) > 0.8) prescribed[i] = 1;
        for (const Face& face : faces) {
            const std::vector<int> counts = nodes_that_count(basis, face);
            if (std::all_of(counts.begin(), counts.end(), [&](int i) { return prescribed[node(i)]; }))
                determined.push_back(face);
        }
    }

    int node(int i) const { return mesh.element(0)[i]; }

    template <class Moves>
    void move(const Moves& moves, double amplitude, std::mt19937& random) {
        std::uniform_real_distribution<double> number(-amplitude, amplitude);
        for (int i = 0; i < mesh.nodes(); ++i)
            for (int a = 0; a < mesh.dim && moves(i); ++a) point(x, i, mesh.dim)[a] += number(random);
    }

    // On the determined faces, over that of the straight element.
    std::vector<double> scaled_determinants(int fine) const {
        std::vector<double> values;
        with_dimension(mesh.dim, [&](auto n) {
            const double straight = std::abs(determinant(straight_jacobian<n>(mesh.element(0), x)));
            for (const Face& face : determined)
                for (const std::vector<double>& xi : grid_on(face, n, fine))
                    values.push_back(determinant_at<n>(basis, mesh.element(0), x, xi.data()) / straight);
        });
        return values;
    }
};

}  // namespace

TEST_CASE("random elements: what is told is attained where it is determined, and nothing is passed over") {
    std::mt19937 random(7);
    for (const int dim : {2, 3})
        for (const int degree : {1, 2, 3}) {
            CAPTURE(dim);
            CAPTURE(degree);
            int told = 0, nothing_determined = 0, valid = 0;
            for (int k = 0; k < 60; ++k) {
                const RandomElement any(dim, degree, random);
                const double bound = 0.2 * (k % 3 - 1), coarse = 0.05;
                const std::vector<double> samples = any.scaled_determinants(dim == 2 ? 24 : 12);
                const auto found = infeasible_elements(any.mesh, any.x, any.prescribed, bound);
                REQUIRE(found.size() <= 1);
                told += !found.empty();
                nothing_determined += samples.empty();
                if (samples.empty()) CHECK(found.empty());
                if (samples.empty()) continue;
                const double least = *std::min_element(samples.begin(), samples.end());
                valid += least > bound;
                if (least <= bound) REQUIRE(found.size() == 1);
                if (found.empty()) continue;
                CHECK(found[0].element == 0);
                CHECK(found[0].scaled_determinant <= bound);
                CHECK(found[0].scaled_determinant > least - coarse);
            }
            CHECK((degree == 1 || told > 5));
            CHECK(nothing_determined + valid > 5);
        }
}

TEST_CASE("what is determined does not change with the nodes that are not prescribed") {
    std::mt19937 random(8);
    for (const int dim : {2, 3})
        for (const int degree : {1, 2, 3})
            for (int k = 0; k < 20; ++k) {
                RandomElement any(dim, degree, random);
                const auto before = infeasible_elements(any.mesh, any.x, any.prescribed, 0.3);
                const std::vector<double> values = any.scaled_determinants(4);
                any.move([&](int i) { return !any.prescribed[i]; }, 0.5, random);
                const auto after = infeasible_elements(any.mesh, any.x, any.prescribed, 0.3);
                const std::vector<double> moved = any.scaled_determinants(4);
                for (std::size_t q = 0; q < values.size(); ++q)
                    CHECK(moved[q] == doctest::Approx(values[q]).epsilon(1e-12).scale(1));
                REQUIRE(before.size() == after.size());
                for (std::size_t e = 0; e < before.size(); ++e)
                    CHECK(after[e].scaled_determinant ==
                          doctest::Approx(before[e].scaled_determinant).epsilon(1e-12).scale(1));
            }
}

// The middle of the edge between the vertices 0 and 1 raised by h: at vertex 1 det J = 1 - 4 h.
TEST_CASE("a vertex of a curved triangle: its value, the bound, and that the straight element is valid") {
    const Mesh mesh = one_element(2, 2);
    const int raised = node_at(mesh, {0.5, 0}), opposite = node_at(mesh, {0, 0.5});
    std::vector<char> prescribed(mesh.nodes(), 1);
    prescribed[opposite] = 0;
    const auto found = [&](double h, double bound) {
        std::vector<double> x = mesh.x;
        point(x, raised, 2)[1] = h;
        return infeasible_elements(mesh, x, prescribed, bound);
    };
    REQUIRE(found(0.4, 0).size() == 1);
    CHECK(found(0.4, 0)[0].scaled_determinant == doctest::Approx(-0.6));
    CHECK(found(0.4, 0)[0].by_curvature);
    CHECK(found(0.2, 0).empty());
    CHECK(found(0.2, 0.19).empty());
    REQUIRE(found(0.2, 0.21).size() == 1);
    CHECK(found(0.2, 0.21)[0].scaled_determinant == doctest::Approx(0.2));
    CHECK(found(0.4, -0.59).size() == 1);
    CHECK(found(0.4, -0.61).empty());
    for (const int i : {raised, 0, 1, 2, node_at(mesh, {0.5, 0.5})}) {  // any node that counts slides or is free
        prescribed[i] = 0;
        CHECK(found(0.4, 0).empty());
        prescribed[i] = 1;
    }
}

// By polynomial maps of the element's degree with which det J along the edge is (1 - x/0.3)(1 - x/0.7), or
// 1 - 6x(1 - x).
TEST_CASE("the edge of two prescribed faces of a tetrahedron, folded between its ends") {
    for (const int degree : {2, 3}) {
        const Mesh mesh = one_element(3, degree);
        const std::vector<int> counts = nodes_that_count(LagrangeBasis(3, degree), {0, 1});
        std::vector<char> prescribed(mesh.nodes(), 0);
        for (const int i : counts) prescribed[mesh.element(0)[i]] = 1;
        REQUIRE(std::count(prescribed.begin(), prescribed.end(), 0) == (degree == 2 ? 1 : 4));
        const std::vector<double> x = mapped(mesh, [&](double* at) {
            at[1] *= degree == 2 ? 1 - at[0] / 0.7 : 1;
            at[2] *= degree == 2 ? 1 - at[0] / 0.3 : 1 - 6 * at[0] * (1 - at[0]);
        });
        const double least = degree == 2 ? -4.0 / 21 : -0.5;
        const auto found = infeasible_elements(mesh, x, prescribed);
        REQUIRE(found.size() == 1);
        CHECK(found[0].by_curvature);
        CHECK(found[0].scaled_determinant <= 0);
        CHECK(found[0].scaled_determinant >= least - 1e-12);
        CHECK(infeasible_elements(mesh, x, prescribed, 0.95 * least).size() == 1);
        CHECK(infeasible_elements(mesh, x, prescribed, 1.05 * least).empty());
        for (const int i : counts) {
            std::vector<char> fewer = prescribed;
            fewer[mesh.element(0)[i]] = 0;
            CHECK(infeasible_elements(mesh, x, fewer).empty());
        }
    }
}

// By the map z^2 / 2 + a conj(z) of the complex plane about the centre, det J is |z|^2 - a^2.
TEST_CASE("a whole triangle of degree 2, folded in a disc inside it") {
    const Mesh mesh = one_element(2, 2);
    const double a = 0.1;
    const std::vector<double> x = mapped(mesh, [a](double* at) {
        const double X = at[0] - 1.0 / 3, Y = at[1] - 1.0 / 3;
        at[0] = (X * X - Y * Y) / 2 + a * X;
        at[1] = X * Y - a * Y;
    });
    const double least = -a * a / std::abs(determinant(straight_jacobian<2>(mesh.element(0), x)));
    std::vector<char> prescribed(mesh.nodes(), 1);
    const auto found = infeasible_elements(mesh, x, prescribed);
    REQUIRE(found.size() == 1);
    CHECK(found[0].scaled_determinant <= 0);
    CHECK(found[0].scaled_determinant >= least * (1 + 1e-12));
    CHECK(infeasible_elements(mesh, x, prescribed, 0.95 * least).size() == 1);
    CHECK(infeasible_elements(mesh, x, prescribed, 1.05 * least).empty());
    for (int i = 0; i < mesh.nodes(); ++i) {
        prescribed[i] = 0;
        CHECK(infeasible_elements(mesh, x, prescribed).empty());
        prescribed[i] = 1;
    }
}

TEST_CASE("corners of squares and cubes that are pushed through their elements, in every degree") {
    for (const bool in_space : {false, true})
        for (const int degree : {1, 2, 3}) {
            CAPTURE(in_space);
            CAPTURE(degree);
            const Mesh linear = in_space ? cube_mesh(2) : square_mesh(2);
            Mesh pushed = linear;
            const Vec<3> by = in_space ? Vec<3>{-0.35, 0.3, 0.25} : Vec<3>{-0.3, 0.3, 0};
            const int corner = node_at(linear, {1, 0, 0});
            for (int a = 0; a < linear.dim; ++a) point(pushed.x, corner, linear.dim)[a] += by[a];
            const Mesh mesh = with_degree(linear, degree);
            const std::vector<double> target = with_degree(pushed, degree).x;
            const std::vector<char> prescribed = on_boundary(mesh);
            const auto found = infeasible_elements(mesh, target, prescribed);
            REQUIRE(!found.empty());
            for (std::size_t k = 0; k < found.size(); ++k) {
                const int* const vertex = mesh.element(found[k].element);
                CHECK(found[k].scaled_determinant == doctest::Approx(-1));
                CHECK(!found[k].by_curvature);
                CHECK(std::count(vertex, vertex + mesh.dim + 1, corner) == 1);
                CHECK((k == 0 || found[k - 1].element < found[k].element));
            }
            CHECK(infeasible_elements(mesh, mesh.x, prescribed).empty());
            std::vector<char> free_corner = prescribed;
            free_corner[corner] = 0;
            CHECK(infeasible_elements(mesh, target, free_corner).empty());
        }
}

TEST_CASE("a linear element without volume is told with 0") {
    const Mesh mesh = one_element(2, 1);
    std::vector<double> flat = mesh.x;
    point(flat, 2, 2)[0] = 0.3;
    point(flat, 2, 2)[1] = 0;
    const auto found = infeasible_elements(mesh, flat, {1, 1, 1});
    REQUIRE(found.size() == 1);
    CHECK(found[0].scaled_determinant == 0);
    CHECK(!found[0].by_curvature);
    CHECK(infeasible_elements(mesh, flat, {1, 1, 0}).empty());
}
