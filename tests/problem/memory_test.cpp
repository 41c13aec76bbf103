#include "problem/memory.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <string>

#include "deck/deck.hpp"
#include "problem/base_mesh.hpp"
#include "problem/problem.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "energy/distortion_energy.hpp"
#include "support/heap.hpp"
#include "support/meshes.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the blocks of the Hessian are counted as its pattern has them, in every degree") {
    std::vector<Mesh> meshes = {ring_mesh(12, 3, 6), cube_mesh(2), mixed_mesh(4)};
    for (const Mesh& mesh : solid_meshes()) meshes.push_back(mesh);
    for (const Mesh& linear : meshes)
        for (int degree = 1; degree <= 4; ++degree) {
            const Mesh mesh = raise_degree(linear, degree);
            const BlockCsr H = make_energy(mesh, straight_sided(mesh), {})->hessian_pattern();
            CHECK(hessian_blocks(mesh) == H.blocks());
        }
}

namespace {

// The run's arrays at its first Newton step, when all of them are there, over what is predicted for them.
double arrays_over_prediction(const Mesh& base, int degree, const std::string& solver, double half_from_blocks = 1e9) {
    Deck deck = parse_deck(concat("mesh = none.msh\nthreads = 1\ndegree = ", degree, "\nsolver = ", solver,
                                        "\nboundary all = rotate 10", base.dim == 3 ? " axis 0 0 1\n" : "\n"),
                                 "a.deck");
    deck.linear.half_from_blocks = half_from_blocks;
    const double before = allocated();
    Problem problem = make_problem(deck, {base});
    set_functional(deck, problem);
    Level& level = *problem.level;
    Newton newton(level.energy->hessian_pattern(), deck.linear, {});
    double arrays = 0;
    AlObserver observer;
    observer.newton_step = [&](int, const NewtonStep&) { arrays = std::max(arrays, allocated() - before); };
    AugmentedLagrangianParams params;
    params.max_iterations = params.max_newton_iterations = 1;
    std::vector<double> x = problem.ideal();
    minimise(*level.energy, *level.constraint, newton, params, x, observer);
    const double program = predicted_bytes(square_mesh(1), deck.linear);
    return arrays / (predicted_bytes(problem.mesh(), deck.linear) - program);
}

}  // namespace

TEST_CASE("what a run allocates is predicted to a fifth, for every cell and degree") {
    if (allocated() == 0) return;
    set_threads(1);
    struct Case {
        const char* layers;  // of solid_mesh(), or t: triangles, q: quadrilaterals, T: tetrahedra
        int cells[4];        // a side, by degree
    };
    // Arrays of less than two megabytes, or of many: larger ones begin at a whole page, and the space before it counts
    // as allocated.
    for (const Case& of : {Case{"t", {60, 30, 20, 15}}, {"q", {60, 30, 20, 15}}, {"T", {9, 4, 2, 4}},
                           {"h", {9, 3, 4, 3}}, {"p", {9, 4, 3, 3}}, {"du", {8, 4, 1, 3}}})
        for (int degree = 1; degree <= 4; ++degree) {
            const std::string kind = of.layers;
            for (const std::string solver : {"cg", "cholesky"}) {
                const bool direct = solver == "cholesky";
                const int k = (direct ? 2 : 1) * of.cells[degree - 1];
                if (direct && ((kind != "t" && kind != "q") || degree % 3 != 1)) continue;
                std::string layers;
                while (static_cast<int>(layers.size()) < k) layers += kind;
                const Mesh mesh = kind == "t"   ? square_mesh(k)
                                  : kind == "q" ? quad_mesh(k)
                                  : kind == "T" ? cube_mesh(k)
                                                : solid_mesh(k, layers);
                CAPTURE(kind);
                CAPTURE(degree);
                CAPTURE(solver);
                const double ratio = arrays_over_prediction(mesh, degree, solver);
                CHECK(ratio > 0.8);
                CHECK(ratio < 1.2);
                if (kind != "T" || degree < 3) continue;
                const double of_half = arrays_over_prediction(mesh, degree, solver, 0);  // half of the Hessian
                CHECK(of_half > 0.8);
                CHECK(of_half < 1.2);
            }
        }
}

TEST_CASE("more is predicted for finer meshes and higher degrees, and for the factor of a large 3D mesh") {
    const Mesh cube = cube_mesh(4), fine = refine(cube, 1);
    LinearSolverParams cg, cholesky;
    cg.kind = SolverKind::cg;
    cholesky.kind = SolverKind::cholesky;
    CHECK(predicted_bytes(fine, cg) > predicted_bytes(cube, cg));
    CHECK(predicted_bytes(raise_degree(cube, 2), cg) > predicted_bytes(cube, cg));
    CHECK(predicted_bytes(refine(cube, 3), cholesky) > 2 * predicted_bytes(refine(cube, 3), cg));
    CHECK(predicted_bytes(cube, {}) == predicted_bytes(cube, cholesky));  // small: so decides `automatic`
}

TEST_CASE("half of the Hessian takes a third of the memory where degrees are high") {
    LinearSolverParams whole, half;
    whole.kind = half.kind = SolverKind::cg;
    half.half_from_blocks = 0;
    whole.half_from_blocks = std::numeric_limits<double>::infinity();
    const Mesh cube = refine(cube_mesh(4), 2);
    const auto ratio = [&](int degree) {
        const Mesh mesh = raise_degree(cube, degree);
        return predicted_bytes(mesh, half) / predicted_bytes(mesh, whole);
    };
    CHECK(ratio(1) == 1);
    CHECK(ratio(2) == 1);
    CHECK(ratio(3) < 0.55);
    CHECK(ratio(4) < 0.45);
}

TEST_CASE("a run that needs more memory than there is is refused before its mesh is made, with what fits") {
    LinearSolverParams cg;
    cg.kind = SolverKind::cg;
    for (const Mesh& base : {solid_mesh(2, "hh"), solid_mesh(2, "hdpuh"), cube_mesh(2), mixed_mesh(8)}) {
        const double lower = predicted_bytes(raise_degree(refine(base, 1), 2), cg),
                     bytes = predicted_bytes(raise_degree(refine(base, 1), 3), cg);
        CHECK_NOTHROW(check_memory(base, 3, 1, cg, bytes + 0.5 * (bytes - lower)));
        CHECK_THROWS_WITH_AS(check_memory(base, 3, 1, cg, 0.5 * (lower + bytes)), doctest::Contains("degree = 2 takes"),
                             InputError);
        CHECK_THROWS_WITH_AS(check_memory(base, 1, 7, cg, 1e8), doctest::Contains("refine = "), InputError);
        CHECK_THROWS_WITH_AS(check_memory(base, 3, 1, cg, 1), doctest::Contains("a coarser mesh takes less"),
                             InputError);
    }
}

TEST_CASE("a run whose refined mesh would not fit into memory ends at once") {
    const RingDeck ring;
    const Outcome run = ring.run({"refine=7", "degree=7"});
    CHECK(run.code == 2);
    CHECK(has(run.error, "GB of memory, and "));
    CHECK(has(run.error, " GB are free here: "));
}

TEST_CASE("the summary has the prediction beside what was taken") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const double predicted = std::stod(summary_of(ring.output).at("predicted_memory_mb"));
    CHECK(predicted > 1);
    CHECK(predicted < 20);
}
