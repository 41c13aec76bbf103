// The method of the paper in one file, to be read from top to bottom: triangles of degree 1 in the plane, nothing but
// the standard library. The numbers of equations, lines and sections are the paper's, read as src/README.md says.
//
//   almesh_in_one_file MESH.msh [BOUNDARY translate DX DY | BOUNDARY rotate A ...]     A in degrees
//
// reads a mesh (MSH 2.2, text), moves the boundaries that are named and keeps the others, proves that no triangle is
// inverted, and writes outputs/lessons/one-file.vtk. The map phi takes the mesh that is read, y, to the moved one, x:
//
//     minimise  int eta(D phi)^2 dy   subject to  phi = g_D on the boundary                                   (Eq. 5)
//
// over the positions x of all nodes. Parts: 1 the mesh, 2 the distortion, 3 the constraint, 4 the augmented Lagrangian
// and its derivatives, 5 linear systems, 6 Newton's method, 7 Algorithm 1, 8 the certificate, 9 results.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using Point = std::array<double, 2>;
using Matrix = std::array<Point, 2>;   // F[i][j]: row i, column j
using Vector = std::vector<double>;    // of the nodes: x_0, y_0, x_1, y_1, ...

constexpr double infinity = std::numeric_limits<double>::infinity();

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

// ---------------------------------------------------------------------------------------------------- 1 the mesh

struct Triangle {
    std::array<int, 3> node;  // counter-clockwise
    double area = 0;          // |e|, of the ideal triangle
    Point grad[3] = {};       // of the hat functions N_i on it
};

struct Edge {
    int node[2];
    std::string boundary;  // its name
};

struct Mesh {
    Vector y;  // the nodes of the ideal mesh
    std::vector<Triangle> triangles;
    std::vector<Edge> edges;  // of the boundary
    int nodes() const { return static_cast<int>(y.size() / 2); }
};

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

double determinant(const Matrix& A) { return A[0][0] * A[1][1] - A[0][1] * A[1][0]; }

// The edges from the first vertex as columns.
Matrix edge_matrix(const Triangle& t, const Vector& x) {
    Matrix A;
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) A[i][k] = x[2 * t.node[k + 1] + i] - x[2 * t.node[0] + i];
    return A;
}

// grad N_1 and grad N_2 are the rows of A^{-1}; the three add up to zero.
void set_shape(Triangle& t, const Vector& y) {
    Matrix A = edge_matrix(t, y);
    if (determinant(A) < 0) {
        std::swap(t.node[1], t.node[2]);
        A = edge_matrix(t, y);
    }
    const double det = determinant(A);
    if (!(det > 0)) fail("a triangle of the mesh has no area");
    t.area = det / 2;
    t.grad[1] = {A[1][1] / det, -A[0][1] / det};
    t.grad[2] = {-A[1][0] / det, A[0][0] / det};
    t.grad[0] = {-t.grad[1][0] - t.grad[2][0], -t.grad[1][1] - t.grad[2][1]};
}

template <class Number>
Number next(std::istream& in) {
    Number value{};
    if (!(in >> value)) fail("the mesh file ends, or has no number, where one is due");
    return value;
}

void read_names(std::istream& in, std::map<int, std::string>& names) {
    for (int left = next<int>(in); left > 0; --left) {
        const int dimension = next<int>(in), tag = next<int>(in);
        const std::string name = next<std::string>(in);  // in quotation marks
        if (dimension == 1 && name.size() > 2) names[tag] = name.substr(1, name.size() - 2);
    }
}

void read_nodes(std::istream& in, Mesh& mesh, std::map<int, int>& number) {
    const int count = next<int>(in);
    for (int i = 0; i < count; ++i) {
        number[next<int>(in)] = i;
        for (int a = 0; a < 2; ++a) mesh.y.push_back(next<double>(in));
        next<double>(in);  // z
    }
}

// Types 1 and 2 are edges and triangles of degree 1; of their tags the first is the physical group.
void read_elements(std::istream& in, Mesh& mesh, std::map<int, int>& number, std::map<int, std::string>& names) {
    for (int left = next<int>(in); left > 0; --left) {
        next<int>(in);
        const int type = next<int>(in), tags = next<int>(in), group = next<int>(in);
        for (int t = 1; t < tags; ++t) next<int>(in);
        const auto node = [&] { return number.at(next<int>(in)); };
        if (type == 1) {
            const int a = node(), b = node();
            mesh.edges.push_back({{a, b}, names.contains(group) ? names[group] : std::to_string(group)});
        } else if (type == 2) {
            const int a = node(), b = node(), c = node();
            mesh.triangles.push_back({.node = {a, b, c}});
        } else {
            fail("the mesh has elements of type " + std::to_string(type) + ", not triangles of degree 1 alone");
        }
    }
}

Mesh read_mesh(const std::string& path) {
    std::ifstream in(path);
    if (!in) fail("cannot read " + path);
    Mesh mesh;
    std::map<int, int> number;          // of a node in the file: its place here
    std::map<int, std::string> names;   // of the physical groups of edges
    for (std::string word; in >> word;) {
        if (word == "$PhysicalNames") read_names(in, names);
        if (word == "$Nodes") read_nodes(in, mesh, number);
        if (word == "$Elements") read_elements(in, mesh, number, names);
    }
    if (mesh.triangles.empty() || mesh.edges.empty()) fail(path + " has no triangles or no edges of a boundary");
    for (Triangle& t : mesh.triangles) set_shape(t, mesh.y);
    return mesh;
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
    return D > 0 ? S / (2 * D) : infinity;
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
    for (int k = 0; k < 4; ++k) {
        const double Akp = A[k][p], Vkp = V[k][p];
        A[k][p] = c * Akp - s * A[k][q];
        A[k][q] = s * Akp + c * A[k][q];
        V[k][p] = c * Vkp - s * V[k][q];
        V[k][q] = s * Vkp + c * V[k][q];
    }
    for (int k = 0; k < 4; ++k) {
        const double Apk = A[p][k];
        A[p][k] = c * Apk - s * A[q][k];
        A[q][k] = s * Apk + c * A[q][k];
    }
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
// length adds (2 1; 1 2)/6 to the mass matrix M of this product, and 1 to |1|^2.
struct Constraint {
    std::vector<Edge> edges;
    Vector g;              // targets; only those of boundary nodes are used
    std::vector<int> on;   // the boundary nodes
    double one() const { return std::sqrt(static_cast<double>(edges.size())); }

    Vector c(const Vector& x) const {
        Vector result(x.size(), 0.0);
        for (const int i : on)
            for (int a = 0; a < 2; ++a) result[2 * i + a] = (x[2 * i + a] - g[2 * i + a]) / one();
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

struct Motion {
    bool turns;
    double angle, dx, dy;
};

Point moved(const Motion& m, Point p) {
    if (!m.turns) return {p[0] + m.dx, p[1] + m.dy};
    return {std::cos(m.angle) * p[0] - std::sin(m.angle) * p[1], std::sin(m.angle) * p[0] + std::cos(m.angle) * p[1]};
}

Constraint make_constraint(const Mesh& mesh, const std::map<std::string, Motion>& motions) {
    Constraint constraint{mesh.edges, mesh.y, {}};
    std::set<int> on;
    for (const Edge& edge : mesh.edges)
        for (const int i : edge.node) {
            on.insert(i);
            const auto motion = motions.find(edge.boundary);
            if (motion == motions.end()) continue;
            const Point p = moved(motion->second, {mesh.y[2 * i], mesh.y[2 * i + 1]});
            for (int a = 0; a < 2; ++a) constraint.g[2 * i + a] = p[a];
        }
    constraint.on.assign(on.begin(), on.end());
    return constraint;
}

// ------------------------------------------------------------------- 4 the augmented Lagrangian and its derivatives

// A symmetric matrix, of row i the entries from the first that is not zero up to the diagonal. Cholesky's factor has
// the same shape.
struct Envelope {
    std::vector<int> place;   // of an unknown: its row
    std::vector<int> first;   // column of a row
    std::vector<Vector> row;
    double& at(int i, int j) { return i >= j ? row[i][j - first[i]] : row[j][i - first[j]]; }
};

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
            const Matrix F = jacobian(t, x), G = eta_F(F);
            const double factor = 2 * t.area * eta(F);
            for (int i = 0; i < 3; ++i)
                for (int a = 0; a < 2; ++a)
                    for (int k = 0; k < 2; ++k) g[2 * t.node[i] + a] += factor * G[a][k] * t.grad[i][k];
        }
        return g;
    }

    void hessian(const Vector& x, bool projected, Envelope& H) const {
        for (Vector& row : H.row) std::fill(row.begin(), row.end(), 0.0);
        for (const Triangle& t : mesh.triangles) {
            Matrix4 A = second_derivative(jacobian(t, x));
            if (projected) A = positive_part(A);
            for (int r = 0; r < 6; ++r)
                for (int s = 0; s < 6; ++s) {
                    const int i = r / 2, a = r % 2, j = s / 2, b = s % 2;
                    const int row = H.place[2 * t.node[i] + a], column = H.place[2 * t.node[j] + b];
                    if (row < column) continue;
                    for (int k = 0; k < 2; ++k)
                        for (int l = 0; l < 2; ++l)
                            H.at(row, column) += t.area * t.grad[i][k] * A[2 * a + k][2 * b + l] * t.grad[j][l];
                }
        }
        const double factor = mu / (constraint.one() * constraint.one());
        for (const Edge& e : constraint.edges)  // mu M / |1|^2
            for (int a = 0; a < 2; ++a) {
                const int i = H.place[2 * e.node[0] + a], j = H.place[2 * e.node[1] + a];
                H.at(i, i) += factor * 2 / 6;
                H.at(j, j) += factor * 2 / 6;
                H.at(i, j) += factor / 6;
            }
    }
};

// -------------------------------------------------------------------------------------------- 5 linear systems

// Nodes in the order of Cuthill and McKee, reversed: breadth first from a node of the boundary, neighbours with few
// neighbours first. It keeps the first entry of a row near the diagonal.
std::vector<int> narrow_order(const Mesh& mesh) {
    std::vector<std::set<int>> neighbours(mesh.nodes());
    for (const Triangle& t : mesh.triangles)
        for (const int i : t.node) neighbours[i].insert(t.node.begin(), t.node.end());
    std::vector<int> order;
    std::vector<char> seen(mesh.nodes(), 0);
    const auto visit = [&](int i) {
        if (!seen[i]) order.push_back(i);
        seen[i] = 1;
    };
    for (int start = -1, done = 0; start < mesh.nodes(); ++start) {  // -1: the boundary; more: where parts are apart
        visit(start < 0 ? mesh.edges[0].node[0] : start);
        for (; done < static_cast<int>(order.size()); ++done) {
            std::vector<int> near(neighbours[order[done]].begin(), neighbours[order[done]].end());
            std::stable_sort(near.begin(), near.end(),
                             [&](int a, int b) { return neighbours[a].size() < neighbours[b].size(); });
            for (const int i : near) visit(i);
        }
    }
    std::reverse(order.begin(), order.end());
    return order;
}

Envelope make_envelope(const Mesh& mesh) {
    Envelope H;
    H.place.resize(mesh.y.size());
    const std::vector<int> order = narrow_order(mesh);
    for (int k = 0; k < mesh.nodes(); ++k)
        for (int a = 0; a < 2; ++a) H.place[2 * order[k] + a] = 2 * k + a;
    H.first.resize(mesh.y.size());
    for (std::size_t i = 0; i < H.first.size(); ++i) H.first[i] = static_cast<int>(i);
    for (const Triangle& t : mesh.triangles)
        for (const int i : t.node)
            for (const int j : t.node)
                for (int a = 0; a < 2; ++a) {
                    int& first = H.first[H.place[2 * i + a]];
                    first = std::min(first, H.place[2 * j]);
                }
    for (std::size_t i = 0; i < H.first.size(); ++i) H.row.emplace_back(i + 1 - H.first[i]);
    return H;
}

// H = L L^T, L in place of H, row by row: L_ij = (H_ij - sum_k<j L_ik L_jk) / L_jj. False where H is not positive
// definite: then the direction of Newton's method need not be one of descent.
bool factor(Envelope& H) {
    const int n = static_cast<int>(H.row.size());
    for (int i = 0; i < n; ++i)
        for (int j = H.first[i]; j <= i; ++j) {
            double sum = H.at(i, j);
            for (int k = std::max(H.first[i], H.first[j]); k < j; ++k) sum -= H.at(i, k) * H.at(j, k);
            if (i == j && !(sum > 0)) return false;
            H.at(i, j) = i == j ? std::sqrt(sum) : sum / H.at(j, j);
        }
    return true;
}

// x with L L^T x = b: L z = b from the first row to the last, L^T x = z back.
Vector solve(Envelope& L, const Vector& b) {
    const int n = static_cast<int>(L.row.size());
    Vector z(n), x(n);
    for (int i = 0; i < n; ++i) z[L.place[i]] = b[i];
    for (int i = 0; i < n; ++i) {
        for (int k = L.first[i]; k < i; ++k) z[i] -= L.at(i, k) * z[k];
        z[i] /= L.at(i, i);
    }
    for (int i = n - 1; i >= 0; --i) {
        z[i] /= L.at(i, i);
        for (int k = L.first[i]; k < i; ++k) z[k] -= L.at(i, k) * z[i];
    }
    for (int i = 0; i < n; ++i) x[i] = z[L.place[i]];
    return x;
}

// ------------------------------------------------------------------------------------------- 6 Newton's method

// Whether a triangle keeps its orientation all the way from x to x + d. Its determinant is a quadratic of the part t of
// the way, with the Bezier coefficients b_0, b_1, b_2 (b_1 from the product rule); q(t) > 0 on [0, 1] exactly if the
// ends are positive and b_1 > -sqrt(b_0 b_2).
bool valid_on_the_way(const Triangle& t, const Vector& x, const Vector& end) {
    const Matrix A = edge_matrix(t, x), B = edge_matrix(t, end);
    const double b_0 = determinant(A), b_2 = determinant(B);
    const double b_1 = (A[0][0] * B[1][1] + B[0][0] * A[1][1] - A[0][1] * B[1][0] - B[0][1] * A[1][0]) / 2;
    return b_0 > 0 && b_2 > 0 && (b_1 > 0 || b_1 * b_1 < b_0 * b_2);
}

// x <- x + t d with the first t of 1, 1/2, 1/4, ... that inverts no triangle on the way and satisfies Armijo's
// condition, the first of Wolfe's, up to the rounding of the sums. False where there is none.
bool line_search(const AugmentedLagrangian& L, const Vector& d, double slope, double E, Vector& x) {
    for (double t = 1; t > 1e-14; t /= 2) {
        Vector trial = x;
        for (std::size_t i = 0; i < x.size(); ++i) trial[i] += t * d[i];
        const bool lower = L.value(trial) <= E + 1e-4 * t * slope + 1e-14 * std::abs(E);
        const auto valid = [&](const Triangle& e) { return valid_on_the_way(e, x, trial); };
        if (!lower || !std::all_of(L.mesh.triangles.begin(), L.mesh.triangles.end(), valid)) continue;
        x = std::move(trial);
        return true;
    }
    return false;
}

// The direction H d = -g with the full Hessian; where that is not positive definite, or leads nowhere, with its
// projection, triangle by triangle, onto the positive semidefinite matrices.
bool newton_step(const AugmentedLagrangian& L, const Vector& g, Envelope& H, Vector& x) {
    const double E = L.value(x);
    for (const bool projected : {false, true}) {
        L.hessian(x, projected, H);
        if (!factor(H)) continue;
        Vector d = solve(H, g);
        for (double& entry : d) entry = -entry;
        const double slope = dot(g, d);
        if (slope < 0 && line_search(L, d, slope, E, x)) return true;
    }
    return false;
}

// Until |grad E| <= omega; the number of steps. gradient_norm: at the end.
int minimise(const AugmentedLagrangian& L, double omega, Envelope& H, Vector& x, double& gradient_norm) {
    for (int steps = 0;; ++steps) {
        const Vector g = L.gradient(x);
        gradient_norm = std::sqrt(dot(g, g));
        if (gradient_norm <= omega) return steps;
        if (steps == 200 || !newton_step(L, g, H, x)) fail("Newton's method finds no step that lowers the energy");
    }
}

// ---------------------------------------------------------------------------------------------- 7 Algorithm 1

struct Settings {  // of inputs/circle.deck; mu0 in units of |1|^2
    double mu0 = 24, omega0 = 0.1, epsilon0 = 1e-4, omega_star = 1e-6, epsilon_star = 1e-14;
};

// With the quality q = |1| / |eta| in L2 of the ideal mesh.
void print_row(const Mesh& mesh, const Vector& x, int k, double c, double g, double mu, const char* update, int steps) {
    double area = 0, squared = 0, largest = 0;
    for (const Triangle& t : mesh.triangles) {
        const double e = eta(jacobian(t, x));
        area += t.area;
        squared += t.area * e * e;
        largest = std::max(largest, e);
    }
    const double q = std::sqrt(area / squared);
    std::printf("%3d  %9.3e  %9.2e  %.10f  %.8f  %8.2e  %-6s  %6d\n", k, c, g, q, largest, mu, update, steps);
}

Vector algorithm_1(const Mesh& mesh, const Constraint& constraint, const Settings& s) {
    Vector x = mesh.y;                                                          // 1-2: phi is the identity
    AugmentedLagrangian L{mesh, constraint, Vector(x.size(), 0.0)};             // 3: lambda = 0
    Envelope H = make_envelope(mesh);
    constexpr double m0 = 10;
    const double mu0 = s.mu0 * constraint.one() * constraint.one();
    double m = m0, omega = s.omega0, epsilon = s.epsilon0;                      // 4-6
    L.mu = mu0;
    std::printf(" AL      |c_D|   |grad E|             q     max eta        mu  update  Newton\n");
    for (int k = 1; k <= 50; ++k) {                                             // 7
        double gradient_norm = 0;
        const double mu = L.mu;
        const int steps = minimise(L, std::max(omega, s.omega_star), H, x, gradient_norm);  // 8
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
            epsilon = s.epsilon0 / std::pow(m / m0, 0.1);                       // 19
            omega = s.omega0 / (m / m0);                                        // 20
        }                                                                       // 21
        const bool ends = c_squared <= s.epsilon_star && gradient_norm <= s.omega_star;
        print_row(mesh, x, k, std::sqrt(c_squared), gradient_norm, mu, updates ? "lambda" : "mu", steps);
        if (ends) return x;
    }                                                                           // 22
    fail("the constraint does not hold after 50 iterations");
}

// -------------------------------------------------------------------------------------------- 8 the certificate

// Whether det > 0 is proved for every triangle. Differences and products in a determinant are rounded, each by a part
// 2^-53 at most: it is off by less than 8 such parts of the sum of its terms' magnitudes; twice that is asked for.
bool certified(const Mesh& mesh, const Vector& x) {
    for (const Triangle& t : mesh.triangles) {
        const Matrix A = edge_matrix(t, x);
        const double terms = std::abs(A[0][0] * A[1][1]) + std::abs(A[0][1] * A[1][0]);
        if (!(determinant(A) > 16 * std::exp2(-53) * terms)) return false;
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
    out << "CELL_DATA " << count << "\nSCALARS eta double 1\nLOOKUP_TABLE default\n";
    for (const Triangle& t : mesh.triangles) out << eta(jacobian(t, x)) << '\n';
    if (!out.flush()) fail("cannot write " + path);
}

std::map<std::string, Motion> motions_of(const std::vector<std::string>& words, const Mesh& mesh) {
    std::map<std::string, Motion> motions;
    for (std::size_t i = 0; i < words.size();) {
        const std::string name = words[i], kind = i + 1 < words.size() ? words[i + 1] : "";
        const auto is_it = [&](const Edge& edge) { return edge.boundary == name; };
        if (std::none_of(mesh.edges.begin(), mesh.edges.end(), is_it)) fail("the mesh has no boundary " + name);
        const std::size_t numbers = kind == "translate" ? 2 : kind == "rotate" ? 1 : 0;
        if (numbers == 0 || i + 2 + numbers > words.size()) fail(name + ": translate DX DY or rotate A is due");
        const double a = std::stod(words[i + 2]), b = numbers == 2 ? std::stod(words[i + 3]) : 0;
        motions[name] = {kind == "rotate", a * std::numbers::pi / 180, a, b};
        i += 2 + numbers;
    }
    return motions;
}

int run(const std::vector<std::string>& words) {
    const Mesh mesh = read_mesh(words[0]);
    const Constraint constraint = make_constraint(mesh, motions_of({words.begin() + 1, words.end()}, mesh));
    const Vector x = algorithm_1(mesh, constraint, Settings());
    const bool valid = certified(mesh, x);
    std::printf(valid ? "certified: every triangle is valid\n" : "NOT certified: a triangle may be inverted\n");
    write_vtk("outputs/lessons/one-file.vtk", mesh, x);
    return valid ? 0 : 4;
}

int main(int count, char** argument) {
    try {
        if (count < 2) fail("usage: almesh_in_one_file MESH.msh [BOUNDARY translate DX DY | BOUNDARY rotate A ...]");
        return run({argument + 1, argument + count});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 2;
    }
}
