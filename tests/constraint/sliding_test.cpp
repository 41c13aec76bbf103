#include "constraint/sliding.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "constraint/sliding_boundary.hpp"
#include "constraint/sliding_nodes.hpp"
#include "linalg/vector_ops.hpp"
#include "mesh/part.hpp"
#include "method/augmented_lagrangian.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::shared_ptr<const SlidingSurfaces> surfaces_of(const Mesh& mesh, const BoundaryTarget& target, double angle = 30) {
    return std::make_shared<SlidingSurfaces>(mesh, target.node, slides(mesh, target), angle, Frame());
}

// Keeps what the constraint refers to.
struct Case {
    Mesh mesh;
    BoundaryTarget target;
    std::unique_ptr<Constraint> constraint;

    Case(const Mesh& any, const std::map<std::string, std::string>& motions) : mesh(any) {
        target = target_of(mesh, motions);
        const auto sliding = surfaces_of(mesh, target);
        prescribe_shared_nodes(mesh, target);
        constraint = make_constraint(mesh, straight_sided(mesh), target, TargetKind::nodal, sliding);
    }
};

std::vector<double> some_multipliers(const Constraint& constraint) {
    std::vector<double> lambda(constraint.multipliers());
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] = std::cos(1.7 * static_cast<double>(i));
    return lambda;
}

double largest_entry(const std::vector<double>& v) { return norm_inf(v); }

}  // namespace

TEST_CASE("nodes at the edge of a wedge of five degrees slide along it") {
    const double tilt = std::tan(5 * std::acos(-1.0) / 180);
    const auto name = [&](const double* centre) {
        return centre[2] == 0 ? "below" : std::abs(centre[2] - tilt * centre[1]) < 1e-9 ? "above" : "ends";
    };
    const Mesh wedge = linear_mesh(3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, tilt}, {0, 1, 2, 3}, name);
    const Case c(raise_degree(wedge, 2), {{"below", "slide"}, {"above", "slide"}, {"ends", "free"}});
    const std::vector<int>& nodes = c.constraint->nodes();
    int found = 0;
    for (int t = 0; t < static_cast<int>(nodes.size()); ++t) {
        const double* const at = &c.mesh.x[3 * nodes[t]];
        if (at[0] != 0.5 || at[1] != 0) continue;
        ++found;
        std::vector<double> x = c.mesh.x;
        x[3 * nodes[t]] = 0.6;
        x[3 * nodes[t] + 1] = 0.02;
        x[3 * nodes[t] + 2] = -0.01;
        const std::vector<double> target = c.constraint->targets(x);
        CHECK(target[3 * t] == doctest::Approx(0.6));
        CHECK(std::abs(target[3 * t + 1]) < 1e-12);
        CHECK(std::abs(target[3 * t + 2]) < 1e-12);
    }
    CHECK(found == 1);
}

TEST_CASE("a boundary is cut into its smooth parts: the sides of a cube into four planes, a ring's circle into one") {
    const Mesh cube = cube_mesh(3);
    const auto of_cube = surfaces_of(cube, target_of(cube, {{"sides", "slide"}}));
    CHECK(of_cube->parts() == 4);
    for (int part = 0; part < of_cube->parts(); ++part) CHECK(of_cube->surface(part).name() == "plane");
    const int sides = cube.boundary_index("sides");
    std::set<int> parts;
    for (const Vec<3>& x : {Vec<3>{0, 0.4, 0.5}, Vec<3>{1, 0.4, 0.5}, Vec<3>{0.4, 0, 0.5}, Vec<3>{0.4, 1, 0.5}}) {
        const int part = of_cube->part(cube, face_near(cube, sides, x));
        parts.insert(part);
        CHECK(length(of_cube->closest(part, x).position - x) < 1e-14);
    }
    CHECK(parts.size() == 4);

    const Mesh ring = ring_mesh(12, 3, 4);
    const auto of_ring = surfaces_of(ring, target_of(ring, {{"outer", "translate 3 1; slide"}}));
    CHECK(of_ring->parts() == 1);
    CHECK(of_ring->surface(0).name() == "circle of radius 4");
    CHECK(length(of_ring->closest(0, {9, 1, 0}).position - Vec<3>{7, 1, 0}) < 1e-12);

    Mesh oval = ring;
    for (int i = 0; i < oval.nodes(); ++i) oval.x[2 * i] *= 1.2;
    const auto of_oval = surfaces_of(oval, target_of(oval, {{"outer", "slide"}}), 10);
    CHECK(of_oval->parts() == 1);
    CHECK(of_oval->surface(0).name() == "conic");

    Mesh egg = ring;  // its own faces, smooth or, with a small feature angle, each for itself
    for (int i = 0; i < egg.nodes(); ++i) egg.x[2 * i] *= 1.2 + 0.03 * egg.x[2 * i];
    const auto of_egg = surfaces_of(egg, target_of(egg, {{"outer", "slide"}}), 45);
    CHECK(of_egg->parts() == 1);
    CHECK(of_egg->surface(0).name() == "the mesh's own faces");
    CHECK(surfaces_of(egg, target_of(egg, {{"outer", "slide"}}), 10)->parts() == 12);
}

TEST_CASE("along another mesh: its parts, those of faces at a fair angle before those that are nearer") {
    const Mesh base = cube_mesh(8);
    Mesh wide = cube_mesh(2);  // wider than the run's cube after its motion
    for (int i = 0; i < wide.nodes(); ++i) wide.x[3 * i] *= 1.2;
    const auto other = std::make_shared<const Mesh>(raise_degree(wide, 2));
    const int sides = base.boundary_index("sides");
    std::vector<OtherSurface> others(base.boundaries.size());
    others[sides] = {other, other->boundaries_in("sides")};
    const BoundaryTarget target = target_of(base, {{"sides", "scale 0.8 1 1; slide"}});
    std::vector<char> slides(base.boundaries.size(), 0);
    slides[sides] = 1;
    const SlidingSurfaces sliding(base, target.node, slides, 30, {.origin = {}, .length = 10}, others);
    REQUIRE(sliding.parts() == 4);
    Mesh of_run = base;
    for (double& x : of_run.x) x /= 10;
    const auto part_of = [&](double x, double y, double z) {
        return sliding.part(of_run, face_near(of_run, sides, {x / 10, y / 10, z / 10}));
    };
    const int right = part_of(1, 0.5, 0.5);  // 0.8 after the motion, 0.4 from its plane
    CHECK(sliding.surface(right).name() == "plane");
    CHECK(sliding.is_of_other_mesh(right));
    CHECK(length(sliding.closest(right, {0.05, 0.03, 0.02}).position - Vec<3>{0.12, 0.03, 0.02}) < 1e-14);
    for (const double y : {0.05, 0.3, 0.95}) CHECK(part_of(1, y, 0.9) == right);  // beside another side, too
    CHECK(part_of(0, 0.98, 0.5) != right);
    CHECK(part_of(0.98, 1, 0.5) != right);
    CHECK(part_of(0.98, 1, 0.5) != part_of(0.98, 0, 0.5));
}

// The chords of the upper edges run below the lower one.
TEST_CASE("a coarse face slides along its own part, however near another one is to its corners, refined too") {
    const Mesh triangle = linear_mesh(2, {-1, 0, 1, 0, 0, 2}, {0, 1, 2}, [](const double*) { return "rim"; });
    Mesh crescent = raise_degree(triangle, 2);
    for (int f = 0; f < 3; ++f) {
        const int* const node = crescent.face(f);
        if (node[0] + node[1] == 1) crescent.x[2 * node[2] + 1] = 1.6;
        else crescent.x[2 * node[2]] *= 2;
    }
    const auto sliding = surfaces_of(crescent, target_of(crescent, {{"rim", "slide"}}), 20);
    REQUIRE(sliding->parts() == 3);
    Mesh straight = crescent;
    straight.x = straight_sided(crescent);
    for (const Mesh& mesh : {crescent, straight, refine(straight, 2)})
        for (int f = 0; f < mesh.face_count(); ++f) {
            const int own = f / (mesh.face_count() / 3), middle = crescent.face(own)[2];
            const Vec<3> x = in_space(point(crescent.x, middle, 2), 2);
            CHECK(length(sliding->closest(sliding->part(mesh, f), x).position - x) < 1e-9);
        }
}

TEST_CASE("a mesh that is cut out of another slides along the surfaces of the whole, to the last bit") {
    const Mesh ring = ring_mesh(12, 3, 4);
    const auto whole = surfaces_of(ring, target_of(ring, {{"outer", "slide"}}));
    std::vector<char> chosen(ring.element_count(), 0);
    std::vector<int> faces;
    for (int f = 0; f < ring.face_count(); ++f)
        if (ring.face_boundary[f] == ring.boundary_index("outer") && faces.size() < 2) {
            chosen[ring.face_element[f]] = 1;
            faces.push_back(f);
        }
    const MeshPart part = part_of(ring, chosen, "cut");
    const Frame frame = {.origin = {1, 0, 0}, .length = 2};
    const SlidingSurfaces of_part(*whole, part, frame);
    CHECK(of_part.knows(part.boundary_index("outer")));
    CHECK(!of_part.knows(part.boundary_index("inner")));
    CHECK(!of_part.knows(part.cut()));
    for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
        CHECK(part.face_of[f] == faces[f]);
        CHECK(of_part.part(part, f) == whole->part(ring, faces[f]));
        const Vec<3> x = {2.5, 3, 0};
        const Vec<3> projection = frame.to_file(of_part.closest(of_part.part(part, f), frame.to_run(x)).position);
        CHECK(length(projection - whole->closest(0, x).position) < 1e-15);
    }
}

TEST_CASE("nodes are free within their faces, along edges, and not at corners") {
    const Case cube(cube_mesh(3), {{"bottom", "slide"}, {"top", "slide"}, {"sides", "slide"}});
    const std::vector<int>& nodes = cube.constraint->nodes();
    const std::vector<double> zero(cube.constraint->multipliers(), 0.0);
    for (std::size_t t = 0; t < nodes.size(); ++t)
        for (int a = 0; a < 3; ++a) {
            const double at = cube.mesh.x[3 * nodes[t] + a];
            int faces = 0;
            for (int b = 0; b < 3; ++b) faces += std::abs(cube.mesh.x[3 * nodes[t] + b] - 0.5) > 0.499;
            std::vector<double> x = cube.mesh.x;
            x[3 * nodes[t] + a] += 0.1;
            const bool fixed = std::abs(at - 0.5) > 0.499 || faces == 3;
            CHECK((cube.constraint->value(x, zero, 1) > 1e-12) == fixed);
        }
}

TEST_CASE("free nodes take no part, prescribed ones keep their places beside a boundary that slides") {
    const Case square(square_mesh(4), {{"left", "free"}, {"right", "scale 1 1.2"}, {"bottom", "slide"},
                                       {"top", "free"}});
    const std::vector<double> zero(square.constraint->multipliers(), 0.0);
    std::vector<double> g(square.mesh.x.size(), 0.0);
    std::vector<double> x = square.mesh.x;
    square.constraint->add_gradient(x, zero, 1, g);
    const std::vector<double> targets = square.constraint->targets(x);
    for (std::size_t t = 0; t < square.constraint->nodes().size(); ++t) {
        const double* const y = &x[2 * square.constraint->nodes()[t]];
        if (y[0] == 1) CHECK(targets[2 * t + 1] == doctest::Approx(1.2 * y[1]));
        if (y[0] == 0 && y[1] > 0 && y[1] < 1) {
            CHECK(targets[2 * t] == y[0]);
            CHECK(g[2 * square.constraint->nodes()[t]] == 0);
        }
    }
    CHECK_THROWS_WITH_AS(Case(square_mesh(4), {{"right", "translate 3 2"}, {"bottom", "slide"}, {"top", "slide"}}),
                         doctest::Contains("off that surface (straight line) by 2"), InputError);
    CHECK_THROWS_WITH_AS(Case(square_mesh(4), {{"right", "translate 1 0"}}), doctest::Contains("let it `slide`"),
                         InputError);
}

TEST_CASE("derivatives of the sliding constraint: gradients everywhere, Hessians on the surface") {
    Mesh pipe = cube_mesh(3);  // a piece of it: cylinders below and above, planes around
    for (int i = 0; i < pipe.nodes(); ++i) {
        const double angle = pipe.x[3 * i], r = 2 + pipe.x[3 * i + 2];
        pipe.x[3 * i] = r * std::sin(angle), pipe.x[3 * i + 2] = r * std::cos(angle);
    }
    for (const Mesh& mesh : {ring_mesh(16, 2, 3), cube_mesh(2), pipe}) {
        CAPTURE(mesh.x[0]);
        Case of(mesh, mesh.dim == 2 ? std::map<std::string, std::string>{{"outer", "slide"}}
                                    : std::map<std::string, std::string>{{"sides", "slide"}, {"bottom", "slide"}});
        Constraint& C = *of.constraint;
        const std::vector<double> lambda = some_multipliers(C);
        const double mu = 30, h = 1e-5;
        for (const bool on_surface : {false, true}) {
            std::vector<double> x = on_surface ? mesh.x : wavy(mesh.x, mesh.dim, 0.05);
            std::vector<double> g(x.size(), 0.0), d(x.size()), Hd(x.size());
            for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(7.0 * static_cast<double>(i));
            C.add_gradient(x, lambda, mu, g);
            std::vector<double> plus = x, minus = x, g_plus(x.size(), 0.0), g_minus(x.size(), 0.0);
            for (std::size_t i = 0; i < d.size(); ++i) plus[i] += h * d[i], minus[i] -= h * d[i];
            CHECK((C.value(plus, lambda, mu) - C.value(minus, lambda, mu)) / (2 * h) ==
                  doctest::Approx(dot(g, d)).epsilon(1e-6));
            if (!on_surface) continue;
            BlockCsr H = matrix_of_cells(mesh.nodes(), mesh.dim, mesh.elements, mesh.element_nodes());
            C.add_hessian(x, lambda, mu, false, H);
            multiply(H, d.data(), Hd.data());
            C.add_gradient(plus, lambda, mu, g_plus);
            C.add_gradient(minus, lambda, mu, g_minus);
            for (std::size_t i = 0; i < d.size(); ++i) g_plus[i] = (g_plus[i] - g_minus[i]) / (2 * h) - Hd[i];
            CHECK(largest_entry(g_plus) < 1e-6 * largest_entry(Hd));
        }
    }
}

TEST_CASE("off_target and targets: on the circle, whatever the place along it") {
    Case ring(ring_mesh(16, 2, 3), {{"outer", "slide"}});
    std::vector<double> x = ring.mesh.x;
    const double c = std::cos(0.1), s = std::sin(0.1);
    const int outer = ring.mesh.boundary_index("outer");
    std::set<int> on_outer;
    for (int f = 0; f < ring.mesh.face_count(); ++f)
        if (ring.mesh.face_boundary[f] == outer) on_outer.insert({ring.mesh.face(f)[0], ring.mesh.face(f)[1]});
    for (const int i : on_outer) {
        const double a = x[2 * i], b = x[2 * i + 1];
        x[2 * i] = c * a - s * b;
        x[2 * i + 1] = s * a + c * b;
    }
    for (const char off : ring.constraint->off_target(x)) CHECK(!off);
    x[2 * *on_outer.begin()] *= 1.001;
    int count = 0;
    for (const char off : ring.constraint->off_target(x)) count += off;
    CHECK(count == 1);
}

namespace {

// A wavy displacement of all nodes.
std::vector<double> some_direction(const std::vector<double>& x) {
    std::vector<double> d(x.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = std::sin(3.0 * static_cast<double>(i));
    return d;
}

std::vector<double> moved(std::vector<double> x, double t, const std::vector<double>& d) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * d[i];
    return x;
}

// The same constraint, whose steps are straight.
class Uncorrected : public SlidingBoundary {
public:
    using SlidingBoundary::SlidingBoundary;
    bool corrects_steps() const override { return false; }
};

AlResult solve(const Mesh& mesh, const std::vector<double>& ideal, Constraint& constraint, std::vector<double>& x) {
    const auto energy = make_energy(mesh, ideal, {.objective = Objective::deviation});
    Newton newton(energy->hessian_pattern(), {});
    x = ideal;
    return minimise(*energy, constraint, newton, {}, x, {}, {});
}

}  // namespace

TEST_CASE("a corrected step ends at the distances that the straight one has to first order, and is off it by O(t^2)") {
    const Case ring(ring_mesh(16, 2, 3), {{"outer", "slide"}});
    const Constraint& C = *ring.constraint;
    CHECK(C.corrects_steps());
    const std::vector<double> x = wavy(ring.mesh.x, 2, 0.05), d = some_direction(x);
    double largest[2] = {};
    for (int k = 0; k < 2; ++k) {
        const double t = 0.1 / (1 << k);
        const std::vector<double> straight = moved(x, t, d);
        std::vector<double> corrected = straight;
        C.correct(x, d, t, corrected);
        for (int i = 0; i < ring.mesh.nodes(); ++i) {
            const auto at = [i](const std::vector<double>& v) { return Vec<3>{v[2 * i], v[2 * i + 1], 0}; };
            const double move = length(at(corrected) - at(straight));
            if (std::hypot(ring.mesh.x[2 * i], ring.mesh.x[2 * i + 1]) < 2.9) {  // not on the outer circle
                CHECK(move == 0);
                continue;
            }
            largest[k] = std::max(largest[k], move);
            const double r = length(at(x));
            const double predicted = r - 3 + t * dot(at(x), at(d)) / r;
            CHECK(length(at(corrected)) - 3 == doctest::Approx(predicted).epsilon(1e-12).scale(1));
        }
    }
    CHECK(largest[1] > 1e-5);
    CHECK(std::log2(largest[0] / largest[1]) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("a rotor in a casing takes few steps, because they are corrected") {
    const Mesh mesh = ring_mesh(24, 5, 5);
    const std::vector<double> ideal = straight_sided(mesh);
    const BoundaryTarget target = target_of(mesh, {{"inner", "rotate 40; translate 1 0"}, {"outer", "slide"}});
    const auto sliding = surfaces_of(mesh, target);
    SlidingBoundary corrected(mesh, ideal, target, sliding);
    Uncorrected straight(mesh, ideal, target, sliding);
    std::vector<double> x;
    const AlResult result = solve(mesh, ideal, corrected, x);
    CHECK(std::string(to_string(result.status)) == "converged");
    CHECK(corrected.relative_error(x) < 1e-3);
    CHECK(result.newton_iterations <= 20);
    CHECK(solve(mesh, ideal, straight, x).newton_iterations > 3 * result.newton_iterations);
}

TEST_CASE("a target that prescribes all places corrects nothing, surfaces or not") {
    const Mesh mesh = ring_mesh(16, 2, 3);
    const BoundaryTarget slides = target_of(mesh, {{"outer", "slide"}}), prescribed = target_of(mesh, {});
    CHECK(!make_constraint(mesh, mesh.x, prescribed, TargetKind::nodal, surfaces_of(mesh, slides))->corrects_steps());
}

// A cube with a roof whose two halves slide: at a ridge of few degrees the surfaces do not tell where it is.
TEST_CASE("nodes of two surfaces slide along the edge that these have, and stay where they all but touch") {
    for (const double slope : {0.02, 0.07, 0.1, 0.5}) {
        const Mesh cube = cube_mesh(2);
        std::vector<double> x = cube.x;
        for (int i = 0; i < cube.nodes(); ++i) x[3 * i + 2] *= 1 - slope * std::abs(x[3 * i] - 0.5);
        const Case roof(linear_mesh(3, x, cube.elements,
                                    [](const double* c) {
                                        const double from_sides = std::min({c[0], 1 - c[0], c[1], 1 - c[1]});
                                        if (c[2] < 0.7 || from_sides < 1e-9) return "walls";
                                        return c[0] < 0.5 ? "left" : "right";
                                    }),
                        {{"left", "slide"}, {"right", "slide"}});
        const std::vector<int>& nodes = roof.constraint->nodes();
        const auto is_ridge = [&](int i) { return length(in_space(&x[3 * i], 3) - Vec<3>{0.5, 0.5, 1}) < 1e-9; };
        const auto ridge = std::find_if(nodes.begin(), nodes.end(), is_ridge);
        REQUIRE(ridge != nodes.end());
        std::vector<double> along = x;
        along[3 * *ridge + 1] += 0.1;
        const double target = roof.constraint->targets(along)[3 * (ridge - nodes.begin()) + 1];
        CHECK(target == doctest::Approx(2 * std::atan(slope) < 0.171 ? 0.5 : 0.6));
    }
}

TEST_CASE("a sliding node is off its circle from a few bits on") {
    for (const double off : {1e-15, 1e-11, 1e-6}) {
        Case ring(ring_mesh(16, 2, 3), {{"outer", "slide"}, {"inner", "free"}});
        std::vector<double> x = ring.mesh.x;
        for (double& v : x) v *= 1 + off;
        const std::vector<char> found = ring.constraint->off_target(x);
        CHECK(std::count(found.begin(), found.end(), 1) == (off < 1e-13 ? 0 : 16));
    }
}
