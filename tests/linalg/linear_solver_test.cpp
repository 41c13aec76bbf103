#include "linalg/linear_solver.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/parallel.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/vector_ops.hpp"
#include "support/matrices.hpp"

using namespace almesh;

namespace {

LinearSolverParams params_of(SolverKind kind) {
    LinearSolverParams params;
    params.kind = kind;
    return params;
}

BlockCsr with_diagonal(BlockCsr A, int node, double value) {
    double* block = A.block(A.find(node, node));
    std::fill_n(block, A.d * A.d, 0.0);
    for (int r = 0; r < A.d; ++r) block[r * A.d + r] = value;
    return A;
}

}  // namespace

TEST_CASE("2D goes to Cholesky, large 3D systems to conjugate gradients, small ones to Cholesky") {
    const BlockCsr A = random_spd(125, 3, grid_3d(5));
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    LinearSolverParams params;
    CHECK(LinearSolver(2, params).solve(A, b, x).used == SolverKind::cholesky);
    CHECK(LinearSolver(3, params).solve(A, b, x).used == SolverKind::cholesky);
    params.cg_from_unknowns[1] = A.size();
    CHECK(LinearSolver(2, params).solve(A, b, x).used == SolverKind::cholesky);
    LinearSolver solver(3, params);
    const SolveResult result = solver.solve(A, b, x);
    CHECK(result.used == SolverKind::cg);
    CHECK(result.status == SolveStatus::success);
    CHECK(result.iterations > 0);
    CHECK_FALSE(result.failed_first);
    CHECK(solver.factor_flops() == 0);  // the analysis of Cholesky, dearer than the solve, was not made
    params.cg_from_unknowns[1] = A.size() + 1;
    CHECK(LinearSolver(3, params).solve(A, b, x).used == SolverKind::cholesky);
}

TEST_CASE("work is counted in passes over an entry: iterations times entries, of Cholesky more slowly than its flops") {
    const auto work_per_flop = [](int k) {
        const BlockCsr A = random_spd(k * k * k, 3, grid_3d(k));
        const std::vector<double> b = random_vector(A.size());
        std::vector<double> x;
        const SolveResult iterated = LinearSolver(3, params_of(SolverKind::cg)).solve(A, b, x);
        CHECK(iterated.work == static_cast<double>(iterated.iterations) * A.blocks() * 9);
        LinearSolver direct(3, params_of(SolverKind::cholesky));
        const double passes = direct.solve(A, b, x).work;
        CHECK(std::log(passes / 8.5) == doctest::Approx(0.7 * std::log(direct.factor_flops())));
        return passes / direct.factor_flops();
    };
    const double of_small = work_per_flop(4);
    CHECK(of_small > 2 * work_per_flop(12));
}

TEST_CASE("all solvers find the same solution, and say how good it is") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(400, d, grid(20, 20));
        const std::vector<double> expected = random_vector(A.size());
        std::vector<double> b(A.size()), x;
        multiply(A, expected.data(), b.data());
        for (SolverKind kind : {SolverKind::cg, SolverKind::gmres, SolverKind::cholesky}) {
            const SolveResult result = LinearSolver(2, params_of(kind)).solve(A, b, x);
            CHECK(result.status == SolveStatus::success);
            CHECK(result.used == kind);
            CHECK(result.relative_residual <= 1e-10);
            CHECK(max_difference(x, expected) < 1e-8);
        }
    }
}

TEST_CASE("the tolerance of the iterative solvers can be changed, before the first solve and between solves") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20), 1e-2);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
        LinearSolver solver(2, params_of(kind)), early(2, params_of(kind));
        const int exact = solver.solve(A, b, x).iterations;
        solver.set_tolerance(1e-2);
        const SolveResult loose = solver.solve(A, b, x);
        CHECK(loose.iterations < exact);
        CHECK(loose.relative_residual <= 1e-2);
        CHECK(loose.relative_residual > 1e-10);
        early.set_tolerance(1e-2);
        CHECK(early.solve(A, b, x).iterations == loose.iterations);
    }
}

TEST_CASE("where an iterative solver fails Cholesky takes over, and the result says so") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20), 1e-3);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
        LinearSolverParams params = params_of(kind);
        params.max_iterations = 3;
        LinearSolver solver(2, params);
        for (int repeat = 0; repeat < 3; ++repeat) {
            const SolveResult result = solver.solve(A, b, x);
            CHECK(result.status == SolveStatus::success);
            CHECK(result.used == SolverKind::cholesky);
            CHECK(result.failed_first == SolveStatus::max_iterations);
            CHECK(result.iterations == 3);
            CHECK(scaled_residual(A, x, b) < 1e-15);
        }
    }
}

TEST_CASE("without fallback the failure of the iterative solver is the result") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20), 1e-3);
    std::vector<double> x;
    LinearSolverParams params = params_of(SolverKind::cg);
    params.max_iterations = 1;
    params.fallback = false;
    LinearSolver solver(2, params);
    const SolveResult result = solver.solve(A, random_vector(A.size()), x);
    CHECK(result.status == SolveStatus::max_iterations);
    CHECK(result.used == SolverKind::cg);
    CHECK_FALSE(result.failed_first);
    CHECK(solver.factor_flops() == 0);
}

TEST_CASE("the analysis can be made beforehand, in any ordering, and gives the same solution") {
    const BlockCsr A = random_spd(400, 1, grid(20, 20));
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    double entries[2];
    for (const Ordering ordering : {Ordering::nested_dissection, Ordering::natural}) {
        LinearSolverParams params = params_of(SolverKind::cholesky);
        params.ordering = ordering;
        LinearSolver solver(2, params);
        solver.analyse(A);
        entries[ordering == Ordering::natural] = solver.factor_entries();
        CHECK(solver.factor_bytes() > 8 * solver.factor_entries());
        const SolveResult result = solver.solve(A, b, x);
        CHECK(scaled_residual(A, x, b) < 1e-15);
        CHECK(result.factor_seconds > 0);
        CHECK(result.solve_seconds > 0);
    }
    CHECK(entries[0] < entries[1]);
}

TEST_CASE("negative curvature is about the matrix: no Cholesky is tried") {
    // A Laplacian made indefinite by a shift below what ILU(0) notices. The coarse space sees it at once, but not where
    // a node is fixed, around which the soft mode bends.
    for (double fixed : {0.0, 10.0}) {
        BlockCsr A = random_spd(400, 1, grid(20, 20));
        for (int i = 0; i < A.n; ++i)
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                A.value[k] = A.col[k] == i ? A.row[i + 1] - A.row[i] - 1 - 5e-3 + (i == 0 ? fixed : 0) : -1;
        std::vector<double> x;
        LinearSolver solver(2, params_of(SolverKind::cg));
        const SolveResult result = solver.solve(A, std::vector<double>(400, 1.0), x);
        CHECK(result.status == SolveStatus::not_positive_definite);
        CHECK(result.used == SolverKind::cg);
        CHECK(result.iterations < 20);
        CHECK((result.iterations == 0) == (fixed == 0));
        CHECK_FALSE(result.failed_first);
        CHECK(solver.factor_flops() == 0);
    }
}

TEST_CASE("automatic stops trying conjugate gradients after two failures in a row") {
    const BlockCsr A = random_spd(125, 3, grid_3d(5), 1e-3);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    LinearSolverParams params;
    params.cg_from_unknowns[1] = 1;
    params.max_iterations = 2;
    LinearSolver solver(3, params);
    CHECK(solver.solve(A, b, x).failed_first);
    CHECK(solver.solve(A, b, x).failed_first);
    const SolveResult third = solver.solve(A, b, x);
    CHECK_FALSE(third.failed_first);
    CHECK(third.used == SolverKind::cholesky);
    CHECK(third.status == SolveStatus::success);
}

TEST_CASE("in 3D no Cholesky factorisation steps in whose work is many times what the iteration has spent") {
    const BlockCsr A = random_spd(1000, 3, grid_3d(10), 1e-3);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    LinearSolverParams params = params_of(SolverKind::cg);
    params.max_iterations = 1;
    LinearSolver solver(3, params);
    const SolveResult result = solver.solve(A, b, x);
    CHECK(result.status == SolveStatus::max_iterations);
    CHECK(result.used == SolverKind::cg);
    CHECK_FALSE(result.failed_first);
    CHECK(dot(b, x) > 0);  // a descent direction for -b
    CHECK(solver.factor_flops() == 0);
}

TEST_CASE("not_positive_definite is a result, with the node, x = 0 and no silent step") {
    const BlockCsr A = random_spd(100, 2, grid(10, 10)), bad = with_diagonal(A, 42, -1);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    LinearSolver solver(2, {});
    const SolveResult result = solver.solve(bad, b, x);
    CHECK(result.status == SolveStatus::not_positive_definite);
    CHECK(result.bad_node == 42);
    CHECK(result.relative_residual == 1);
    CHECK(x == std::vector<double>(A.size(), 0.0));
    CHECK(solver.solve(A, b, x).status == SolveStatus::success);
}

TEST_CASE("a pivot of ILU(0) that is not positive is reported at once, with its node") {
    const BlockCsr A = with_diagonal(random_spd(30, 2, path(30)), 11, -1);
    std::vector<double> x;
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
        LinearSolverParams params = params_of(kind);
        params.preconditioner = PreconditionerKind::ilu0;  // SSOR would know that the diagonal is A's
        const SolveResult checked = LinearSolver(2, params).solve(A, random_vector(60), x);
        CHECK(checked.status == SolveStatus::not_positive_definite);  // says Cholesky, asked after ILU(0)
        CHECK(checked.failed_first == SolveStatus::indefinite_preconditioner);
        CHECK(checked.iterations == 0);
        const SolveResult expected = LinearSolver(2, params).solve(A, random_vector(60), x, true);
        CHECK(expected.status == SolveStatus::indefinite_preconditioner);  // enough for a caller who expects it
        CHECK_FALSE(expected.failed_first);
        params.memory_limit = 1;  // no way out
        const SolveResult result = LinearSolver(2, params).solve(A, random_vector(60), x);
        CHECK(result.status == SolveStatus::indefinite_preconditioner);
        CHECK(result.bad_node == 11);
        CHECK(result.used == kind);
        CHECK(result.relative_residual == 1);
        CHECK(x == std::vector<double>(60, 0.0));
    }
}

TEST_CASE("in 3D a bad pivot of ILU(0) is answered by a heavier diagonal") {
    // Four nodes in a ring with springs of alternating sign: positive definite, but not without its fill.
    const Edges ring = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    BlockCsr A = random_spd(4, 3, ring);
    for (double& v : A.value) v = 0;
    const auto set = [&](int i, int j, double v) {
        for (int a = 0; a < 3; ++a) A.block(A.find(i, j))[a * 3 + a] = A.block(A.find(j, i))[a * 3 + a] = v;
    };
    for (int i = 0; i < 4; ++i) set(i, i, 1.6);  // eigenvalues 1.6 +- sqrt 2
    set(0, 1, 1), set(1, 2, 1), set(2, 3, 1), set(0, 3, -1);
    REQUIRE(make_ilu0(A)->factor(A).status == SolveStatus::indefinite_preconditioner);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres}) {
        const SolveResult result = LinearSolver(3, params_of(kind)).solve(A, b, x);
        CHECK(result.status == SolveStatus::success);
        CHECK(result.used == kind);
        CHECK(result.diagonal_shift > 0);
        CHECK_FALSE(result.failed_first);
        CHECK(scaled_residual(A, x, b) < 1e-10);
        const SolveResult flat = LinearSolver(2, params_of(kind)).solve(A, b, x);  // no shifts there, but SSOR for cg
        CHECK(flat.status == SolveStatus::success);
        CHECK((flat.preconditioner == PreconditionerKind::ssor) == (kind == SolverKind::cg));
        CHECK(flat.failed_first.has_value() == (kind == SolverKind::gmres));
    }
}

TEST_CASE("a matrix assembled in the order of the sweeps has the same solution, by nodes, and the same bits") {
    const BlockCsr A = random_spd(3375, 3, grid_3d(15), 1e-2);
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x, y;
    for (const SolverKind kind : {SolverKind::cg, SolverKind::gmres, SolverKind::cholesky}) {
        const LinearSolverParams params = params_of(kind);
        auto order = sweep_order(A, 3, params_of(SolverKind::cg));
        REQUIRE(order);
        const BlockCsr B = reordered(A, *order);
        for (int i = 0; i < A.n; i += 100)
            CHECK(B.block(B.find(B.row_of(i), B.row_of(i)))[0] == A.block(A.find(i, i))[0]);
        REQUIRE(LinearSolver(3, params).solve(A, b, x).status == SolveStatus::success);
        REQUIRE(LinearSolver(3, params).solve(B, b, y).status == SolveStatus::success);
        if (kind != SolverKind::cholesky) CHECK(x == y);
        CHECK(scaled_residual(A, y, b) < 1e-10);
        BlockCsr bad = B;
        bad.block(bad.find(bad.row_of(42), bad.row_of(42)))[0] = -1;
        if (kind == SolverKind::cholesky) CHECK(LinearSolver(3, params).solve(bad, b, y).bad_node >= 0);
        if (kind == SolverKind::gmres) CHECK(LinearSolver(3, params).solve(bad, b, y, true).bad_node == 42);
    }
    CHECK_FALSE(sweep_order(A, 3, params_of(SolverKind::cholesky)));
    CHECK_FALSE(sweep_order(A, 2, {}));
}

TEST_CASE("the preconditioner of conjugate gradients: ILU(0) for short rows, SSOR for long ones, or as asked for") {
    const BlockCsr sparse = random_spd(125, 3, grid_3d(5)), dense = random_spd(60, 3, complete(60));
    std::vector<double> x;
    const auto uses_ssor = [&](const BlockCsr& A, PreconditionerKind kind) {
        LinearSolverParams params = params_of(SolverKind::cg);
        params.preconditioner = kind;
        const SolveResult result = LinearSolver(3, params).solve(A, random_vector(A.size()), x);
        CHECK(result.status == SolveStatus::success);
        return result.preconditioner == PreconditionerKind::ssor;
    };
    CHECK_FALSE(uses_ssor(sparse, PreconditionerKind::automatic));
    CHECK(uses_ssor(dense, PreconditionerKind::automatic));
    CHECK(uses_ssor(sparse, PreconditionerKind::ssor));
    CHECK_FALSE(uses_ssor(dense, PreconditionerKind::ilu0));
    const auto ordered = [](const BlockCsr& A) { return reordered(A, *sweep_order(A, 3, params_of(SolverKind::cg))); };
    CHECK_FALSE(uses_ssor(ordered(dense), PreconditionerKind::automatic));  // all nodes are vertices, as of hexahedra
    CHECK(takes_ilu0(100, 700, false));
    CHECK_FALSE(takes_ilu0(100, 1500, true));  // tetrahedra of degree 1
    CHECK(takes_ilu0(100, 2700, true));        // hexahedra
    CHECK_FALSE(takes_ilu0(100, 2700, false));
}

TEST_CASE("a factor too large for the memory: refused if asked for, else left to conjugate gradients") {
    const BlockCsr A = random_spd(400, 2, grid(20, 20));
    const std::vector<double> b = random_vector(A.size());
    std::vector<double> x;
    LinearSolverParams params;
    params.memory_limit = 1000;
    const SolveResult automatic = LinearSolver(2, params).solve(A, b, x);
    CHECK(automatic.status == SolveStatus::success);
    CHECK(automatic.used == SolverKind::cg);
    params.kind = SolverKind::cholesky;
    LinearSolver refused(2, params);
    CHECK(refused.refused_bytes() == 0);  // not analysed yet
    CHECK(refused.solve(A, b, x).status == SolveStatus::too_large);
    CHECK(refused.refused_bytes() > 8 * refused.factor_entries());
    LinearSolver fitting(2, {});
    CHECK(fitting.solve(A, b, x).status == SolveStatus::success);
    CHECK(fitting.refused_bytes() == 0);
    params.kind = SolverKind::gmres;
    params.max_iterations = 1;
    const SolveResult stuck = LinearSolver(2, params).solve(A, b, x);
    CHECK(stuck.status == SolveStatus::max_iterations);
    CHECK_FALSE(stuck.failed_first);
}

TEST_CASE("numbers that are not finite never come back as a solution") {
    const BlockCsr A = random_spd(100, 2, grid(10, 10));
    std::vector<double> b = random_vector(A.size()), x;
    b[5] = std::numeric_limits<double>::quiet_NaN();
    for (SolverKind kind : {SolverKind::automatic, SolverKind::cg, SolverKind::gmres, SolverKind::cholesky}) {
        const SolveResult result = LinearSolver(2, params_of(kind)).solve(A, b, x);
        CHECK(result.status == SolveStatus::breakdown);
        CHECK(x == std::vector<double>(A.size(), 0.0));
    }
}

TEST_CASE("zero right-hand sides and empty systems") {
    const BlockCsr A = random_spd(25, 2, grid(5, 5)), empty = matrix_of_cells(0, 2, {}, 2);
    std::vector<double> x;
    for (SolverKind kind : {SolverKind::automatic, SolverKind::cg, SolverKind::gmres, SolverKind::cholesky}) {
        CHECK(LinearSolver(2, params_of(kind)).solve(A, std::vector<double>(50, 0.0), x).status ==
              SolveStatus::success);
        CHECK(x == std::vector<double>(50, 0.0));
        CHECK(LinearSolver(2, params_of(kind)).solve(empty, {}, x).status == SolveStatus::success);
    }
}

TEST_CASE("every status and kind has a name") {
    for (SolveStatus status :
         {SolveStatus::success, SolveStatus::max_iterations, SolveStatus::stagnated, SolveStatus::breakdown,
          SolveStatus::indefinite_preconditioner, SolveStatus::not_positive_definite, SolveStatus::too_large}) {
        CHECK(std::string(to_string(status)) != "");
        CHECK(std::string(reason(status)) != "");
    }
    CHECK(std::string(to_string(SolveStatus::success)) == "success");
    CHECK(std::string(to_string(SolveStatus::breakdown)) == "breakdown");
    CHECK(std::string(to_string(SolveStatus::too_large)) == "too_large");
    CHECK(std::string(to_string(SolverKind::automatic)) == "automatic");
    CHECK(std::string(to_string(SolverKind::cg)) == "cg");
    CHECK(std::string(to_string(SolverKind::gmres)) == "gmres");
    CHECK(std::string(to_string(SolverKind::cholesky)) == "cholesky");
}

TEST_CASE("the same bits for any number of threads, all solvers") {
    const BlockCsr A = random_spd(8000, 3, grid_3d(20), 1e-2);
    const std::vector<double> b = random_vector(A.size());
    const int before = max_threads();
    for (SolverKind kind : {SolverKind::cg, SolverKind::gmres, SolverKind::cholesky}) {
        std::vector<double> first, x;
        LinearSolver solver(3, params_of(kind));
        set_threads(1);
        CHECK(solver.solve(A, b, first).status == SolveStatus::success);
        for (int threads : {2, 3, 5}) {
            set_threads(threads);
            solver.solve(A, b, x);
            CHECK(x == first);
        }
    }
    set_threads(before);
}
