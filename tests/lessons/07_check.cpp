#include "lessons/exercises/07.hpp"

#include "lessons/circle.hpp"
#include "lessons/dense.hpp"
#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(exact_multiplier, wall_forces, penalty_for, method_of_multipliers, stiffest_mode);

double largest_difference(const Vector& a, const Vector& b) {
    double largest = a.size() == b.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

EXERCISE("7.1", "the exact multiplier from two constraints") {
    for (const double kappa : {2.0, 30.0, -1.0})
        for (const double mu : {8.0, 100.0}) {
            const double g = 3, exact = kappa * g;  // E = kappa x^2 / 2, c = x - g
            double lambda = 0.7, c[2];
            const double start = lambda;
            for (double& c_k : c) {
                c_k = (lambda + mu * g) / (kappa + mu) - g;
                lambda -= mu * c_k;
            }
            const double found = exact_multiplier(start, mu, c[0], c[1]);
            const std::string where = concat(" with lambda = 0.7, mu = ", mu, ", c_1 = ", c[0], ", c_2 = ", c[1]);
            expect(std::abs(found - (start + start - exact)) > 1e-9, "the multiplier", where, " is ", found,
                   ", as far from lambda as the exact one, but on the other side: the sign of the update");
            expect(std::abs(found - lambda) > 1e-9, "the multiplier", where, " is that after the second update, ",
                   found, "; the exact one is ", exact, ": the third and all later ones are known too");
            expect_close(concat("the multiplier", where), found, exact, 1e-9,
                         "c shrinks by the factor c_2 / c_1 with every update, and lambda changes by -mu c each time");
        }
}

EXERCISE("7.2", "the forces of a wall") {
    const std::vector<std::array<int, 2>> triangle = {{0, 1}, {1, 2}, {2, 0}};
    const Vector same = wall_forces(triangle, {3, 1, 3, 1, 3, 1});
    expect(same.size() == 6, "there are ", same.size(), " entries, expected 6");
    const double one = std::sqrt(3.0);
    expect_close("sum of the forces in x on a triangle with lambda = (3, 1) everywhere", same[0] + same[2] + same[4],
                 9 / one, 1e-12, "an edge adds 2/6 + 1/6 + 1/6 + 2/6 = 1 to the sum of M, and f = M lambda / |1|");
    const Mesh mesh = ring();
    Dirichlet constraint(mesh, mesh.x, inner_circle_by(mesh, "fixed"), TargetKind::nodal);
    const std::vector<int>& nodes = constraint.nodes();
    std::vector<std::array<int, 2>> edges;
    for (int k = 0; k < mesh.face_count(); ++k) {
        std::array<int, 2> edge;
        for (int v = 0; v < 2; ++v)
            edge[v] = static_cast<int>(std::find(nodes.begin(), nodes.end(), mesh.face(k)[v]) - nodes.begin());
        edges.push_back(edge);
    }
    Vector lambda(constraint.multipliers()), g(mesh.x.size(), 0.0), expected;
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] = std::sin(1.0 + 3.0 * static_cast<double>(i));
    constraint.add_gradient(mesh.x, lambda, 0, g);
    for (const int node : nodes)
        for (int a = 0; a < 2; ++a) expected.push_back(-g[2 * node + a]);
    const Vector f = wall_forces(edges, lambda);
    const double difference = largest_difference(f, expected);
    expect(difference < 1e-12, "on the ring the largest difference from the program's forces is ", difference,
           ": where lambda changes from node to node, the neighbours count with 1/6");
}

EXERCISE("7.3", "how large a penalty") {
    expect_close("the penalty for kappa = 5 and a tenth of the error", penalty_for(5, 10), 45, 1e-12,
                 "an update multiplies the error by kappa / (kappa + mu)");
    expect_close("the penalty for kappa = 5 and a thousandth", penalty_for(5, 1000), 4995, 1e-12);
    expect_close("the penalty for kappa = -2 and a tenth", penalty_for(-2, 10), 22, 1e-12,
                 "kappa + mu is positive, or there is no minimum; the factor is then negative");
}

EXERCISE("7.4", "the method of multipliers") {
    expect_soon("|c| <= 1e-10 is never reached: is lambda in the function that is minimised? and is its update "
                "lambda - mu c? with the other sign |c| doubles");
    const Vec<2> b = {1, -2}, a = {1, 3};
    for (const Mat<2>& K : {Mat<2>{{{4, 1}, {1, 3}}}, Mat<2>{{{2, 0}, {0, -0.1}}}})
        for (const double mu : {3.0, 30.0}) {
            // x = K^{-1} (b + lambda a), a' x = g; the stiffness of the constraint is 1 / (a' K^{-1} a).
            const Mat<2> inverted = inverse<2>(K);
            double aKa = 0, aKb = 0;
            for (int i = 0; i < 2; ++i)
                for (int j = 0; j < 2; ++j) aKa += a[i] * inverted[i][j] * a[j], aKb += a[i] * inverted[i][j] * b[j];
            const double g = 7, kappa = 1 / aKa, lambda = (g - aKb) * kappa, factor = std::abs(kappa / (kappa + mu));
            const Multiplier found = method_of_multipliers(K, b, a, g, mu);
            const std::string where =
                concat(" with K = (", K[0][0], " ", K[0][1], "; ", K[1][0], " ", K[1][1], "), mu = ", mu);
            expect_close(concat("lambda", where), found.lambda, lambda, 1e-6,
                         "K x - b = lambda a and a' x = g hold at the end");
            // |c| after the first subproblem, and then times the factor.
            const double first = std::abs(lambda / (kappa + mu));
            const double updates = 1 + std::ceil(std::log(1e-10 / first) / std::log(factor));
            expect(std::abs(found.updates - updates) <= 1, found.updates, " updates", where, ", expected ", updates,
                   ": each should multiply |c| by ", factor, "; update once for every subproblem");
        }
}

EXERCISE("7.5", "three updates") {
    expect_only("three", {"mesh = ../../../meshes/circle.msh", "boundary inner = rotate 60 about 0 0",
                          "boundary outer = fixed", "objective = squared", "algorithm = paper", "length_scale = 1",
                          "omega_star = 1e-6", "epsilon_star = 1e-14"}, {"mu0"});
    const double mu0 = parse_double(keys_of_deck("three")["mu0"]).value_or(NAN);
    expect(mu0 > 0, "three.deck has no mu0 above 0");
    const double updates = number(run_deck("three"), "al_iterations");
    expect(updates <= 3, "with mu0 = ", mu0, " it takes ", updates, " iterations: a stiffer penalty makes each update ",
           "count for more");
    const double before = number(run_deck("three", {concat("mu0=", mu0 / 10)}), "al_iterations");
    expect(before > 3, "with a tenth of your mu0, ", mu0 / 10, ", it takes ", before,
           " iterations: a smaller penalty will do");
    const double exponent = std::log10(mu0);
    expect_close("log10 of mu0", exponent, std::round(exponent), 1e-9, "a power of ten is asked for");
}

using Rows = std::vector<Vector>;

// The largest mode, without S: by Sylvester's law of inertia K - kappa M / |1|^2 has as many negative eigenvalues as
// there are modes below kappa.
double largest_mode(const Rows& K, const Rows& M, double one_squared) {
    const int n = static_cast<int>(K.size()), boundary = static_cast<int>(M.size());
    double low = 0, high = 1e6;
    while (high - low > 1e-9 * high) {
        const double kappa = 0.5 * (low + high);
        std::vector<double> A;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const int k = i - n + boundary, l = j - n + boundary;
                A.push_back(K[i][j] - (k >= 0 && l >= 0 ? kappa * M[k][l] / one_squared : 0));
            }
        (negative_eigenvalues(n, A) == boundary ? high : low) = kappa;
    }
    return high;
}

// The five-point Laplacian, and 0.001, on m x m squares: (m - 1)^2 nodes inside, then 4 m around.
struct Squares {
    Rows K, M;
    explicit Squares(int m) {
        const auto number = [m](int i, int j) {
            if (i > 0 && i < m && j > 0 && j < m) return (i - 1) * (m - 1) + j - 1;
            return (m - 1) * (m - 1) + (j == 0 ? i : i == m ? m + j : j == m ? 3 * m - i : 4 * m - j);
        };
        K = Rows((m + 1) * (m + 1), Vector((m + 1) * (m + 1)));
        M = Rows(4 * m, Vector(4 * m));
        const auto join = [&](int a, int b, double weight) {
            K[a][a] += weight, K[b][b] += weight, K[a][b] -= weight, K[b][a] -= weight;
        };
        for (int i = 0; i <= m; ++i)
            for (int j = 0; j < m; ++j) {
                const double weight = i == 0 || i == m ? 0.5 : 1;
                join(number(i, j), number(i, j + 1), weight);
                join(number(j, i), number(j + 1, i), weight);
            }
        for (std::size_t i = 0; i < K.size(); ++i) K[i][i] += 0.001;
        for (int k = 0; k < 4 * m; ++k) {
            const int next = (k + 1) % (4 * m);
            M[k][k] += 1.0 / 3, M[next][next] += 1.0 / 3, M[k][next] += 1.0 / 6, M[next][k] += 1.0 / 6;
        }
    }
};

EXERCISE("7.6", "an hour: the stiffest mode") {
    expect_close("a spring of stiffness 5 with M = 2 and |1|^2 = 8", stiffest_mode({{5}}, {{2}}, 8), 20, 1e-6,
                 "nothing is inside, S = 5, and S v = kappa M v / |1|^2");
    const double two = stiffest_mode({{4, 1}, {1, 3}}, {{2}}, 8);
    expect(std::abs(two - 12) > 1e-6, "with K = (4 1; 1 3), M = 2, |1|^2 = 8 it is 12, from the 3 of K alone: the ",
           "unknown inside does not stay where it is, it goes to its minimum, 4 x_0 + x_1 = 0");
    expect_close("with K = (4 1; 1 3), M = 2, |1|^2 = 8", two, 11, 1e-6, "S = 3 - 1/4");
    expect_close("with K = (5 2; 2 5), M = (1 0; 0 1), |1|^2 = 8", stiffest_mode({{5, 2}, {2, 5}}, {{1, 0}, {0, 1}}, 8),
                 56, 1e-6, "both unknowns are on the boundary, so none is eliminated and S = K; 7 is its largest mode");
    for (const int m : {3, 8, 13}) {
        const Squares squares(m);
        const double expected = largest_mode(squares.K, squares.M, 4 * m);
        expect_close(concat("kappa / |1|^2 on ", m, " x ", m, " squares"),
                     stiffest_mode(squares.K, squares.M, 4 * m) / (4 * m), expected / (4 * m), 1e-5,
                     "the largest of all modes: a zigzag, neighbours move against each other; a smooth first guess "
                     "hardly has it");
    }
}

}  // namespace
}  // namespace almesh::lessons
