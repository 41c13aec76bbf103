// The library in one header: arrays in, arrays out.
#include "almesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "examples/ring.hpp"

using namespace almesh;

namespace {

// n x n x (n) cells in the unit square or cube; in the last column of quadrilaterals each is two triangles, in the last
// layer of hexahedra each is two prisms. Sides have no names.
MeshArrays grid(int dim, int n) {
    MeshArrays mesh;
    mesh.dim = dim;
    const auto node = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
    for (int k = 0; k <= (dim == 3 ? n : 0); ++k)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                for (const int number : dim == 3 ? std::vector<int>{i, j, k} : std::vector<int>{i, j})
                    mesh.x.push_back(static_cast<double>(number) / n);
    Cells whole{dim == 3 ? Cell::hexahedron : Cell::quadrilateral, {}}, half{dim == 3 ? Cell::prism : Cell::triangle, {}};
    const auto add = [](Cells& cells, std::vector<int> nodes) {
        cells.nodes.insert(cells.nodes.end(), nodes.begin(), nodes.end());
    };
    for (int k = 0; k < (dim == 3 ? n : 1); ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int a = node(i, j, k), b = node(i + 1, j, k), c = node(i + 1, j + 1, k), d = node(i, j + 1, k);
                const int up = dim == 3 ? node(0, 0, 1) : 0;
                if (dim == 2 && i < n - 1) add(whole, {a, b, c, d});
                else if (dim == 2) add(half, {a, b, c, a, c, d});
                else if (i < n - 1) add(whole, {a, b, c, d, a + up, b + up, c + up, d + up});
                else add(half, {a, b, c, a + up, b + up, c + up, a, c, d, a + up, c + up, d + up});
            }
    mesh.elements = {half, whole};  // in the order of the caller, whatever the library's is
    return mesh;
}

Boundary turns(double degrees, double x = 0, double y = 0) {
    return Boundary::moves(
        [=](const Point& X, double t) -> Point {
            const double a = t * degrees * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
            return {x + c * (X[0] - x) - s * (X[1] - y), y + s * (X[0] - x) + c * (X[1] - y), X[2]};
        },
        degrees);
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
}

template <class Call>
std::string refusal(const Call& call) try {
    call();
    return "";
} catch (const std::runtime_error& error) {
    return error.what();
}

}  // namespace

TEST_CASE("a rigid motion of all sides moves every node of arrays of several cells and degrees, in their order") {
    for (const int dim : {2, 3})
        for (const int degree : {1, 2, 3}) {
            if (dim == 3 && degree == 3) continue;
            CAPTURE(dim);
            CAPTURE(degree);
            Options options;
            options.degree = degree;
            MovingMesh mesh(grid(dim, 2), options);
            mesh.set("rest", turns(30, 0.5, 0.5));
            const Moved moved = mesh.move();
            CHECK(moved.is_good());
            CHECK(moved.nodes_off_target == 0);
            CHECK(moved.max_distortion == doctest::Approx(1).epsilon(1e-7));
            std::vector<double> expected = mesh.arrays().x;
            const Boundary turn = turns(30, 0.5, 0.5);
            for (std::size_t i = 0; i < expected.size(); i += dim) {
                Point X{};
                std::copy_n(&expected[i], dim, X.begin());
                const Point to = turn.position(X, 1);
                std::copy_n(to.begin(), dim, &expected[i]);
            }
            CHECK(largest_difference(moved.x, expected) < 1e-5);  // (eta - 1)^2 is flat around a rigid motion
            CHECK(moved.verdict.certified_bound.size() == (dim == 2 ? 6 : 12));
        }
}

TEST_CASE("nodes of the arrays without an element stay, and faces without a name are boundaries") {
    MeshArrays arrays = grid(2, 2);
    arrays.x.insert(arrays.x.end(), {7, 7});
    MovingMesh mesh(arrays);
    mesh.set("boundary", Boundary::moves([](const Point& X, double t) -> Point { return {X[0] + t, X[1]}; }));
    const Moved moved = mesh.move();
    CHECK(moved.is_good());
    CHECK(moved.x[moved.x.size() - 2] == 7);
    CHECK(moved.x[0] == 1);
    std::vector<double> target = arrays.x;
    for (std::size_t k = 0; k < target.size(); k += 2) target[k] += 1;
    arrays.x.insert(arrays.x.begin(), {7, 7});  // before all others, as if a file had it
    target.insert(target.begin(), {7, 7});
    for (Cells& cells : arrays.elements)
        for (int& node : cells.nodes) ++node;
    MovingMesh shifted(arrays);
    shifted.set("boundary", Boundary::moves_to(target));
    CHECK(shifted.move().x[2] == 1);
}

TEST_CASE("a target as an array and a position as a function are one motion") {
    const MeshArrays arrays = examples::ring(1, 8, 16, 6);
    std::vector<double> target = arrays.x;
    for (int i = 0; i < 16; ++i) target[2 * i] += 2;
    MovingMesh by_array(arrays), by_function(arrays);
    by_array.set("inner", Boundary::moves_to(target));
    by_function.set("inner", Boundary::moves([](const Point& X, double t) -> Point { return {X[0] + 2 * t, X[1]}; }));
    for (MovingMesh* mesh : {&by_array, &by_function}) mesh->set("outer", Boundary::fixed());
    const Moved a = by_array.move(), b = by_function.move();
    CHECK(a.is_good());
    CHECK(b.is_good());
    CHECK(largest_difference(a.x, b.x) < 1e-8);
}

TEST_CASE("a turn by 330 degrees is as far as it says, followed in time or in one call, and does not unwind") {
    Options options;
    options.continuation = Options::Continuation::always;
    MovingMesh mesh(examples::ring(1, 8, 16, 6), options);
    mesh.set("outer", Boundary::fixed());
    mesh.set("inner", turns(330));
    const Moved at_once = mesh.move();
    CHECK(at_once.is_good());
    Moved now = mesh.move(0);
    for (int step = 1; step <= 5; ++step) now = mesh.follow(now, step / 5.0);
    CHECK(now.is_good());
    CHECK(at_once.max_distortion > 9);  // 1.05 where it has unwound
    CHECK(now.max_distortion > 9);
}

TEST_CASE("a mesh is the same whatever was moved before, and follows back to where it came from") {
    MovingMesh mesh(examples::ring(1, 8, 16, 6));
    mesh.set("outer", Boundary::slides());
    mesh.set("inner", turns(60));
    const Moved first = mesh.move(), half = mesh.move(0.5);
    CHECK(first.is_good());
    CHECK(mesh.move().x == first.x);
    const Moved back = mesh.follow(first, 0.5);
    CHECK(largest_difference(back.x, half.x) < 1e-5);
    CHECK(mesh.certify(back.x).valid);
    CHECK(mesh.certify(back.x).certified_bound == back.verdict.certified_bound);
    mesh.set("outer", Boundary::fixed());  // another kind of boundary
    CHECK(mesh.move().max_distortion > first.max_distortion);
}

TEST_CASE("a motion that is too far for one step is followed in halves") {
    MovingMesh mesh(examples::ring(1, 4, 12, 4));
    mesh.set("outer", Boundary::fixed());
    mesh.set("inner", turns(300));
    Moved now = mesh.follow(mesh.move(0), 1);
    CHECK(now.is_good());
}

TEST_CASE("derivatives along a velocity and of a function agree with differences of meshes") {
    MovingMesh mesh(examples::ring(1, 8, 16, 6));
    mesh.set("outer", Boundary::slides());
    mesh.set("inner", Boundary::moves([](const Point& X, double t) -> Point { return {X[0] + 3 * t, X[1] - t}; }));
    Moved moved = mesh.move(0.5);
    std::vector<double> velocity(moved.x.size(), 0.0), dJ_dx(moved.x.size());
    for (int i = 0; i < 16; ++i) velocity[2 * i] = 3, velocity[2 * i + 1] = -1;
    for (std::size_t k = 0; k < dJ_dx.size(); ++k) dJ_dx[k] = std::sin(static_cast<double>(k));
    const std::vector<double> dx = mesh.tangent(moved, velocity), dJ_dg = mesh.adjoint(moved, dJ_dx);
    constexpr double h = 1e-4;
    Moved ahead = mesh.follow(moved, 0.5 + h), behind = mesh.follow(moved, 0.5 - h);
    for (Moved* at : {&ahead, &behind}) mesh.tangent(*at, velocity);  // which makes them stationary to rounding
    double error = 0, by_tangent = 0, by_adjoint = 0;
    for (std::size_t k = 0; k < dx.size(); ++k) {
        error = std::max(error, std::abs(dx[k] - (ahead.x[k] - behind.x[k]) / (2 * h)));
        by_tangent += dJ_dx[k] * dx[k];
        by_adjoint += dJ_dg[k] * velocity[k];
    }
    CHECK(error < 1e-4);
    CHECK(by_tangent == doctest::Approx(by_adjoint).epsilon(1e-10));
}

TEST_CASE("what an observer throws ends the call, and the mesh moves again") {
    MovingMesh mesh(examples::ring(1, 8, 16, 6));
    mesh.set("outer", Boundary::fixed());
    mesh.set("inner", turns(45));
    int calls = 0;
    CHECK_THROWS_AS(mesh.move(1, [&](const Progress&) {
        if (++calls == 3) throw std::domain_error("enough");
    }), std::domain_error);
    CHECK(calls == 3);
    const Moved moved = mesh.move();
    CHECK(moved.is_good());
    MovingMesh other = std::move(mesh);
    CHECK(other.move().x == moved.x);
}

TEST_CASE("a certificate of arrays: inverted between its nodes, overlapping, undecided by none") {
    MeshArrays curved = examples::ring(1, 2, 8, 1);
    CHECK(certify(curved).valid);
    CHECK(certify(curved).injective);
    curved.x[0] = 3;  // the inner node beyond the outer circle
    const Verdict inverted = certify(curved);
    CHECK(!inverted.valid);
    CHECK(inverted.reason.find("invalid") != std::string::npos);
    CHECK(*std::min_element(inverted.certified_bound.begin(), inverted.certified_bound.end()) < 0);
}

TEST_CASE("arrays and boundaries that are wrong are refused with what, where and what to do") {
    const MeshArrays ring = examples::ring(1, 8, 16, 6);
    const auto refused = [](const MeshArrays& arrays) { return refusal([&] { MovingMesh mesh(arrays); }); };
    MeshArrays bad = ring;
    bad.elements[0].nodes[5] = 1000;
    CHECK(refused(bad) == "mesh arrays: elements: node 1000, of 112");
    bad = ring;
    bad.elements[0].nodes.pop_back();
    CHECK(refused(bad) == "mesh arrays: elements: 575 nodes, but each triangle of degree 1 has 3");
    bad = ring;
    bad.x[7] = std::nan("");
    CHECK(refused(bad) == "mesh arrays: node 3 is not at a finite position, or beyond 1e50");
    bad = ring;
    bad.dim = 4;
    CHECK(refused(bad) == "mesh arrays: dim = 4: a mesh has 2 or 3 dimensions");
    bad = ring;
    bad.faces[0].cells.type = Cell::triangle;
    CHECK(refused(bad) == "mesh arrays: faces of `inner`: a triangle in 1 dimensions");
    bad = ring;
    bad.x[0] = 9;
    CHECK(refused(bad) != "");
    CHECK(refused({}) == "mesh arrays: 0 coordinates are not those of nodes in 2 dimensions");

    MovingMesh mesh(ring);
    CHECK(refusal([&] { mesh.move(); }).find("boundary \"inner\" is not set") == 0);
    mesh.set("inner", Boundary::fixed());
    mesh.set("outer", Boundary::fixed());
    mesh.set("outre", Boundary::fixed());
    CHECK(refusal([&] { mesh.move(); }).find("outre") != std::string::npos);
    CHECK(refusal([&] { mesh.set("inner", Boundary::moves({})); }) ==
          "boundary \"inner\" moves: give it a position or a target, one of them");
    CHECK(refusal([&] { mesh.set("inner", Boundary::moves_to({1, 2})); }) ==
          "boundary \"inner\": a target of 2 numbers, but the mesh has 224: nodes x dim");
}
