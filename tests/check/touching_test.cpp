// Boundaries that touch: lips of cracks, interfaces that match or do not, contact at points and edges, and pairs that
// are declared to be in contact.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "check/target_check.hpp"
#include "mesh/build.hpp"
#include "support/high_order.hpp"
#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Place = std::function<bool(const double*)>;
using Map = std::function<void(double*)>;

std::string one_name(const double*) { return "rim"; }

Injectivity judge(const Mesh& mesh, const std::vector<double>& x) {
    const Certificate certificate = certify(mesh, x);
    REQUIRE(certificate.valid);
    return certify_injective(mesh, x, certificate);
}

const std::string certified;  // what why_not() says then

std::string why_not(const Mesh& mesh, const std::vector<double>& x) {
    const Injectivity found = judge(mesh, x);
    CHECK(found.certified == found.reason.empty());
    return found.reason;
}

// The mesh with boundary faces found anew.
Mesh with_elements(const Mesh& mesh, const std::vector<double>& x, const std::vector<int>& elements) {
    if (mesh.dim == 2 || mesh.is_simplicial()) return linear_mesh(mesh.dim, x, elements, one_name, mesh.groups);
    RawMesh raw;
    raw.groups = {{3, 2, "all"}};
    for (std::size_t i = 0; i < x.size(); i += 3)
        raw.nodes.push_back({static_cast<long long>(i / 3) + 1, {x[i], x[i + 1], x[i + 2]}, 0});
    Mesh at = mesh;
    at.elements = elements;
    for (int e = 0; e < at.element_count(); ++e) {
        raw.elements.push_back({e + 1, raw.element_nodes.size(), 0, 3, 1, 2, 0, &at.cell(e)});
        raw.element_nodes.insert(raw.element_nodes.end(), at.element(e), at.element(e) + at.element_nodes(e));
    }
    std::vector<std::string> notes;
    return build_mesh(raw, notes);
}

// Cut in the middle of the last coordinate, where the first is above `tip`: nodes there are doubled. The new ones, of
// the elements above, have the highest numbers.
struct Cracked {
    Mesh mesh;
    int first_new;

    // x, with the vertices above the crack and on it moved, and the nodes between them with these.
    std::vector<double> opened(const Map& map) const {
        std::vector<double> x = mesh.x;
        for (int i = first_new; i < mesh.nodes(); ++i) map(&x[i * mesh.dim]);
        return x;
    }
};

Cracked cracked(const Mesh& mesh, double tip) {
    const int n = mesh.dim;
    std::vector<double> x = mesh.x;
    std::vector<int> elements, twin(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const bool is_above = element_centre(mesh, mesh.x, e)[n - 1] > 0.5;
        for (int k = 0; k < mesh.element_nodes(e); ++k) {
            const int i = mesh.element(e)[k];
            const double* const at = &mesh.x[i * n];
            const bool doubles = is_above && std::abs(at[n - 1] - 0.5) < 1e-9 && at[0] > tip;
            if (doubles && twin[i] < 0) {
                twin[i] = static_cast<int>(x.size()) / n;
                x.insert(x.end(), at, at + n);
            }
            elements.push_back(doubles ? twin[i] : i);
        }
    }
    return {with_elements(mesh, x, elements), mesh.nodes()};
}

// A body, and another one that `map` has moved; the names of both boundaries.
Mesh joined(const Mesh& body, const Mesh& other, const Map& map, const BoundaryName& name = one_name) {
    const int n = body.dim;
    std::vector<double> x = body.x, y = other.x;
    for (std::size_t i = 0; i < y.size(); i += n) map(&y[i]);
    x.insert(x.end(), y.begin(), y.end());
    std::vector<int> elements = body.elements;
    for (const int i : other.elements) elements.push_back(i + body.nodes());
    if (body.is_simplicial()) return linear_mesh(n, x, elements, name);
    Mesh both = body;
    both.groups[0].count += other.groups[0].count;
    if (n == 2) return linear_mesh(n, x, elements, name, both.groups);
    return with_elements(both, x, elements);
}

std::vector<Mesh> meshes_with_middle() {
    return {square_mesh(4), quad_mesh(4, 0.1),     mixed_mesh(4, 0.1),
            cube_mesh(2),   solid_mesh(2, "hh"), solid_mesh(2, "pp")};
}

}  // namespace

TEST_CASE("the lips of a crack touch: certified in every cell and degree, curved too, and where they open and close") {
    for (const Mesh& whole : meshes_with_middle())
        for (const int degree : {1, 2, 4})
            for (const double tip : {0.4, -1.0}) {
                if (degree > (whole.dim == 2 ? 4 : whole.is_simplicial() ? 2 : 1 + (tip > 0))) continue;
                CAPTURE(whole.elements_text());
                CAPTURE(degree);
                CAPTURE(tip);
                const Cracked linear = cracked(whole, tip);
                const Mesh mesh = raise_degree(linear.mesh, degree);
                REQUIRE(mesh.face_count() > whole.face_count());
                CHECK(why_not(mesh, mesh.x) == certified);
                CHECK(check_target(mesh, mesh.x).faults.empty());
                CHECK(check_target(mesh, mesh.x).crossed_before[0] < 0);
                const std::vector<double> curved = wavy(mesh.x, mesh.dim, 0.01);
                CHECK(why_not(mesh, curved) == certified);
                CHECK(check_target(mesh, curved).faults.empty());
                const int n = mesh.dim;
                const auto open = [&](double* p) { p[n - 1] += 0.05 * (p[0] - tip); };
                Mesh wide = linear.mesh;
                wide.x = linear.opened(open);
                wide = raise_degree(wide, degree);
                CHECK(why_not(mesh, wide.x) == certified);
                CHECK(check_target(mesh, wide.x).faults.empty());
                CHECK(why_not(wide, mesh.x) == certified);
                CHECK(check_target(wide, mesh.x).faults.empty());
                for (const double edge : {1e-6, 1e-3}) {  // through each other
                    if (degree > 1 && edge == 1e-3) continue;
                    Mesh crossing = linear.mesh;
                    crossing.x = linear.opened([&](double* p) { p[n - 1] -= 0.25 * edge; });
                    crossing = raise_degree(crossing, degree);
                    CHECK(why_not(crossing, crossing.x) != certified);
                    CHECK(why_not(mesh, crossing.x) != certified);
                }
            }
}

TEST_CASE("plane faces that do not match touch, at an angle, in any unit and place, and while they slide") {
    for (const auto& pair : {std::pair(square_mesh(2), square_mesh(3)), std::pair(quad_mesh(2), quad_mesh(3)),
                             std::pair(cube_mesh(1), cube_mesh(2)),
                             std::pair(solid_mesh(1, "h"), solid_mesh(3, "hhh"))})
        for (const int degree : {1, 2}) {
            const Mesh &body = pair.first, &other = pair.second;
            if (body.dim == 3 && degree == 2 && !body.is_simplicial()) continue;
            CAPTURE(body.elements_text());
            CAPTURE(degree);
            const int n = body.dim;
            const auto of = [&](double slide, double depth, double unit, double origin) {
                Mesh mesh = joined(body, other, [&](double* p) {
                    p[0] += slide;
                    p[n - 1] += 1 - depth;
                });
                for (std::size_t i = 0; i < mesh.x.size(); i += n) {
                    const double a = mesh.x[i], b = mesh.x[i + n - 1], c = std::cos(0.5), s = std::sin(0.5);
                    mesh.x[i + 1] *= unit;
                    mesh.x[i] = origin + unit * (c * a - s * b);
                    mesh.x[i + n - 1] = unit * (s * a + c * b);
                }
                mesh = raise_degree(mesh, degree);
                return why_not(mesh, mesh.x);
            };
            CHECK(of(0, 0, 1, 0) == certified);
            CHECK(of(0.1234567, 0, 1, 0) == certified);
            CHECK(of(0.5, 0, 1, 0) == certified);
            CHECK(of(1, 0, 1, 0) == certified);
            CHECK(of(0.3, 0, 1e-6, 0) == certified);
            CHECK(of(0.3, 0, 1e6, 0) == certified);
            CHECK(of(0.3, 0, 1, 1e6) == certified);
            CHECK(of(0.3, -0.1, 1, 0) == certified);
            for (const double slide : {0.0, 0.1234567, 0.5}) {
                CHECK(of(slide, 1e-6, 1, 0) != certified);
                CHECK(of(slide, 1e-6, 1e-6, 0) != certified);
                CHECK(of(slide, 1e-4, 1, 1e6) != certified);
                CHECK(of(slide, 0.1, 1, 0) != certified);
            }
        }
}

TEST_CASE("a vertex that touches a face, and an edge that touches an edge, are no crossing; beyond by 1e-6 they are") {
    const auto turned = [](double depth) {  // a corner in the middle of a side
        return joined(square_mesh(1), square_mesh(1), [depth](double* p) {
            const double a = p[0], b = p[1], s = std::sqrt(0.5);
            p[0] = 0.5 + s * (a - b);
            p[1] = 1 - depth + s * (a + b);
        });
    };
    CHECK(why_not(turned(0), turned(0).x) == certified);
    CHECK(why_not(turned(1e-6), turned(1e-6).x) != certified);
    const auto roof = [](double depth) {  // an edge along an edge, and along a face
        return joined(cube_mesh(1), cube_mesh(1), [depth](double* p) {
            const double a = p[0], c = p[2], s = std::sqrt(0.5);
            p[0] = 0.4 + s * (a - c);
            p[2] = 1 - depth + s * (a + c);
        });
    };
    CHECK(why_not(roof(0), roof(0).x) == certified);
    CHECK(why_not(roof(1e-6), roof(1e-6).x) != certified);
}

TEST_CASE("bodies that slide along each other by an edge, so that nodes come together, are no fault of the target") {
    for (const Mesh& body : {square_mesh(2), cube_mesh(2)}) {
        const int n = body.dim;
        const Mesh mesh = joined(body, body, [n](double* p) { p[n - 1] += 1; });
        for (const double slide : {0.2, 0.5, 1.0, 1.5}) {
            std::vector<double> x = mesh.x;
            for (std::size_t i = body.x.size(); i < x.size(); i += n) x[i] += slide;
            CAPTURE(slide);
            for (const auto& fault : check_target(mesh, x).faults) MESSAGE(fault.why);
            CHECK(check_target(mesh, x).faults.empty());
            CHECK(why_not(mesh, x) == certified);
            for (std::size_t i = body.x.size(); i < x.size(); i += n) x[i + n - 1] -= 0.5e-6;
            CHECK((why_not(mesh, x) == certified) == (slide >= 1));
        }
    }
}

TEST_CASE("facets of two circles overlap where a contact is declared, by no more than was measured") {
    const auto circles = [](double turn, double radius) {
        Mesh mesh = joined(ring_mesh(8, 1, 2), ring_mesh(16, 1, 2), [&](double* p) {
            const double a = p[0], b = p[1], c = std::cos(turn), s = std::sin(turn);
            p[0] = 0.5 * radius * (c * a - s * b);
            p[1] = 0.5 * radius * (s * a + c * b);
        }, [radius](const double* centre) {
            const double r = std::hypot(centre[0], centre[1]);
            return r > 1.6 ? "outer" : r < 0.6 * radius ? "inner" : r < 0.95 ? "stator" : "rotor";
        });
        return mesh;
    };
    const double sagitta = 1 - std::cos(std::numbers::pi / 8);
    for (const double turn : {0.0, 0.05, 0.13, 1.0}) {
        CAPTURE(turn);
        Mesh mesh = circles(turn, 1);
        CHECK(why_not(mesh, mesh.x) != certified);
        mesh.contact.assign(mesh.boundaries.size(), 0);
        for (const char* name : {"rotor", "stator"}) {
            REQUIRE(mesh.boundary_index(name) >= 0);
            mesh.contact[mesh.boundary_index(name)] = 1;
        }
        const Injectivity found = judge(mesh, mesh.x);
        CHECK(found.certified);
        CHECK(found.overlap <= sagitta * (1 + 1e-12));
        CHECK(found.overlap > 0.6 * sagitta);
        if (turn == 0) CHECK(found.overlap == doctest::Approx(sagitta));
        CHECK(check_target(mesh, mesh.x).crossed_before[0] < 0);
        Mesh deep = circles(turn, 1.4);
        deep.contact = mesh.contact;
        CHECK(why_not(deep, deep.x) != certified);
        mesh.contact[mesh.boundary_index("rotor")] = 2;  // each in another one
        CHECK(why_not(mesh, mesh.x) != certified);
    }
}

TEST_CASE("faces that cross in the initial mesh are named, both of them") {
    const Mesh mesh = joined(square_mesh(1), square_mesh(1), [](double* p) { p[0] += 0.5, p[1] += 0.4; });
    const Injectivity found = judge(mesh, mesh.x);
    CHECK(!found.certified);
    REQUIRE(found.other_face >= 0);
    CHECK(found.reason.find(" crosses face ") != std::string::npos);
}
