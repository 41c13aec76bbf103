#include "linalg/krylov/coarse_correction.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel.hpp"
#include "energy/vertex_interpolation.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "linalg/linear_solver.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

constexpr double single = 1e-5;  // L and V are kept in single precision

std::unique_ptr<Preconditioner> ssor_of(const BlockCsr& E) {
    return make_ilu0(E, {}, {}, Sweeps::ssor);
}

// A 3D grid numbered domain by domain: one domain for m <= 15.
struct CutGrid {
    BlockCsr A;
    std::vector<int> start;

    CutGrid(int m, int d) : A(random_spd(m * m * m, d, grid_3d(m), 1e-2)) {
        A = reordered(A, cut_into_domains(graph_of(A)));
        start = A.order->start;
    }

    std::unique_ptr<Preconditioner> corrected(const Interpolation& P) const {
        return make_ilu0(A, start, {}, Sweeps::ssor, std::make_unique<CoarseCorrection>(A, P, ssor_of));
    }
};

std::vector<double> product(const BlockCsr& A, const std::vector<double>& x) {
    std::vector<double> y(x.size());
    multiply(A, x.data(), y.data());
    return y;
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
    axpy(-1, b, a);
    return a;
}

// D^{-1} v for a diagonal block.
std::vector<double> block_solve(const double* D, int d, const std::vector<double>& v) {
    Dense L{d, std::vector<double>(D, D + d * d)};
    REQUIRE(dense_cholesky(L) == -1);
    return dense_solve(L, v);
}

// The sweep z = (D + T)^{-1} r, or (D + T')^{-1} r.
std::vector<double> sweep(const BlockCsr& A, const std::vector<double>& r, bool forward) {
    std::vector<double> z(r.size(), 0.0);
    for (int step = 0; step < A.n; ++step) {
        const int i = forward ? step : A.n - 1 - step;
        std::vector<double> sum(A.d);
        for (int a = 0; a < A.d; ++a) sum[a] = r[offset(i, A.d, a)];
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)  // z is zero in rows that are still to come
            for (int a = 0; a < A.d && A.col[k] != i; ++a)
                for (int b = 0; b < A.d; ++b) sum[a] -= A.block(k)[a * A.d + b] * z[offset(A.col[k], A.d, b)];
        sum = block_solve(A.block(A.find(i, i)), A.d, sum);
        for (int a = 0; a < A.d; ++a) z[offset(i, A.d, a)] = sum[a];
    }
    return z;
}

// One coarse unknown, with weights 0, 0.1, ... 0.6 in the rows.
Interpolation one_column(int rows) {
    Interpolation P;
    P.columns = 1;
    for (int i = 0; i < rows; ++i) {
        if (i % 7 > 0) {
            P.col.push_back(0);
            P.weight.push_back(0.1 * (i % 7));
        }
        P.row.push_back(static_cast<int>(P.col.size()));
    }
    return P;
}

std::vector<double> corrected_by_hand(const BlockCsr& A, const Interpolation& P, const std::vector<double>& r) {
    const int d = A.d;
    std::vector<double> weight(A.n, 0.0), z = sweep(A, r, true), right(d, 0.0), E(d * d, 0.0);
    for (int i = 0; i < A.n; ++i)
        if (P.row[i] < P.row[i + 1]) weight[i] = P.weight[P.row[i]];
    const std::vector<double> left = difference(r, product(A, z));
    for (int i = 0; i < A.n; ++i) {
        for (int a = 0; a < d; ++a) right[a] += weight[i] * left[offset(i, d, a)];
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int e = 0; e < d * d; ++e) E[e] += weight[i] * A.block(k)[e] * weight[A.col[k]];
    }
    const std::vector<double> c = block_solve(E.data(), d, right);
    for (int i = 0; i < A.n; ++i)
        for (int a = 0; a < d; ++a) z[offset(i, d, a)] += weight[i] * c[a];
    axpy(1, sweep(A, difference(r, product(A, z)), false), z);
    return z;
}

// The Laplacian of the graph, with `excess` on the diagonal. d = 1.
void make_laplacian(BlockCsr& A, double excess) {
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            *A.block(k) = A.col[k] != i ? -1 : A.row[i + 1] - A.row[i] - 1 + excess;
}

// Constant on consecutive rows.
Interpolation constant_on(int rows, int columns) {
    Interpolation P;
    P.columns = columns;
    for (int i = 0; i < rows; ++i) {
        P.col.push_back(i * columns / rows);
        P.weight.push_back(1);
        P.row.push_back(i + 1);
    }
    return P;
}

// The Hessian of a cube's energy with elements of a degree, in the order of its sweeps.
struct CubeHessian {
    Minimisation problem;
    BlockCsr H;
    std::vector<double> b;

    explicit CubeHessian(int degree, int k = 6, double half_from_blocks = 1e9)
        : problem(raise_degree(cube_mesh(k), degree), {{"bottom", "fixed"}, {"top", "fixed"}, {"sides", "fixed"}},
                  Objective::squared) {
        problem.distortion.order_hessian([&](const BlockCsr& pattern) {
            return sweep_order(pattern, 3, {.kind = SolverKind::cg, .half_from_blocks = half_from_blocks},
                               vertex_interpolation(problem.mesh));
        });
        H = problem.distortion.hessian_pattern();
        problem.functional(100).hessian(problem.ideal, HessianKind::full, H);
        b = random_vector(H.size());
    }

    SolveResult solve(PreconditionerKind kind, std::vector<double>& x) const {
        return LinearSolver(3, {.kind = SolverKind::cg, .preconditioner = kind, .tolerance = 1e-8, .fallback = false})
            .solve(H, b, x);
    }
};

}  // namespace

TEST_CASE("a sweep forward, the correction, a sweep back: z, r'z, z'A z, and A z in the next sweep") {
    for (int d = 1; d <= 3; ++d)
        for (int m : {6, 18}) {
            const CutGrid grid(m, d);
            const BlockCsr& A = grid.A;
            CHECK(grid.start.size() == (m == 6 ? 2 : 9));
            const Interpolation P = one_column(A.n);
            const auto made = grid.corrected(P);
            Preconditioner& M = *made;
            REQUIRE(M.factor(A).status == SolveStatus::success);
            REQUIRE(M.puts_off_products());
            std::vector<double> r = random_vector(A.size()), z(r.size()), Az(r.size()), q = random_vector(A.size(), 2);
            const auto check = [&](const Products& found) {
                const std::vector<double> expected = corrected_by_hand(A, P, r);
                CHECK(max_difference(z, expected) < single * norm_inf(expected));
                CHECK(found.rz == doctest::Approx(dot(r, z)).epsilon(single));
                CHECK(found.zAz == doctest::Approx(dot(z, product(A, z))).epsilon(single));
                CHECK_FALSE(found.is_indefinite);
            };
            check(M.apply_and_put_off(r.data(), z.data(), Az.data()));
            std::vector<double> new_q = product(A, z), new_r = r;
            axpy(0.25, q, new_q);
            axpy(-0.1, new_q, new_r);
            const Products found = M.advance(0.1, 0.25, q.data(), r.data(), z.data(), Az.data());
            CHECK(max_difference(q, new_q) <= single * norm_inf(new_q));
            CHECK(max_difference(r, new_r) <= single * norm_inf(new_r));
            check(found);
        }
}

TEST_CASE("what is smooth is left to the coarse unknowns: the energy norm of its error falls far more than without") {
    CutGrid grid(18, 1);
    make_laplacian(grid.A, 1e-4);
    const auto made = grid.corrected(constant_on(grid.A.n, 3)), alone = make_ilu0(grid.A, grid.start, {}, Sweeps::ssor);
    Preconditioner &M = *made, &plain = *alone;
    REQUIRE(M.factor(grid.A).status == SolveStatus::success);
    REQUIRE(plain.factor(grid.A).status == SolveStatus::success);
    const std::vector<double> x(grid.A.size(), 1.0), b = product(grid.A, x);
    std::vector<double> z(x.size()), Az(x.size());
    const auto error = [&](Preconditioner& by) {
        by.apply_and_put_off(b.data(), z.data(), Az.data());
        const std::vector<double> e = difference(x, z);
        return dot(e, product(grid.A, e));
    };
    CHECK(error(M) < 0.1 * error(plain));
}

TEST_CASE("elements of degree 2 and 3: less than half the iterations with SSOR alone, and the same solution") {
    for (int degree : {2, 3}) {
        const CubeHessian cube(degree);
        std::vector<double> x, y;
        const SolveResult with = cube.solve(PreconditionerKind::automatic, x);
        const SolveResult without = cube.solve(PreconditionerKind::ssor, y);
        REQUIRE(with.status == SolveStatus::success);
        REQUIRE(without.status == SolveStatus::success);
        CHECK(with.preconditioner == PreconditionerKind::pmg);
        CHECK(without.preconditioner == PreconditionerKind::ssor);
        CAPTURE(with.iterations);
        CAPTURE(without.iterations);
        CHECK(2 * with.iterations < without.iterations);
        CHECK(max_difference(x, y) < 1e-4 * norm_inf(y));
    }
}

TEST_CASE("degree 1 and solvers with an order of their own take SSOR where a correction is asked for") {
    const CubeHessian cube(1);
    std::vector<double> x;
    CHECK(cube.solve(PreconditionerKind::pmg, x).preconditioner == PreconditionerKind::ssor);
    const BlockCsr A = random_spd(125, 3, grid_3d(5));
    LinearSolver solver(3, {.kind = SolverKind::cg, .preconditioner = PreconditionerKind::pmg});
    CHECK(solver.solve(A, random_vector(A.size()), x).preconditioner == PreconditionerKind::ssor);
}

TEST_CASE("the correction has the same bits for any number of threads") {
    const CubeHessian cube(2);
    std::vector<double> first;
    const int threads_before = max_threads();
    for (int threads : {1, 2, 3, 5}) {
        set_threads(threads);
        std::vector<double> x;
        REQUIRE(cube.solve(PreconditionerKind::pmg, x).status == SolveStatus::success);
        if (first.empty()) first = x;
        CHECK(x == first);
    }
    set_threads(threads_before);
}

TEST_CASE("a coarse matrix that is not positive definite shows that the matrix is not, before any iteration") {
    CutGrid grid(6, 1);
    make_laplacian(grid.A, -1e-4);
    SUBCASE("a pivot of it is negative") {
        const auto made = grid.corrected(constant_on(grid.A.n, 1));
        Preconditioner& M = *made;
        CHECK(M.factor(grid.A).status == SolveStatus::not_positive_definite);
    }
    SUBCASE("or its conjugate gradients meet negative curvature") {
        const auto made = grid.corrected(constant_on(grid.A.n, 4));
        Preconditioner& M = *made;
        REQUIRE(M.factor(grid.A).status == SolveStatus::success);
        std::vector<double> b(grid.A.size(), 1.0), x(b.size());
        const KrylovResult result = ConjugateGradients(grid.A.size(), {100, 1e-8}).solve(grid.A, M, b.data(), x.data());
        CHECK(result.status == SolveStatus::not_positive_definite);
        CHECK(result.iterations == 0);
    }
}

TEST_CASE("the interpolation goes with the order of the rows, and no domain's vertices are next to another's") {
    const CubeHessian cube(2, 10);
    const RowOrder& order = *cube.H.order;
    CHECK(order.start.size() == 9);
    const Interpolation& P = order.of_vertices;
    REQUIRE(P.rows() == cube.H.n);
    std::vector<int> node(P.columns, -1);  // of a column
    for (int i = 0; i < P.rows(); ++i)
        if (P.row[i + 1] - P.row[i] == 1) node[P.col[P.row[i]]] = order.node[i];
    for (int i = 0; i < P.rows(); ++i)
        for (int a = 0; a < 3; ++a) {
            double at = 0;
            for (int k = P.row[i]; k < P.row[i + 1]; ++k)
                at += P.weight[k] * point(cube.problem.ideal, node[P.col[k]], 3)[a];
            CHECK(at == doctest::Approx(point(cube.problem.ideal, order.node[i], 3)[a]));
        }
    REQUIRE(order.vertex_start.size() == order.start.size());
    const auto domain = [](const std::vector<int>& start, int row) {
        return std::upper_bound(start.begin(), start.end(), row) - start.begin();
    };
    for (int c = 0; c < P.columns; ++c)
        CHECK(domain(order.vertex_start, c) == domain(order.start, order.row[node[c]]));
}

TEST_CASE("half of the matrix: the same solution in no more iterations, and the same bits for any number of threads") {
    const CubeHessian whole(4, 3), half(4, 3, 0);
    REQUIRE_FALSE(whole.H.in_half());
    REQUIRE(half.H.in_half());
    CHECK(2 * half.H.blocks() + half.H.n == whole.H.blocks());
    std::vector<double> x, first;
    const SolveResult of_whole = whole.solve(PreconditionerKind::automatic, x);
    const LargeVector<float> below = *half.H.below;  // the preconditioner takes its place
    const int threads_before = max_threads();
    for (int threads : {1, 2, 3, 5}) {
        set_threads(threads);
        *half.H.below = below;
        std::vector<double> y;
        const SolveResult of_half = half.solve(PreconditionerKind::automatic, y);
        REQUIRE(of_half.status == SolveStatus::success);
        CHECK(of_half.preconditioner == PreconditionerKind::pmg);
        CHECK(of_half.relative_residual <= 1e-8);
        CHECK(of_half.iterations <= of_whole.iterations);
        CHECK(max_difference(y, x) < single * norm_inf(x));
        if (first.empty()) first = y;
        CHECK(y == first);
    }
    set_threads(threads_before);
}

TEST_CASE("half of a matrix that is not positive definite is found out: by a block, or by conjugate gradients") {
    CubeHessian half(4, 3, 0);
    std::vector<double> x;
    SUBCASE("what is beside the diagonal is too large") {
        for (float& entry : *half.H.below) entry *= 4;
        CHECK(half.solve(PreconditionerKind::automatic, x).status == SolveStatus::not_positive_definite);
    }
    SUBCASE("a block of the diagonal is negative") {
        *half.H.diagonal(7) = -1;
        const SolveResult result = half.solve(PreconditionerKind::automatic, x);
        CHECK(result.status == SolveStatus::indefinite_preconditioner);
        CHECK(result.bad_node == half.H.node_of(7));
    }
}

TEST_CASE("half of a matrix is stored where rows are long, there are many, and nothing else than pmg may solve it") {
    const LinearSolverParams usual;
    CHECK(stores_half(3e5, 1.6e7, 3, usual));
    CHECK_FALSE(stores_half(3e5, 1.6e7, 2, usual));
    CHECK_FALSE(stores_half(2e5, 1.1e7, 3, usual));
    CHECK_FALSE(stores_half(1e6, 2.8e7, 3, usual));  // tetrahedra of degree 2
    CHECK_FALSE(stores_half(3e5, 1.6e7, 3, {.kind = SolverKind::cholesky}));
    CHECK_FALSE(stores_half(3e5, 1.6e7, 3, {.kind = SolverKind::gmres}));
    CHECK_FALSE(stores_half(3e5, 1.6e7, 3, {.preconditioner = PreconditionerKind::ssor}));
    CHECK_FALSE(stores_half(3e5, 1.6e7, 3, {.ordering = Ordering::natural}));
}
