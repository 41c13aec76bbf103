#include "check/certificate.hpp"
#include "check/injectivity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mesh/build.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Injectivity judge(const Mesh& mesh, const std::vector<double>& x) {
    const Certificate certificate = certify(mesh, x);
    REQUIRE(certificate.valid);
    return certify_injective(mesh, x, certificate);
}

bool mentions(const Injectivity& injectivity, const std::string& text) {
    return injectivity.reason.find(text) != std::string::npos;
}

// Every point of the plane is turned about `centre` by as much again as its angle.
std::vector<double> wound_twice(const Mesh& mesh, double centre) {
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const p = &x[i * mesh.dim];
        const double r = std::hypot(p[0] - centre, p[1] - centre), angle = 2 * std::atan2(p[1] - centre, p[0] - centre);
        p[0] = centre + r * std::cos(angle);
        p[1] = centre + r * std::sin(angle);
    }
    return x;
}

// `around` triangles about a node at the origin.
Mesh disc(int around) {
    std::vector<double> x = {0, 0};
    std::vector<int> elements;
    for (int i = 0; i < around; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.1) / around;
        x.insert(x.end(), {std::cos(angle), std::sin(angle)});
        elements.insert(elements.end(), {0, 1 + i, 1 + (i + 1) % around});
    }
    return linear_mesh(2, x, elements, [](const double*) { return "rim"; });
}

// Two layers of prisms over the disc, each cut into three tetrahedra.
Mesh cylinder(int around) {
    const Mesh flat = disc(around);
    const int nodes = flat.nodes();
    std::vector<double> x;
    for (int layer = 0; layer < 3; ++layer)
        for (int i = 0; i < nodes; ++i) x.insert(x.end(), {flat.x[2 * i], flat.x[2 * i + 1], 0.5 * layer});
    std::vector<int> elements;
    for (int layer = 0; layer < 2; ++layer)
        for (int e = 0; e < flat.element_count(); ++e) {
            std::vector<int> v(flat.element(e), flat.element(e) + 3);
            std::sort(v.begin(), v.end());
            const int a = v[0] + layer * nodes, b = v[1] + layer * nodes, c = v[2] + layer * nodes, up = nodes;
            const std::array<int, 4> cut[3] = {{a, b, c, c + up}, {a, b, b + up, c + up}, {a, a + up, b + up, c + up}};
            for (std::array<int, 4> tet : cut) {
                if (determinant(straight_jacobian<3>(tet.data(), x)) < 0) std::swap(tet[0], tet[1]);
                elements.insert(elements.end(), tet.begin(), tet.end());
            }
        }
    return linear_mesh(3, x, elements, [](const double*) { return "wall"; });
}

RawMesh raw_mesh(const std::vector<double>& x) {
    RawMesh raw;
    raw.path = "made.msh";
    raw.groups = {{2, 1, "wall"}, {3, 2, "all"}};
    for (std::size_t i = 0; i < x.size(); i += 3)
        raw.nodes.push_back({static_cast<long long>(i / 3) + 1, {x[i], x[i + 1], x[i + 2]}, 0});
    return raw;
}

void add(RawMesh& raw, const CellType& cell, const std::vector<int>& nodes) {
    raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, cell.dim, 1,
                            cell.dim - 1, 0, &cell});
    raw.element_nodes.insert(raw.element_nodes.end(), nodes.begin(), nodes.end());
}

Mesh built(const RawMesh& raw) {
    std::vector<std::string> notes;
    return build_mesh(raw, notes);
}

// Two layers of prisms over the disc, or one of pyramids and tetrahedra around the middle of its axis, the last node.
Mesh round_block(int around, bool of_prisms) {
    const Mesh flat = disc(around);
    const int nodes = flat.nodes(), layers = of_prisms ? 2 : 1;
    std::vector<double> x;
    for (int layer = 0; layer <= layers; ++layer)
        for (int i = 0; i < nodes; ++i)
            x.insert(x.end(), {flat.x[2 * i], flat.x[2 * i + 1], 1.0 * layer / layers});
    const int middle = static_cast<int>(x.size()) / 3, top = layers * nodes;
    if (!of_prisms) x.insert(x.end(), {0, 0, 0.5});
    RawMesh raw = raw_mesh(x);
    for (int e = 0; e < around; ++e) {
        const int* const v = flat.element(e);
        for (int layer = 0; layer < layers; ++layer) {
            const int low = layer * nodes, up = low + nodes;
            add(raw, quadrilateral(), {v[1] + low, v[2] + low, v[2] + up, v[1] + up});
            if (of_prisms) add(raw, prism(), {v[0] + low, v[1] + low, v[2] + low, v[0] + up, v[1] + up, v[2] + up});
            else add(raw, pyramid(), {v[1], v[1] + up, v[2] + up, v[2], middle});
        }
        add(raw, simplex(2), {v[0], v[2], v[1]});
        add(raw, simplex(2), {v[0] + top, v[1] + top, v[2] + top});
        if (of_prisms) continue;
        add(raw, simplex(3), {v[0], v[1], v[2], middle});
        add(raw, simplex(3), {v[0] + top, v[2] + top, v[1] + top, middle});
    }
    return built(raw);
}

// both(scale, shift): a mesh of the unit square or cube, and once more, scaled and moved.
template <class Both>
void check_lying_over(const Both& both) {
    const auto certified = [&](double scale, double dx, double dy, double dz) {
        const Mesh mesh = both(scale, {dx, dy, dz});
        return certify_injective(mesh, mesh.x, certify(mesh, mesh.x)).certified;
    };
    CHECK(!certified(1, 0.5, 0, 0));        // their boundaries lie on each other, but do not cross
    CHECK(!certified(0.5, 0.2, 0.2, 0.2));  // inside
    CHECK(!certified(1, 0, 0, 0));          // the same twice
    CHECK(certified(1, 3, 0, 0));
    CHECK(certified(1, 1, 0, 0));  // in contact
    CHECK(!certified(1, 0.999, 0, 0));
}

// A block of solids, and once more, scaled and moved.
Mesh two_blocks(const std::string& layers, double scale, const Vec<3>& shift) {
    const RawMesh block = solid_block(1, layers);
    RawMesh both = block;
    for (RawNode node : block.nodes) {
        for (int a = 0; a < 3; ++a) node.x[a] = scale * node.x[a] + shift[a];
        node.id += static_cast<long long>(block.nodes.size());
        both.nodes.push_back(node);
    }
    for (const RawElement& element : block.elements) {
        both.elements.push_back(element);
        both.elements.back().id += static_cast<long long>(block.elements.size());
        both.elements.back().first = both.element_nodes.size();
        for (int i = 0; i < element.node_count(); ++i)
            both.element_nodes.push_back(block.element_nodes[element.first + i] +
                                         static_cast<int>(block.nodes.size()));
    }
    return built(both);
}

}  // namespace

TEST_CASE("valid meshes whose boundary is in its place are certified, in every degree") {
    for (const int degree : {1, 2, 3})
        for (const Mesh& linear : {square_mesh(3), ring_mesh(9, 2, 3), cube_mesh(2), disc(7), cylinder(6)}) {
            const Mesh mesh = raise_degree(linear, degree);
            for (const std::vector<double>& x : {mesh.x, wavy(mesh.x, mesh.dim, 0.005)}) {
                const Injectivity found = judge(mesh, x);
                CHECK(found.certified);
                CHECK(found.reason.empty());
            }
        }
}

TEST_CASE("an inverted element settles it") {
    const Mesh mesh = square_mesh(2);
    std::vector<double> x = mesh.x;
    for (std::size_t i = 0; i < x.size(); i += 2) x[i] *= -1;
    const Injectivity found = certify_injective(mesh, x, certify(mesh, x));
    CHECK(!found.certified);
    CHECK(found.reason == "elements are not certified valid");
    CHECK(overlap_text(mesh, found) == found.reason);
}

TEST_CASE("a node that its elements go around twice is found though all of them are valid") {
    const Mesh flat = disc(12);
    const Injectivity found = judge(flat, wound_twice(flat, 0));
    CHECK(!found.certified);
    CHECK(mentions(found, "the elements around node 1 overlap"));
    CHECK(found.node == 0);
    CHECK(overlap_text(flat, found, {.origin = {5, 6, 0}, .length = 3}) ==
          "the elements around node 1 overlap at (5, 6)");
    const Mesh curved = raise_degree(flat, 2);
    CHECK(mentions(judge(curved, straight_sided([&] {
                             Mesh moved = curved;
                             moved.x = wound_twice(curved, 0);
                             return moved;
                         }())),
                   "around node 1 overlap"));

    const Mesh tall = cylinder(12);  // the node in the middle of the axis has two full spheres of elements
    CHECK(mentions(judge(tall, wound_twice(tall, 0)), "the elements around node 14 overlap"));
}

// A strip bent into a ring and beyond: its ends overlap, no node has more than its share.
TEST_CASE("a boundary that overlaps itself is found though elements and angles are in order") {
    Mesh strip = square_mesh(8);
    const auto bent = [&](double turns) {
        std::vector<double> x = strip.x;
        for (std::size_t i = 0; i < x.size(); i += 2) {
            const double r = 5 - strip.x[i + 1], angle = 2 * std::numbers::pi * turns * strip.x[i];
            x[i] = r * std::cos(angle);
            x[i + 1] = r * std::sin(angle);
        }
        return x;
    };
    const std::vector<double> open = bent(0.9), closed = bent(1.07);
    CHECK(judge(strip, open).certified);
    const Injectivity found = judge(strip, closed);
    CHECK(!found.certified);
    CHECK(mentions(found, "the boundary overlaps itself at face "));
    REQUIRE(found.face >= 0);
    CHECK(found.position == centroid(strip, closed, strip.face(found.face), 2));
}

TEST_CASE("parts that are not connected and lie over each other are not certified, others are") {
    for (const int degree : {1, 3})
        for (const Mesh& linear : {square_mesh(2), cube_mesh(2)}) {
            CAPTURE(degree);
            CAPTURE(linear.dim);
            check_lying_over([&](double scale, const Vec<3>& shift) {
                return raise_degree(two_parts(linear, scale, shift), degree);
            });
        }
}

TEST_CASE("parts that share one vertex and lie over each other along common lines are not certified") {
    const auto is_certified = [](double shear) {
        // The unit square, and another one from its corner (1, 0) on, over its right half or beside it.
        const Mesh mesh = linear_mesh(2, {0, 0, 1, 0, 1, 1, 0, 1, 1 + shear, 1, shear, 1, shear, 0},
                                      {0, 1, 2, 0, 2, 3, 6, 1, 5, 1, 4, 5}, [](const double*) { return "rim"; });
        return certify_injective(mesh, mesh.x, certify(mesh, mesh.x)).certified;
    };
    CHECK(!is_certified(0.5));
    CHECK(!is_certified(0.1));
}

// A ramp whose turns lie on each other, so that no edges cross, and all angles are in order.
TEST_CASE("a strip that goes around twice is not certified, in any degree") {
    for (const int degree : {1, 2, 4}) {
        const auto ramp = [degree](int quarters) {
            std::vector<double> x;
            for (int k = 0; k <= quarters; ++k) {
                const double angle = k * std::numbers::pi / 2, c = std::cos(angle), s = std::sin(angle);
                x.insert(x.end(), {c, s, 2 * c, 2 * s});
            }
            std::vector<int> elements;
            for (int k = 0; k < quarters; ++k)
                elements.insert(elements.end(), {2 * k, 2 * k + 1, 2 * k + 3, 2 * k, 2 * k + 3, 2 * k + 2});
            return raise_degree(linear_mesh(2, x, elements, [](const double*) { return "rim"; }), degree);
        };
        CHECK(judge(ramp(3), ramp(3).x).certified);
        CHECK(judge(ramp(4), ramp(4).x).certified);  // its ends in contact
        const Mesh twice = ramp(8);
        const Injectivity found = judge(twice, twice.x);
        CHECK(!found.certified);
        CHECK(mentions(found, "the elements around node "));
    }
}

TEST_CASE("a node in the middle of the side of another triangle, which is a face over two, touches it; behind it, not") {
    const auto of = [](double middle) {
        const Mesh mesh = linear_mesh(2, {0, 0, 1, 0, 0, 1, 1, 1, middle, middle}, {0, 1, 2, 1, 3, 4, 3, 2, 4},
                                      [](const double*) { return "rim"; });
        return judge(mesh, mesh.x);
    };
    CHECK(of(0.5).certified);
    CHECK(of(0.6).certified);
    CHECK(!of(0.5 - 1e-6).certified);
    CHECK(mentions(of(0.4), " lie over each other"));
}

TEST_CASE("hexahedra, prisms, pyramids and all of them are certified, curved too") {
    for (const Mesh& linear : solid_meshes(0.1))
        for (const int degree : {1, 2, 3}) {
            CAPTURE(degree);
            CAPTURE(linear.elements_text());
            const Mesh mesh = raise_degree(linear, degree);
            CHECK(judge(mesh, mesh.x).certified);
            CHECK(judge(mesh, wavy(mesh.x, 3, 0.01)).certified);
        }
}

TEST_CASE("a node that prisms or pyramids go around twice is found though all of them are valid") {
    for (const bool of_prisms : {true, false}) {
        const Mesh block = round_block(12, of_prisms);
        CHECK(judge(block, block.x).certified);
        const std::string node = of_prisms ? "14" : "27";
        CHECK(mentions(judge(block, wound_twice(block, 0)), "the elements around node " + node + " overlap"));
    }
}

TEST_CASE("blocks of other cells that lie over each other are not certified, others are") {
    for (const std::string layers : {"h", "p", "du"})
        for (const int degree : {1, 2}) {
            CAPTURE(layers);
            CAPTURE(degree);
            check_lying_over([&](double scale, const Vec<3>& shift) {
                return raise_degree(two_blocks(layers, scale, shift), degree);
            });
        }
}
