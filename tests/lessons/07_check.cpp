#include "lessons/exercises/07.hpp"

#include <algorithm>
#include <cmath>

#include "lessons/circle.hpp"
#include "lessons/dense.hpp"
#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(exact_multiplier, wall_forces, penalty_for, method_of_multipliers, stiffest_mode);

// Infinite where an entry is no number.
double largest_difference(const Vector& a, const Vector& b) {
    double largest = a.size() == b.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
        const double difference = std::abs(a[i] - b[i]);
        if (!(difference <= largest)) largest = std::isnan(difference) ? INFINITY : difference;
    }
    return largest;
}

bool is_close(double value, double expected, double tolerance) {
    return std::abs(value - expected) <= tolerance * std::abs(expected);
}

EXERCISE("7.1", "the exact multiplier from two constraints") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double unit = random.scale(1e-3, 1e3),
                     kappa = unit * (k % 3 == 2 ? -random.uniform(0.1, 1) : random.scale(0.1, 30));
        const double mu = std::abs(kappa) * random.scale(1.2, 50), g = random.uniform(-5, 5), exact = kappa * g;
        const double start =
            exact + std::abs(kappa) * random.scale(0.1, 10) * (k % 2 ? 1 : -1);  // E = kappa x^2 / 2, c = x - g
        double lambda = start, c[2];
        for (double& c_k : c) {
            c_k = (lambda + mu * g) / (kappa + mu) - g;
            lambda -= mu * c_k;
        }
        const double found = exact_multiplier(start, mu, c[0], c[1]), off = 1e-8 * (std::abs(exact) + std::abs(start));
        const std::string where = concat(" with lambda = ", start, ", mu = ", mu, ", c_1 = ", c[0], ", c_2 = ", c[1]);
        expect(std::abs(found - (start + start - exact)) > off, "the multiplier", where, " is ", found,
               ", as far from lambda as the exact one, but on the other side: the sign of the update");
        expect(std::abs(found - lambda) > off || std::abs(lambda - exact) <= off, "the multiplier", where,
               " is that after the second update, ", found, "; the exact one is ", exact,
               ": the third and all later ones are known too");
        expect(std::abs(found - exact) <= off, "the multiplier", where, " is ", found, ", expected ", exact,
               ": c shrinks by the same factor with every update, and lambda changes by -mu c each time");
    }
}

// Edges between `nodes` nodes with any numbers: a chain, closed or not, and a few more.
std::vector<std::array<int, 2>> random_wall(int nodes) {
    Random& random = random_inputs();
    std::vector<int> number(nodes);
    for (int i = 0; i < nodes; ++i) number[i] = i;
    random.shuffle(number);
    std::vector<std::array<int, 2>> edges;
    for (int i = 1; i < nodes; ++i) edges.push_back({number[i - 1], number[i]});
    const int more = nodes > 2 ? random.integer(0, std::min(3, nodes - 2)) : 0;
    for (int k = 0; k < more; ++k) edges.push_back({number[k], number[nodes - 1]});
    for (auto& edge : edges)
        if (random.integer(0, 1)) std::swap(edge[0], edge[1]);
    random.shuffle(edges);
    return edges;
}

EXERCISE("7.2", "the forces of a wall") {
    const std::vector<std::array<int, 2>> triangle = {{0, 1}, {1, 2}, {2, 0}};
    const Vector same = wall_forces(triangle, {3, 1, 3, 1, 3, 1});
    expect(same.size() == 6, "there are ", same.size(), " entries, expected 6");
    const double one = std::sqrt(3.0);
    expect_close("sum of the forces in x on a triangle with lambda = (3, 1) everywhere", same[0] + same[2] + same[4],
                 9 / one, 1e-12, "an edge adds 2/6 + 1/6 + 1/6 + 2/6 = 1 to the sum of M, and f = M lambda / |1|");
    for (int k = 0; k < 12; ++k) {
        const int nodes = k == 0 ? 2 : random_inputs().integer(3, 12);
        const std::vector<std::array<int, 2>> edges = random_wall(nodes);
        Vector lambda(2 * nodes), expected(2 * nodes);
        for (double& entry : lambda) entry = random_inputs().uniform(-3, 3);
        for (int node = 0; node < nodes; ++node)  // row by row of M
            for (const auto& [i, j] : edges)
                for (const int a : {0, 1})
                    if (node == i || node == j)
                        expected[2 * node + a] += (lambda[2 * i + a] + lambda[2 * j + a] + lambda[2 * node + a]) / 6 /
                                                  std::sqrt(edges.size());
        const double difference = largest_difference(wall_forces(edges, lambda), expected);
        expect(difference < 1e-12, "with ", edges.size(), " edges between ", nodes, " nodes the largest error is ",
               difference, ": f = M lambda / |1|; the neighbours count, and |1|^2 is the number of edges");
    }
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
    for (double& entry : lambda) entry = random_inputs().uniform(-1, 1);
    constraint.add_gradient(mesh.x, lambda, 0, g);
    for (const int node : nodes)
        for (int a = 0; a < 2; ++a) expected.push_back(-g[2 * node + a]);
    const Vector f = wall_forces(edges, lambda);
    const double difference = largest_difference(f, expected);
    expect(difference < 1e-12, "on the ring the largest difference from the program's forces is ", difference,
           ": where lambda changes from node to node, the neighbours count with 1/6");
}

EXERCISE("7.3", "how large a penalty") {
    for (int k = 0; k < 24; ++k) {
        Random& random = random_inputs();
        const double kappa = random.scale(1e-3, 1e3) * (k % 2 ? -1 : 1), q = 1 + random.scale(0.05, 1e4);
        const double mu = penalty_for(kappa, q), factor = kappa / (kappa + mu);
        const std::string of = concat("the penalty for kappa = ", kappa, " and 1/", q, " of the error is ", mu);
        expect(mu > 0 && kappa + mu > 0, of, ": mu and kappa + mu have to be positive, or there is no minimum");
        expect(std::abs(std::abs(factor) * q - 1) < 1e-9, of, ", with which an update multiplies the error by ", factor,
               kappa < 0 ? ": the factor is then negative" : ": kappa / (kappa + mu)");
    }
}

struct Constrained {
    Mat<2> K;
    Vec<2> a, b;
    double g, kappa, lambda, mu,
        factor;  // the stiffness of the constraint, the exact multiplier, and what updates do to it
    int updates;
};

// One whose |c| is not nearly 1e-10 after any update.
Constrained random_problem(bool convex) {
    Random& random = random_inputs();
    for (;;) {
        Constrained p;
        const double turn = random.uniform(0, 3.14), c = std::cos(turn), s = std::sin(turn), l = random.uniform(0.5, 4),
                     m = convex ? random.uniform(0.5, 4) : -random.uniform(0.05, 1);
        p.K = {{{c * c * l + s * s * m, c * s * (l - m)}, {c * s * (l - m), s * s * l + c * c * m}}};
        for (int i = 0; i < 2; ++i) p.a[i] = random.uniform(-3, 3), p.b[i] = random.uniform(-3, 3);
        p.g = random.uniform(-8, 8);
        // x = K^{-1} (b + lambda a), a' x = g; the stiffness of the constraint is 1 / (a' K^{-1} a).
        const Mat<2> inverted = inverse<2>(p.K);
        double aKa = 0, aKb = 0;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                aKa += p.a[i] * inverted[i][j] * p.a[j], aKb += p.a[i] * inverted[i][j] * p.b[j];
        p.kappa = 1 / aKa;
        if (std::abs(p.kappa) < 0.02 || std::abs(p.kappa) > 20 || (p.kappa > 0) != convex) continue;
        p.lambda = (p.g - aKb) * p.kappa;
        p.mu = std::abs(p.kappa) * (convex ? random.scale(0.3, 30) : random.scale(2.5, 30));
        p.factor = p.kappa / (p.kappa + p.mu);
        double size = std::abs(p.lambda / (p.kappa + p.mu)), nearest = INFINITY;
        for (p.updates = 1; size > 1e-10; size *= std::abs(p.factor), ++p.updates)
            nearest = std::min(nearest, std::abs(std::log(size * 1e10)));
        if (p.updates > 1 && std::min(nearest, std::abs(std::log(size * 1e10))) > 0.15) return p;
    }
}

EXERCISE("7.4", "the method of multipliers") {
    expect_soon("|c| <= 1e-10 is never reached: is lambda in the function that is minimised? and is its update "
                "lambda - mu c? with the other sign |c| doubles");
    for (int k = 0; k < 24; ++k) {
        const Constrained p = random_problem(k % 3 != 2);
        const Multiplier found = method_of_multipliers(p.K, p.b, p.a, p.g, p.mu);
        const std::string where = concat(" with K = (", p.K[0][0], " ", p.K[0][1], "; ", p.K[1][0], " ", p.K[1][1],
                                         "), b = (", p.b[0], ", ", p.b[1], "), a = (", p.a[0], ", ", p.a[1], "), g = ",
                                         p.g, ", mu = ", p.mu);
        expect_close(concat("lambda", where), found.lambda, p.lambda, 1e-6,
                     "K x - b = lambda a and a' x = g hold at the end");
        expect(found.updates == p.updates, found.updates, " updates", where, ", expected ", p.updates,
               ": each should multiply |c| by ", std::abs(p.factor),
               "; update once for every subproblem, the last one too");
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
    const auto is_below = [&](double kappa) {
        std::vector<double> A;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const int k = i - n + boundary, l = j - n + boundary;
                A.push_back(K[i][j] - (k >= 0 && l >= 0 ? kappa * M[k][l] / one_squared : 0));
            }
        return negative_eigenvalues(n, A) < boundary;
    };
    double low = 0, high = 1;
    while (is_below(high)) low = high, high *= 16;
    while (high - low > 1e-9 * high) {
        const double kappa = 0.5 * (low + high);
        (is_below(kappa) ? low : high) = kappa;
    }
    return high;
}

// Symmetric and positive definite, of a size about `unit`.
Rows random_matrix(int n, double unit) {
    Rows A(n, Vector(n)), B(n, Vector(n));
    for (Vector& row : B)
        for (double& entry : row) entry = random_inputs().uniform(-1, 1);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            for (int k = 0; k < n; ++k) A[i][j] += unit * B[i][k] * B[j][k];
            if (i == j) A[i][j] += 0.3 * unit;
        }
    return A;
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
    for (const int m : {3, random_inputs().integer(4, 10), 13}) {
        Squares squares(m);
        const double unit = random_inputs().scale(1e-3, 1e3);
        for (Vector& row : squares.K)
            for (double& entry : row) entry *= unit;
        const double expected = largest_mode(squares.K, squares.M, 4 * m),
                     found = stiffest_mode(squares.K, squares.M, 4 * m);
        expect(is_close(found, expected, 1e-5), "kappa / |1|^2 on ", m, " x ", m, " squares of stiffness ", unit,
               " is ", found / (4 * m), ", expected ", expected / (4 * m),
               ": the largest of all modes: a zigzag, neighbours move ",
               "against each other; a smooth first guess hardly has it");
    }
    for (int k = 0; k < 6; ++k) {
        const int boundary = random_inputs().integer(1, 4), inside = random_inputs().integer(0, 4);
        const Rows K = random_matrix(inside + boundary, random_inputs().scale(1e-4, 1e5)),
                   M = random_matrix(boundary, random_inputs().scale(0.1, 10));
        const double one_squared = random_inputs().uniform(1, 50), expected = largest_mode(K, M, one_squared),
                     found = stiffest_mode(K, M, one_squared);
        expect(is_close(found, expected, 1e-5), "with any K and M, ", inside, " unknowns inside and ", boundary,
               " on the boundary, kappa is ", found, ", expected ", expected,
               ": the largest of all modes, of any size");
    }
}

}  // namespace
}  // namespace almesh::lessons
