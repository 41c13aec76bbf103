// The method of the paper in one file, to be read from top to bottom: triangles of degree 1 in the plane, nothing but
// the standard library. The numbers of equations, lines and sections are the paper's, read as src/README.md says.
//
//   g++ -std=c++20 -O2 src/lessons/almesh_in_one_file.cpp -o one-file
//   ./one-file MESH.msh [BOUNDARY translate DX DY | BOUNDARY rotate A ...]     A in degrees
//
// reads a mesh (MSH 2.2 or 4.1, text), moves the boundaries that are named and keeps the others, proves that no
// triangle is inverted and no two overlap, and writes outputs/lessons/one-file.vtk. Exit code 0: proved, 4: not proved,
// 2: the mesh is refused, or there is no result. The map phi takes the mesh that is read, y, to the moved one, x:
//
//     minimise  int (eta(D phi) - 1)^2 dy   subject to  phi = g_D on the boundary                             (Eq. 5)
//
// over the positions x of all nodes; here with eta^2 in place of (eta - 1)^2, as the paper's tables were made. The mesh
// file and the command line are read at the end, in part 10.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using Point = std::array<double, 2>;
using Matrix = std::array<Point, 2>;   // F[i][j]: row i, column j
using Vector = std::vector<double>;    // of the nodes: x_0, y_0, x_1, y_1, ...

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

// ---------------------------------------------------------------------------------------------------- 1 the mesh

struct Triangle {
    int id;                   // in the file
    std::array<int, 3> node;  // counter-clockwise
    double area = 0;          // |e|, of the ideal triangle
    Point grad[3] = {};       // of the hat functions N_i on it
};

struct Edge {
    int node[2];  // its triangle is to the left of the way from the first to the second
    std::size_t triangle;
    std::string boundary;  // its name
};

struct Mesh {
    Vector y;             // the nodes of the ideal mesh
    std::vector<int> id;  // of the nodes, in the file
    std::vector<Triangle> triangles;
    std::vector<Edge> edges;  // of the boundary
    int nodes() const { return static_cast<int>(id.size()); }
};

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

double determinant(const Matrix& A) { return A[0][0] * A[1][1] - A[0][1] * A[1][0]; }

Point at(const Vector& x, int i) { return {x[2 * i], x[2 * i + 1]}; }

// 1 if p, q, r are counter-clockwise, -1 if clockwise, 0 where rounding leaves that open. Differences and products in
// the determinant are rounded, each by a part 2^-53 at most: it is off by less than 8 such parts of the sum of its
// terms' magnitudes; twice that is asked for.
int turn(const Point& p, const Point& q, const Point& r) {
    const Matrix A = {{{q[0] - p[0], r[0] - p[0]}, {q[1] - p[1], r[1] - p[1]}}};
    const double most = 16 * std::exp2(-53) * (std::abs(A[0][0] * A[1][1]) + std::abs(A[0][1] * A[1][0]));
    return determinant(A) > most ? 1 : determinant(A) < -most ? -1 : 0;
}

std::string name(const Triangle& t) { return "triangle " + std::to_string(t.id); }

// grad N_1 and grad N_2 are the rows of A^{-1}; the three add up to zero.
void set_shape(Triangle& t, const Vector& y) {
    const Point p = at(y, t.node[0]), q = at(y, t.node[1]), r = at(y, t.node[2]);
    if (turn(p, q, r) == 0) fail(name(t) + " has no area");
    if (turn(p, q, r) < 0)
        fail(name(t) + " is clockwise: exchange two of its nodes in the file, or, if its neighbours are not, move the "
                       "node back that has been pushed through an edge of it");
    const Matrix A = {{{q[0] - p[0], r[0] - p[0]}, {q[1] - p[1], r[1] - p[1]}}};  // edges as columns
    const double det = determinant(A);
    t.area = det / 2;
    t.grad[1] = {A[1][1] / det, -A[0][1] / det};
    t.grad[2] = {-A[1][0] / det, A[0][0] / det};
    t.grad[0] = {-t.grad[1][0] - t.grad[2][0], -t.grad[1][1] - t.grad[2][1]};
}

using Pair = std::pair<int, int>;

// Two neighbours have their edge in opposite directions, as both have it on their left. An edge without an opposite is
// on the boundary, and has to be in a group, or nothing would hold it. group: by the ids of the nodes, the lower first.
void set_boundary(Mesh& mesh, const std::map<Pair, std::string>& group) {
    std::map<Pair, std::size_t> left;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const std::array<int, 3>& node = mesh.triangles[t].node;
            const auto [first, is_first] = left.insert({{node[k], node[(k + 1) % 3]}, t});
            if (!is_first)
                fail(name(mesh.triangles[t]) + " lies on the same side of an edge as " +
                     name(mesh.triangles[first->second]) + ": the mesh folds over itself there");
        }
    for (const auto& [edge, t] : left) {
        if (left.contains({edge.second, edge.first})) continue;
        const auto [a, b] = Pair(std::minmax(mesh.id[edge.first], mesh.id[edge.second]));
        if (!group.contains({a, b}))
            fail("the edge from node " + std::to_string(a) + " to node " + std::to_string(b) +
                 " is on the boundary and in no physical group, so nothing holds it: put it into one");
        mesh.edges.push_back({{edge.first, edge.second}, t, group.at({a, b})});
    }
}

// ---------------------------------------------------------------------------------------------- 2 the distortion

// F = D phi is constant on a triangle: sum_i x_i (grad N_i)^T.
Matrix jacobian(const Triangle& t, const Vector& x) {
    Matrix F{};
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) F[a][k] += x[2 * t.node[i] + a] * t.grad[i][k];
    return F;
}

// Eq. 1, n = 2, S = |F|^2, D = det F: eta = S / (2 D), infinite where the triangle is inverted. That is the barrier.
double eta(const Matrix& F) {
    const double S = F[0][0] * F[0][0] + F[0][1] * F[0][1] + F[1][0] * F[1][0] + F[1][1] * F[1][1];
    const double D = determinant(F);
    return D > 0 ? S / (2 * D) : INFINITY;
}

// C = dD/dF
Matrix cofactor(const Matrix& F) { return {{{F[1][1], -F[1][0]}, {-F[0][1], F[0][0]}}}; }

// d eta/dF = F / D - eta C / D
Matrix eta_F(const Matrix& F) {
    const Matrix C = cofactor(F);
    const double D = determinant(F), e = eta(F);
    Matrix result;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) result[i][j] = (F[i][j] - e * C[i][j]) / D;
    return result;
}

using Matrix4 = std::array<std::array<double, 4>, 4>;  // entry (2 i + j, 2 k + l): by F_ij and F_kl

// The second derivative of eta^2, 2 eta_F (x) eta_F + 2 eta eta_FF, with
//     eta_FF = (I - F (x) C / D - C (x) F / D + 2 eta C (x) C / D - eta dC/dF) / D.
Matrix4 second_derivative(const Matrix& F) {
    const Matrix C = cofactor(F), G = eta_F(F);
    const double D = determinant(F), e = eta(F);
    Matrix4 A;
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k)
                for (int l = 0; l < 2; ++l) {
                    const double same = i == k && j == l, dC = (k - i) * (l - j);
                    const double mixed = F[i][j] * C[k][l] + C[i][j] * F[k][l];
                    const double eta_FF = (same - mixed / D + 2 * e * C[i][j] * C[k][l] / D - e * dC) / D;
                    A[2 * i + j][2 * k + l] = 2 * G[i][j] * G[k][l] + 2 * e * eta_FF;
                }
    return A;
}

// Turns rows and columns p and q of A so that A_pq becomes 0, and the columns of V alike (Jacobi's rotation).
void rotate(Matrix4& A, Matrix4& V, int p, int q) {
    if (A[p][q] == 0) return;
    const double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1));
    const double c = 1 / std::hypot(t, 1), s = t * c;
    const auto mix = [c, s](double& a, double& b) {
        const double old = a;
        a = c * old - s * b;
        b = s * old + c * b;
    };
    for (int k = 0; k < 4; ++k) {
        mix(A[k][p], A[k][q]);
        mix(V[k][p], V[k][q]);
    }
    for (int k = 0; k < 4; ++k) mix(A[p][k], A[q][k]);
}

// The positive semidefinite part: the same eigenvectors, negative eigenvalues set to 0.
Matrix4 positive_part(Matrix4 A) {
    Matrix4 V{}, part{};
    for (int i = 0; i < 4; ++i) V[i][i] = 1;
    for (int sweep = 0; sweep < 12; ++sweep)
        for (int p = 0; p < 4; ++p)
            for (int q = p + 1; q < 4; ++q) rotate(A, V, p, q);
    for (int m = 0; m < 4; ++m)
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) part[i][j] += std::max(A[m][m], 0.0) * V[i][m] * V[j][m];
    return part;
}

// ---------------------------------------------------------------------------------------------- 3 the constraint

// c_D = (x - g) / |1| at the nodes of the boundary, measured in (u, v) = sum over edges of int u.v / h. An edge of any
// length adds (2 1; 1 2)/6 to the mass matrix M of this product, and 1 to |1|^2. M is zero at all other nodes, so what
// x - g is there does not count.
struct Constraint {
    std::vector<Edge> edges;
    Vector g;  // the targets
    double one() const { return std::sqrt(static_cast<double>(edges.size())); }

    Vector c(const Vector& x) const {
        Vector result(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) result[i] = (x[i] - g[i]) / one();
        return result;
    }
    // M u
    Vector mass_times(const Vector& u) const {
        Vector Mu(u.size(), 0.0);
        for (const Edge& e : edges)
            for (int a = 0; a < 2; ++a) {
                const int i = 2 * e.node[0] + a, j = 2 * e.node[1] + a;
                Mu[i] += (2 * u[i] + u[j]) / 6;
                Mu[j] += (u[i] + 2 * u[j]) / 6;
            }
        return Mu;
    }
    double product(const Vector& u, const Vector& v) const { return dot(u, mass_times(v)); }
};

// ------------------------------------------------------------------- 4 the augmented Lagrangian and its derivatives

// g_i += factor P grad N_i: a change dF of F changes a sum over triangles by P : dF
void add(const Triangle& t, const Matrix& P, double factor, Vector& g) {
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) g[2 * t.node[i] + a] += factor * P[a][k] * t.grad[i][k];
}

// Eq. 6 as it must be read: E(x) = int eta^2 - (lambda, c_D) + mu/2 |c_D|^2.
struct AugmentedLagrangian {
    const Mesh& mesh;
    const Constraint& constraint;
    Vector lambda;
    double mu = 0;

    double value(const Vector& x) const {
        double E = 0;
        for (const Triangle& t : mesh.triangles) {
            const double e = eta(jacobian(t, x));
            E += t.area * e * e;
        }
        const Vector c = constraint.c(x);
        return E - constraint.product(lambda, c) + mu / 2 * constraint.product(c, c);
    }

    // of a triangle: |e| 2 eta eta_F grad N_i; of the boundary: M (mu c - lambda) / |1|
    Vector gradient(const Vector& x) const {
        Vector u = constraint.c(x);
        for (std::size_t i = 0; i < u.size(); ++i) u[i] = (mu * u[i] - lambda[i]) / constraint.one();
        Vector g = constraint.mass_times(u);
        for (const Triangle& t : mesh.triangles) {
            const Matrix F = jacobian(t, x);
            add(t, eta_F(F), 2 * t.area * eta(F), g);
        }
        return g;
    }

    // of a triangle: the second derivative by F, as it is or projected
    std::vector<Matrix4> hessian(const Vector& x, bool projected) const {
        std::vector<Matrix4> A;
        for (const Triangle& t : mesh.triangles) A.push_back(second_derivative(jacobian(t, x)));
        if (projected) std::transform(A.begin(), A.end(), A.begin(), positive_part);
        return A;
    }

    // H v, of a triangle: |e| (A dF) grad N_i, dF that of v; of the boundary: mu M v / |1|^2
    Vector hessian_times(const std::vector<Matrix4>& A, const Vector& v) const {
        Vector Hv = constraint.mass_times(v);
        for (double& entry : Hv) entry *= mu / (constraint.one() * constraint.one());
        for (std::size_t e = 0; e < A.size(); ++e) {
            const Matrix dF = jacobian(mesh.triangles[e], v);
            Matrix P{};
            for (int r = 0; r < 4; ++r)
                for (int s = 0; s < 4; ++s) P[r / 2][r % 2] += A[e][r][s] * dF[s / 2][s % 2];
            add(mesh.triangles[e], P, mesh.triangles[e].area, Hv);
        }
        return Hv;
    }
};

// -------------------------------------------------------------------------------------------- 5 linear systems

// Conjugate gradients for H d = b. False where a direction p with p.Hp <= 0 turns up, so that H is not positive
// definite: then the direction of Newton's method need not be one of descent.
bool solve(const AugmentedLagrangian& L, const std::vector<Matrix4>& A, const Vector& b, Vector& d) {
    d.assign(b.size(), 0.0);
    Vector r = b, p = b;
    double r_squared = dot(r, r);
    for (std::size_t k = 0; k < 20 * b.size() && r_squared > 1e-24 * dot(b, b); ++k) {
        const Vector Hp = L.hessian_times(A, p);
        const double curvature = dot(p, Hp), t = r_squared / curvature, before = r_squared;
        if (!(curvature > 0)) return false;
        for (std::size_t i = 0; i < b.size(); ++i) {
            d[i] += t * p[i];
            r[i] -= t * Hp[i];
        }
        r_squared = dot(r, r);
        for (std::size_t i = 0; i < b.size(); ++i) p[i] = r[i] + r_squared / before * p[i];
    }
    return true;
}

// ------------------------------------------------------------------------------------------- 6 Newton's method

// x <- x - t d with H d = g and the first t of 1, 1/2, 1/4, ... that satisfies Armijo's condition, the first of
// Wolfe's, up to the rounding of the sums: where a triangle is inverted the energy is infinite, and t is refused. H is
// the full Hessian; where that is not positive definite, or leads nowhere, its projection, triangle by triangle.
bool newton_step(const AugmentedLagrangian& L, const Vector& g, Vector& x) {
    const double E = L.value(x);
    for (const bool projected : {false, true}) {
        Vector d, trial(x.size());
        if (!solve(L, L.hessian(x, projected), g, d)) continue;
        const double slope = -dot(g, d);
        for (double t = 1; slope < 0 && t > 1e-14; t /= 2) {
            for (std::size_t i = 0; i < x.size(); ++i) trial[i] = x[i] - t * d[i];
            if (!(L.value(trial) <= E + 1e-4 * t * slope + 1e-14 * std::abs(E))) continue;
            x = trial;
            return true;
        }
    }
    return false;
}

// Until |grad E| <= omega; the number of steps. gradient_norm: at the end.
int minimise(const AugmentedLagrangian& L, double omega, Vector& x, double& gradient_norm) {
    for (int steps = 0;; ++steps) {
        const Vector g = L.gradient(x);
        gradient_norm = std::sqrt(dot(g, g));
        if (gradient_norm <= omega) return steps;
        if (steps == 200 || !newton_step(L, g, x)) fail("Newton's method finds no step that lowers the energy");
    }
}

// ---------------------------------------------------------------------------------------------- 7 Algorithm 1

// With the quality q = |1| / |eta| in L2 of the ideal mesh.
void print_row(const Mesh& mesh, const Vector& x, int k, double c, double g, double mu, const char* update, int steps) {
    double area = 0, squared = 0, largest = 0;
    for (const Triangle& t : mesh.triangles) {
        const double e = eta(jacobian(t, x));
        area += t.area;
        squared += t.area * e * e;
        largest = std::max(largest, e);
    }
    std::printf("%3d  %9.3e  %9.2e  %.10f  %.8f  %8.2e  %-6s  %6d\n", k, c, g, std::sqrt(area / squared), largest, mu,
                update, steps);
}

Vector algorithm_1(const Mesh& mesh, const Constraint& constraint) {
    // of inputs/circle.deck, mu0 in units of |1|^2
    const double mu0 = 24 * constraint.one() * constraint.one(), omega0 = 0.1, epsilon0 = 1e-4;
    const double omega_star = 1e-6, epsilon_star = 1e-14, m0 = 10;
    Vector x = mesh.y;                                                          // 1-2: phi is the identity
    AugmentedLagrangian L{mesh, constraint, Vector(x.size(), 0.0)};             // 3: lambda = 0
    double m = m0, omega = omega0, epsilon = epsilon0;                          // 4-6
    L.mu = mu0;
    std::printf(" AL      |c_D|   |grad E|             q     max eta        mu  update  Newton\n");
    for (int k = 1; k <= 50; ++k) {                                             // 7
        double gradient_norm = 0;
        const double mu = L.mu;
        const int steps = minimise(L, std::max(omega, omega_star), x, gradient_norm);  // 8
        const Vector c = constraint.c(x);
        const double c_squared = constraint.product(c, c);
        const bool updates = c_squared <= epsilon;                              // 9
        if (updates) {
            for (std::size_t i = 0; i < c.size(); ++i) L.lambda[i] -= L.mu * c[i];   // 10
            epsilon /= std::pow(m, 0.9);                                        // 13
            omega /= m;                                                         // 14
        } else {                                                                // 15-16
            m *= 100;                                                           // 17
            L.mu = mu0 * (m / m0);                                              // 18
            epsilon = epsilon0 / std::pow(m / m0, 0.1);                         // 19
            omega = omega0 / (m / m0);                                          // 20
        }                                                                       // 21
        print_row(mesh, x, k, std::sqrt(c_squared), gradient_norm, mu, updates ? "lambda" : "mu", steps);
        if (c_squared <= epsilon_star && gradient_norm <= omega_star) return x;
    }                                                                           // 22
    fail("the constraint does not hold after 50 iterations");
}

// -------------------------------------------------------------------------------------------- 8 the certificate

// Whether a triangle and the edge from a to b of the boundary, which is another one's, are proved to have no more in
// common than a corner, or a side of both from either side: a side of the triangle, or the edge, parts them.
bool apart(const std::array<Point, 3>& corner, const Point& a, const Point& b) {
    bool all_left = true, all_right = true;
    for (int k = 0; k < 3; ++k) {
        const Point &p = corner[k], &q = corner[(k + 1) % 3];
        if (p == a && q == b) return false;
        const auto outside = [&](const Point& c) { return c == p || c == q || turn(p, q, c) < 0; };
        if (outside(a) && outside(b)) return true;
        all_left = all_left && (p == a || p == b || turn(a, b, p) > 0);
        all_right = all_right && (p == a || p == b || turn(a, b, p) < 0);
    }
    return all_left || all_right;
}

// Whether it is proved that no triangle is inverted and no two overlap. The first alone is not enough: a strip can
// cover a ring twice. Where no triangle is inverted, the number of them over a point changes across edges of the
// boundary only; where it is 2 or more, such an edge ends it, and another triangle than its own lies over the edge.
bool certified(const Mesh& mesh, const Vector& x) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [i, j, k] = mesh.triangles[t].node;
        const std::array<Point, 3> corner = {at(x, i), at(x, j), at(x, k)};
        if (turn(corner[0], corner[1], corner[2]) <= 0) return false;
        for (const Edge& e : mesh.edges)
            if (e.triangle != t && !apart(corner, at(x, e.node[0]), at(x, e.node[1]))) return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------------- 9 results

void write_vtk(const std::string& path, const Mesh& mesh, const Vector& x) {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream out(path);
    out.precision(17);
    out << "# vtk DataFile Version 3.0\nalmesh in one file\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    out << "POINTS " << mesh.nodes() << " double\n";
    for (int i = 0; i < mesh.nodes(); ++i) out << x[2 * i] << ' ' << x[2 * i + 1] << " 0\n";
    const std::size_t count = mesh.triangles.size();
    out << "CELLS " << count << ' ' << 4 * count << '\n';
    for (const Triangle& t : mesh.triangles) out << "3 " << t.node[0] << ' ' << t.node[1] << ' ' << t.node[2] << '\n';
    out << "CELL_TYPES " << count << '\n';
    for (std::size_t e = 0; e < count; ++e) out << "5\n";
    if (!out.flush()) fail("cannot write " + path);
}

// ------------------------------------------------------------------------- 10 the mesh file and the command line

// Version 2.2 has one list of nodes and one of elements, with their groups; 4.1 has them in blocks, one for each entity
// (a point, curve or surface of the drawing), and the groups are the entities'.
struct MeshFile {
    std::ifstream in;
    bool has_blocks = false;
    std::map<int, std::string> names;   // of the physical groups of edges
    std::map<Pair, int> physical;       // of dimension and tag of an entity: its group, 0 for none
    std::map<int, Point> point;         // of a node's id
    std::map<int, int> number;          // of the id of a node that a triangle has: its place in the mesh
    std::map<Pair, std::string> group;  // of an edge, by the ids of its nodes
    Mesh mesh;

    template <class Number = int>
    Number next() {
        Number value{};
        if (!(in >> value)) fail("the mesh file ends, or has no number, where one is due");
        return value;
    }
    void skip(int numbers) { while (numbers-- > 0) next<double>(); }
    void read_format() {
        const std::string version = next<std::string>();
        has_blocks = version == "4.1";
        if ((version != "2.2" && !has_blocks) || next() != 0)
            fail("MSH 2.2 and 4.1 as text are read, not version " + version + " or binary: gmsh -0 MESH -format msh41");
    }
    void read_names() {
        for (int left = next(); left > 0; --left) {
            const int dimension = next(), tag = next();
            std::string name;
            in >> std::quoted(name);
            if (dimension == 1) names[tag] = name;
        }
    }
    void read_entities() {
        int count[4];
        for (int& of_dimension : count) of_dimension = next();
        for (int dimension = 0; dimension < 4; ++dimension)
            for (int left = count[dimension]; left > 0; --left) {
                const int tag = next();
                skip(dimension == 0 ? 3 : 6);  // where it is
                const int groups = next();
                physical[{dimension, tag}] = groups > 0 ? next() : 0;
                skip(groups - 1);
                if (dimension > 0) skip(next());  // what bounds it
            }
    }
    // The number of blocks; a list without blocks is one.
    int blocks() {
        const int count = has_blocks ? next() : 1;
        skip(has_blocks ? 3 : 0);
        return count;
    }
    void read_nodes() {
        for (int left = blocks(); left > 0; --left) {
            skip(has_blocks ? 3 : 0);
            std::vector<int> ids(next());
            for (int& id : ids)
                if (has_blocks) id = next();
            for (int& id : ids) {
                if (!has_blocks) id = next();
                const double a = next<double>(), b = next<double>();
                if (!point.insert({id, {a, b}}).second) fail("node " + std::to_string(id) + " is there twice");
                skip(1);  // z
            }
        }
    }
    void read_elements() {
        for (int left = blocks(); left > 0; --left) {
            const int dimension = has_blocks ? next() : 0, entity = has_blocks ? next() : 0;
            int type = has_blocks ? next() : 0;
            for (int count = next(); count > 0; --count) {
                const int id = next();
                int tag = has_blocks ? physical[{dimension, entity}] : 0;
                if (!has_blocks) {
                    type = next();
                    const int tags = next();
                    if (tags > 0) tag = next();
                    skip(tags - 1);
                }
                add_element(id, type, tag);
            }
        }
    }
    // Types 1 and 2 are edges and triangles of degree 1, 15 is a point.
    void add_element(int id, int type, int tag) {
        if (type != 1 && type != 2 && type != 15)
            fail("element " + std::to_string(id) + " is none of degree 1 in the plane: type " + std::to_string(type));
        int node[3] = {};
        for (int k = 0; k < (type == 15 ? 1 : type + 1); ++k)
            if (!point.contains(node[k] = next())) fail("there is no node " + std::to_string(node[k]));
        if (type == 1 && tag != 0)
            group.insert({std::minmax(node[0], node[1]), names.contains(tag) ? names[tag] : std::to_string(tag)});
        if (type != 2) return;
        for (int& k : node) {
            const auto [place, is_first] = number.insert({k, mesh.nodes()});
            if (is_first) {
                mesh.id.push_back(k);
                mesh.y.insert(mesh.y.end(), point[k].begin(), point[k].end());
            }
            k = place->second;
        }
        mesh.triangles.push_back({.id = id, .node = {node[0], node[1], node[2]}});
    }
};

Mesh read_mesh(const std::string& path) {
    MeshFile file;
    file.in.open(path);
    std::string word;
    if (!(file.in >> word) || word != "$MeshFormat") fail(path + " is no file, or does not begin with $MeshFormat");
    for (file.read_format(); file.in >> word;) {
        if (word == "$PhysicalNames") file.read_names();
        if (word == "$Entities") file.read_entities();
        if (word == "$Nodes") file.read_nodes();
        if (word == "$Elements") file.read_elements();
    }
    if (file.mesh.triangles.empty()) fail(path + " has no triangles");
    for (Triangle& t : file.mesh.triangles) set_shape(t, file.mesh.y);
    set_boundary(file.mesh, file.group);
    return file.mesh;
}

// The targets: a boundary is turned about the origin, or translated.
Constraint make_constraint(const Mesh& mesh, const std::vector<std::string>& words) {
    Constraint constraint{mesh.edges, mesh.y};
    for (std::size_t i = 0; i < words.size();) {
        const bool turns = i + 2 < words.size() && words[i + 1] == "rotate";
        if (!turns && !(i + 3 < words.size() && words[i + 1] == "translate"))
            fail(words[i] + ": translate DX DY or rotate A is due");
        const double angle = turns ? std::stod(words[i + 2]) * std::numbers::pi / 180 : 0;
        const double dx = turns ? 0 : std::stod(words[i + 2]), dy = turns ? 0 : std::stod(words[i + 3]);
        bool is_there = false;
        for (const Edge& edge : mesh.edges)
            for (const int node : edge.node) {
                if (edge.boundary != words[i]) continue;
                const auto [a, b] = at(mesh.y, node);
                constraint.g[2 * node] = std::cos(angle) * a - std::sin(angle) * b + dx;
                constraint.g[2 * node + 1] = std::sin(angle) * a + std::cos(angle) * b + dy;
                is_there = true;
            }
        if (!is_there) fail("the mesh has no boundary " + words[i]);
        i += turns ? 3 : 4;
    }
    return constraint;
}

int main(int count, char** argument) {
    try {
        if (count < 2) fail("usage: one-file MESH.msh [BOUNDARY translate DX DY | BOUNDARY rotate A ...]");
        const Mesh mesh = read_mesh(argument[1]);
        const Vector x = algorithm_1(mesh, make_constraint(mesh, {argument + 2, argument + count}));
        write_vtk("outputs/lessons/one-file.vtk", mesh, x);
        const bool valid = certified(mesh, x);
        std::puts(valid ? "certified: every triangle is valid, no two overlap"
                        : "NOT certified: a triangle may be inverted, or two may overlap");
        return valid ? 0 : 4;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
