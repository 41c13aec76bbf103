// An almesh of one's own: Algorithm 1 for triangles of degree 1, made of the parts that the lessons leave (parts.hpp).
//
//   own-almesh MESH.msh BOUNDARY MOTION     "translate 8 0": as decks have it; the other boundaries stay
//
//     minimise  int (eta(D phi) - 1)^2 dy   subject to  phi = g_D on the boundary                 (Eq. 5 of the paper)
//
// with eta^2 in place of (eta - 1)^2, as the paper's tables were made.
//
// It tries the parts (rehearsal.cpp), runs, certifies every step, asks the library whether the result is valid, and
// writes outputs/lessons/12-project/own.csv and own.vtk. Exit code 1 where a part fails: it says which, and how.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "check/certificate.hpp"
#include "constraint/trace_space.hpp"
#include "energy/distortion_energy.hpp"
#include "io/mesh_format.hpp"
#include "io/vtk.hpp"
#include "lessons/own/parts.hpp"
#include "mesh/build.hpp"

namespace almesh::own {

Problem make_problem(const std::string& path, const std::string& boundary, const std::string& motion) {
    Problem problem;
    std::vector<std::string> notes;
    Mesh& mesh = problem.mesh = build_mesh(read_mesh(path), notes);
    if (mesh.dim != 2 || mesh.degree != 1 || !mesh.is_simplicial())
        throw std::runtime_error(path + " has other cells than triangles of degree 1");
    if (std::find(mesh.boundaries.begin(), mesh.boundaries.end(), boundary) == mesh.boundaries.end())
        throw std::runtime_error(path + " has no boundary " + boundary);
    std::vector<Motion> motions;
    for (const std::string& name : mesh.boundaries)
        motions.push_back(parse_motion(name == boundary ? motion : "fixed"));
    const BoundaryTarget target = make_target(mesh, motions);
    problem.g = at_target(mesh, target, mesh.x);
    for (int e = 0; e < mesh.element_count(); ++e)
        problem.triangles.push_back({mesh.element(e)[0], mesh.element(e)[1], mesh.element(e)[2]});
    for (int f = 0; f < mesh.face_count(); ++f) problem.edges.push_back({mesh.face(f)[0], mesh.face(f)[1]});
    problem.trace = std::make_shared<TraceSpace>(mesh, mesh.x, target);
    problem.on = problem.trace->nodes;
    problem.energy = make_energy(mesh, mesh.x, {.objective = Objective::squared});
    return problem;
}

Corners corners(const Triangle& triangle, const Vector& x) {
    Corners corner;
    for (int v = 0; v < 3; ++v) corner[v] = {x[2 * triangle[v]], x[2 * triangle[v] + 1]};
    return corner;
}

double twice_the_area(const Corners& corner) {
    const auto& [p, q, r] = corner;
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

double dot(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

namespace {

double product_of(const Mat<2>& A, const Mat<2>& B) {
    return A[0][0] * B[0][0] + A[0][1] * B[0][1] + A[1][0] * B[1][0] + A[1][1] * B[1][1];
}

Mat<2> rotation(double angle) { return {{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}}}; }

// The directions U e_i e_j' V' of F = U diag(s_1, s_2) V': (1, 1), (2, 2), (1, 2), (2, 1).
std::array<Mat<2>, 4> singular_directions(const Mat<2>& F) {
    const double sum = std::atan2(F[1][0] - F[0][1], F[0][0] + F[1][1]);
    const double difference = std::atan2(F[1][0] + F[0][1], F[0][0] - F[1][1]);
    const Mat<2> U = rotation((difference + sum) / 2), Vt = rotation((sum - difference) / 2);
    std::array<Mat<2>, 4> directions;
    for (int k = 0; k < 4; ++k) {
        const int i = k % 2, j = k < 2 ? i : 1 - i;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) directions[k][a][b] = U[a][i] * Vt[j][b];
    }
    return directions;
}

}  // namespace

// In the singular directions of F the 4 x 4 matrix falls into two blocks of 2 x 2, because eta does not see rotations:
// changes of the singular values, and of the directions.
Mat<4> second_derivative(const Mat<2>& F, bool projected) {
    Mat<4> A{};
    if (!projected) {
        for (int k = 0; k < 4; ++k) {
            Mat<2> H{};
            H[k / 2][k % 2] = 1;
            const Mat<2> column = W_FF(F, H);
            for (int i = 0; i < 4; ++i) A[i][k] = column[i / 2][i % 2];
        }
        return A;
    }
    const std::array<Mat<2>, 4> E = singular_directions(F);
    for (const int first : {0, 2}) {
        Mat<2> block;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) block[i][j] = product_of(E[first + i], W_FF(F, E[first + j]));
        const Mat<2> part = positive_part(block);
        for (int k = 0; k < 16; ++k)
            for (int i = 0; i < 2; ++i)
                for (int j = 0; j < 2; ++j)
                    A[k / 4][k % 4] += part[i][j] * E[first + i][k / 8][k / 4 % 2] * E[first + j][k / 2 % 2][k % 2];
    }
    return A;
}

Lagrangian::Lagrangian(const Problem& problem)
    : lambda(problem.mesh.x.size(), 0.0), problem_(problem), pattern_(empty_hessian(problem)) {
    for (const Triangle& e : problem.triangles) {
        grad_.push_back(hat_gradients(corners(e, problem.mesh.x)));
        area_.push_back(twice_the_area(corners(e, problem.mesh.x)) / 2);
    }
    for (const int j : problem.on) {  // column by column
        Vector unit(lambda.size(), 0.0);
        unit[2 * j] = 1;
        const Vector column = mass_times(problem, unit);
        for (const int i : problem.on)
            if (column[2 * i] != 0) mass_.push_back({{i, j}, column[2 * i]});
    }
}

// sum_i x_i (grad N_i)'
Mat<2> Lagrangian::F(int e, const Vector& x) const {
    Mat<2> F{};
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) F[a][k] += x[2 * problem_.triangles[e][i] + a] * grad_[e][i][k];
    return F;
}

Vector Lagrangian::c(const Vector& x) const {
    Vector c(x.size(), 0.0);
    for (const int i : problem_.on)
        for (int a = 0; a < 2; ++a) c[2 * i + a] = (x[2 * i + a] - problem_.g[2 * i + a]) / problem_.one();
    return c;
}

double Lagrangian::product(const Vector& u, const Vector& v) const { return dot(u, mass_times(problem_, v)); }

double Lagrangian::value(const Vector& x) const {
    double E = 0;
    for (std::size_t e = 0; e < area_.size(); ++e) {
        const double of_e = eta(F(static_cast<int>(e), x));
        E += area_[e] * of_e * of_e;
    }
    const Vector constraint = c(x);
    return E - product(lambda, constraint) + mu / 2 * product(constraint, constraint);
}

// of a triangle: |e| 2 eta eta_F grad N_i; of the boundary: M (mu c - lambda) / |1|
Vector Lagrangian::gradient(const Vector& x) const {
    std::vector<Corners> local(area_.size());
    for (std::size_t e = 0; e < area_.size(); ++e) {
        const Mat<2> Fe = F(static_cast<int>(e), x), G = eta_F(Fe);
        const double factor = 2 * area_[e] * eta(Fe);
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 2; ++a)
                local[e][i][a] = factor * (G[a][0] * grad_[e][i][0] + G[a][1] * grad_[e][i][1]);
    }
    Vector g = assembled(problem_, local), u = c(x);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = (mu * u[i] - lambda[i]) / problem_.one();
    const Vector of_boundary = mass_times(problem_, u);
    for (std::size_t i = 0; i < g.size(); ++i) g[i] += of_boundary[i];
    return g;
}

BlockCsr Lagrangian::hessian(const Vector& x, bool projected) const {
    BlockCsr H = pattern_;
    for (std::size_t e = 0; e < area_.size(); ++e) {
        const Mat<4> A = second_derivative(F(static_cast<int>(e), x), projected);
        ElementMatrix local{};
        for (int r = 0; r < 6; ++r)
            for (int s = 0; s < 6; ++s)
                for (int k = 0; k < 2; ++k)
                    for (int l = 0; l < 2; ++l) {
                        const double of_F = A[r % 2 * 2 + k][s % 2 * 2 + l];
                        local[r][s] += area_[e] * grad_[e][r / 2][k] * of_F * grad_[e][s / 2][l];
                    }
        add_to(H, problem_.triangles[e], local);
    }
    const double factor = mu / static_cast<double>(problem_.edges.size());
    for (const auto& [nodes, M] : mass_)  // mu M / |1|^2
        for (const int diagonal : {0, 3}) H.block(H.find(nodes[0], nodes[1]))[diagonal] += factor * M;
    return H;
}

namespace {

// Whether x + d is certified, triangle by triangle; where it is not, the certificate or the line search is wrong.
void certify_step(const Problem& problem, const Vector& from, const Vector& to) {
    for (std::size_t e = 0; e < problem.triangles.size(); ++e) {
        const Corners p = corners(problem.triangles[e], from), q = corners(problem.triangles[e], to);
        if (valid_on_the_way(p, q)) continue;
        const bool inverted = !(twice_the_area(q) > 0);
        throw PartFails(inverted ? "line_search" : "certificate",
                        concat("triangle ", e, " is not certified in a step that the line search took; at its end the ",
                               "area is ", twice_the_area(q) / 2));
    }
}

// x <- x + t d. False where there is no such t.
bool advance(const Problem& problem, const Lagrangian& L, const Vector& d, double slope, double E, Vector& x) {
    const auto at = [&](double t) {
        Vector y = x;
        for (std::size_t i = 0; i < x.size(); ++i) y[i] += t * d[i];
        return y;
    };
    const double longest = valid_until(problem, x, d);
    int trials = 0;
    const auto phi = [&](double t) {  // of slope -1; sums are rounded by 1e-14 of themselves
        if (++trials > 100) return -1.0 * trials;  // no step: whatever Armijo's condition is, it has to end
        return t == 0 ? 0 : t < longest ? (L.value(at(t)) - E - 1e-14 * std::abs(E)) / -slope : INFINITY;
    };
    const double t = accepted_step(phi);
    if (trials > 100 || !(t > 0)) return false;
    if (!(t < longest && phi(t) <= 0))
        throw PartFails("line_search", concat("it takes the step t = ", t, ", at which the energy is ",
                                              t < longest ? "not lower" : "infinite: a triangle is inverted"));
    const Vector to = at(t);
    certify_step(problem, x, to);
    x = to;
    return true;
}

// H d = -g with the full Hessian; where that is not positive definite, or leads nowhere, with the projected one.
bool newton_step(const Problem& problem, const Lagrangian& L, Vector g, Vector& x) {
    const double E = L.value(x);
    Vector d;
    for (double& entry : g) entry = -entry;
    for (const bool projected : {false, true})
        if (solve(L.hessian(x, projected), g, d) && dot(g, d) > 0 && advance(problem, L, d, -dot(g, d), E, x))
            return true;
    return false;
}

struct Subproblem {
    int steps = 0;
    double gradient_norm = 0;
};

// Until |grad L| <= omega.
Subproblem minimise(const Problem& problem, const Lagrangian& L, double omega, Vector& x) {
    for (Subproblem result;; ++result.steps) {
        const Vector g = L.gradient(x);
        result.gradient_norm = std::sqrt(dot(g, g));
        if (result.gradient_norm <= omega) return result;
        if (result.steps == 60 || !newton_step(problem, L, g, x))
            throw PartFails("", concat("Newton's method ",
                                       result.steps == 60 ? "is not at the minimum" : "finds no step", " after ",
                                       result.steps, " steps: |grad L| = ", result.gradient_norm, ", at most ", omega,
                                       " is asked for. The direction is made of hessian, projection and solver, the ",
                                       "step length of line_search"));
    }
}

struct Row {
    double quality, largest;  // q and the largest eta
};

Row quality(const Problem& problem, const Lagrangian& L, const Vector& x, std::vector<double>& of_triangle) {
    double area = 0, squared = 0;
    of_triangle.clear();
    for (int e = 0; e < static_cast<int>(problem.triangles.size()); ++e) {
        of_triangle.push_back(eta(L.F(e, x)));
        area += L.area(e);
        squared += L.area(e) * of_triangle[e] * of_triangle[e];
    }
    return {std::sqrt(area / squared), *std::max_element(of_triangle.begin(), of_triangle.end())};
}

// Algorithm 1, with the lines of the paper.
Vector algorithm_1(const Problem& problem, std::FILE* csv, std::vector<double>& of_triangle) {
    const Constants constants;
    Vector x = problem.mesh.x;                                                  // 1-2: phi is the identity
    Lagrangian L(problem);                                                      // 3: lambda = 0
    const double mu0 = constants.mu0 * problem.one() * problem.one();
    Settings now = {10, mu0, constants.omega0, constants.epsilon0};             // 4-6
    double c_squared = INFINITY, before = INFINITY;
    std::printf(" AL      |c_D|   |grad L|             q     max eta        mu  update  Newton\n");
    std::fprintf(csv, "k,c,gradient,q,max_eta,mu,update,newton\n");
    Subproblem last{0, INFINITY};
    bool updated_before = false;
    for (int k = 1; goes_on(c_squared, last.gradient_norm, constants); ++k) {   // 7
        if (k > 50)
            throw PartFails("schedule", concat("the loop has not ended after 50 iterations; |c_D| = ",
                                               std::sqrt(c_squared), ", |grad L| = ", last.gradient_norm));
        L.mu = now.mu;
        last = minimise(problem, L, std::max(now.omega, constants.omega_star), x);  // 8
        const Vector c = L.c(x);
        c_squared = L.product(c, c);
        if (updated_before && c_squared > 4 * before + constants.epsilon_star)
            throw PartFails("update", concat("|c_D| grew from ", std::sqrt(before), " to ", std::sqrt(c_squared),
                                             " when lambda had been updated"));
        now = next(now, c_squared, mu0, constants);                             // 9, 11-21
        if (now.updates_lambda)                                                 // 10
            for (std::size_t i = 0; i < c.size(); ++i) L.lambda[i] = updated(L.lambda[i], L.mu, c[i]);
        before = c_squared;
        updated_before = now.updates_lambda;
        const Row row = quality(problem, L, x, of_triangle);
        const char* const update = now.updates_lambda ? "lambda" : "mu";
        std::printf("%3d  %9.3e  %9.2e  %.10f  %.8f  %8.2e  %-6s  %6d\n", k, std::sqrt(c_squared), last.gradient_norm,
                    row.quality, row.largest, L.mu, update, last.steps);
        std::fprintf(csv, "%d,%.17g,%.17g,%.17g,%.17g,%.17g,%s,%d\n", k, std::sqrt(c_squared), last.gradient_norm,
                     row.quality, row.largest, L.mu, update, last.steps);
    }
    if (!(c_squared <= constants.epsilon_star && last.gradient_norm <= constants.omega_star))
        throw PartFails("schedule", concat("the loop ended with |c_D| = ", std::sqrt(c_squared), " and |grad L| = ",
                                           last.gradient_norm, ": both 1e-7 and 1e-6 have to be met"));
    return x;
}

void run(const std::string& path, const std::string& boundary, const std::string& motion) {
    const Problem problem = make_problem(path, boundary, motion);
    rehearse(problem);
    std::printf("rehearsal: every part does what the others rely on\n");
    const std::string folder = "outputs/lessons/12-project/";
    std::filesystem::create_directories(folder);
    using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
    const File csv(std::fopen((folder + "own.csv").c_str(), "w"), &std::fclose);
    if (!csv) throw std::runtime_error("cannot write " + folder + "own.csv");
    std::vector<double> of_triangle;
    const Vector x = algorithm_1(problem, csv.get(), of_triangle);
    std::printf("certificate: each of %zu triangles kept its orientation in every step\n", problem.triangles.size());
    if (!certify(problem.mesh, x).valid)
        throw PartFails("certificate", "every step has been certified, and the library finds the result NOT valid");
    std::printf("the library's certificate of the result: valid\n");
    write_vtk(folder + "own.vtk",
              {"almesh of one's own", 2, 1, x, problem.mesh.elements, 2, {}, {{"eta", 1, of_triangle}}, {}});
}

// What a crash or an endless loop of a part leaves to say. Only write() and _exit() are safe here.
void tell_part(int signal) {
    const char* const why = signal == SIGXCPU   ? "takes too long: is there a loop that does not end?"
                            : signal == SIGSEGV ? "crashes: an index out of range, or a call of itself without end?"
                            : signal == SIGFPE  ? "crashes: an integer division by zero?"
                                                : "crashes: a failed assertion, or an index out of range?";
    const char* const part = part_at_work;
    for (const char* const text : {"\nFAILS ", part, ": ", why, "\n"})
        if (write(STDOUT_FILENO, text, std::strlen(text)) < 0) break;
    _exit(1);
}

void watch_signals() {
    static char stack[1 << 16];  // of the handler: a recursion without end has used up the other
    const stack_t other = {.ss_sp = stack, .ss_flags = 0, .ss_size = sizeof stack};
    sigaltstack(&other, nullptr);
    struct sigaction action {};
    action.sa_handler = tell_part;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGXCPU}) sigaction(signal, &action, nullptr);
    rlimit time{};  // where the processor time is limited: SIGXCPU a second before the end
    if (getrlimit(RLIMIT_CPU, &time) == 0 && time.rlim_max != RLIM_INFINITY) time.rlim_cur = time.rlim_max - 1;
    setrlimit(RLIMIT_CPU, &time);
}

}  // namespace
}  // namespace almesh::own

int main(int count, char** argument) {
    using namespace almesh::own;
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what came before a crash is shown
    watch_signals();
    try {
        if (count != 4) throw std::runtime_error("usage: own-almesh MESH.msh BOUNDARY MOTION");
        run(argument[1], argument[2], argument[3]);
        return 0;
    } catch (const PartFails& failure) {
        std::printf("FAILS %s: %s\n", failure.part.c_str(), failure.what());
        return 1;
    } catch (const std::exception& error) {
        const std::string part = part_at_work;
        std::printf(part.empty() ? "%s%s\n" : "FAILS %s: it throws an exception: %s\n", part.c_str(), error.what());
        return part.empty() ? 2 : 1;
    } catch (...) {
        std::printf("FAILS %s: it throws something that is no std::exception\n", part_at_work);
        return 1;
    }
}
