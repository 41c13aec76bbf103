// The parts of an almesh of one's own: what lessons 1 to 10 leave in src/lessons/exercises/. almesh.cpp puts them
// together to Algorithm 1 for triangles of degree 1; rehearsal.cpp tries them, each alone and all together, before the
// run; parts.cpp has of each the student's version and the library's, one of which is compiled.
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/mesh.hpp"

namespace almesh {
class DistortionEnergy;
struct TraceSpace;
}  // namespace almesh

namespace almesh::own {

using Vector = std::vector<double>;        // of the nodes: x_0, y_0, x_1, y_1, ...
using Corners = std::array<Vec<2>, 3>;     // something for each vertex of a triangle
using Triangle = std::array<int, 3>;
using ElementMatrix = std::array<std::array<double, 6>, 6>;

// The mesh at rest, and where its boundary has to go. Reading it is the library's task.
struct Problem {
    Mesh mesh;
    std::vector<Triangle> triangles;
    std::vector<std::array<int, 2>> edges;  // of the boundary
    std::vector<int> on;                    // the nodes of it
    Vector g;                               // targets of these nodes
    std::shared_ptr<DistortionEnergy> energy;  // the library's, for parts that are borrowed from it
    std::shared_ptr<TraceSpace> trace;

    int nodes() const { return mesh.nodes(); }
    double one() const { return std::sqrt(static_cast<double>(edges.size())); }  // |1|
};

// boundary: its name; motion: as decks have it, "translate 8 0". The other boundaries stay.
Problem make_problem(const std::string& path, const std::string& boundary, const std::string& motion);

// What a part does wrong, where that can be told.
struct PartFails : std::runtime_error {
    PartFails(std::string part_, const std::string& message) : std::runtime_error(message), part(std::move(part_)) {}
    std::string part;
};

extern const char* volatile part_at_work;  // its name; "" where it is none of them

// distortion: eta of Eq. 1, infinite where det F is not positive.
double eta(const Mat<2>& F);

// gradient: eta_F.
Mat<2> eta_F(const Mat<2>& F);

// hessian: W_FF H for W = eta^2.
Mat<2> W_FF(const Mat<2>& F, const Mat<2>& H);

// assembly
Corners hat_gradients(const Corners& y);
BlockCsr empty_hessian(const Problem& problem);  // its pattern, with zeros
Vector assembled(const Problem& problem, const std::vector<Corners>& of_triangles);
void add_to(BlockCsr& H, const Triangle& triangle, const ElementMatrix& of_triangle);

// projection: the positive semidefinite part.
Mat<2> positive_part(const Mat<2>& A);

// line_search: how far x + t d is valid (at least 1: the full step is); and the first of 1, 1/2, 1/4, ... that
// satisfies Armijo's condition for phi(t), phi(0) = 0 with the slope -1.
double valid_until(const Problem& problem, const Vector& x, const Vector& d);
double accepted_step(const std::function<double(double)>& phi);

// trace: M u, M the mass matrix of the boundary, in which an edge of any length counts alike.
Vector mass_times(const Problem& problem, const Vector& u);

// update: line 10 for one number of lambda.
double updated(double lambda, double mu, double c);

// schedule: lines 7 and 9 to 21.
struct Settings {
    double m, mu, omega, epsilon;
    bool updates_lambda = false;
};
struct Constants {  // of the circle of section 4.1; mu0 in units of |1|^2
    double mu0 = 24, omega0 = 0.1, epsilon0 = 1e-4, omega_star = 1e-6, epsilon_star = 1e-14;
};
bool goes_on(double c_squared, double gradient_norm, const Constants& constants);
Settings next(const Settings& now, double c_squared, double mu0, const Constants& constants);

// solver: A x = b. False where A turns out not to be positive definite.
bool solve(const BlockCsr& A, const Vector& b, Vector& x);

// certificate: whether a triangle keeps its orientation all the way from x to x + d, by a proof.
bool valid_on_the_way(const Corners& from, const Corners& to);

Corners corners(const Triangle& triangle, const Vector& x);
double twice_the_area(const Corners& corner);  // with its sign
double dot(const Vector& a, const Vector& b);

// ------------------------------------------------------------------- what almesh.cpp makes of them

// L(x) = sum of |e| eta^2 - (lambda, c) + mu/2 (c, c), c = (x - g) / |1|, the paper's Eq. 6 as corrected.
class Lagrangian {
public:
    explicit Lagrangian(const Problem& problem);
    Vector lambda;
    double mu = 0;

    Mat<2> F(int e, const Vector& x) const;
    double area(int e) const { return area_[e]; }
    Vector c(const Vector& x) const;
    double product(const Vector& u, const Vector& v) const;  // of the trace space
    double value(const Vector& x) const;
    Vector gradient(const Vector& x) const;
    BlockCsr hessian(const Vector& x, bool projected) const;

private:
    const Problem& problem_;
    std::vector<Corners> grad_;  // of the hat functions
    std::vector<double> area_;
    BlockCsr pattern_;
    std::vector<std::pair<std::array<int, 2>, double>> mass_;  // ((i, j), M_ij), i and j nodes
};

// The 4 x 4 second derivative of eta^2 by the entries of F, row by row; projected: its positive semidefinite part.
Mat<4> second_derivative(const Mat<2>& F, bool projected);

// Tries the parts; PartFails names the first that does not do what it should.
void rehearse(const Problem& problem);

}  // namespace almesh::own
