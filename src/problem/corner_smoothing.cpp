// s = det(a, b, c) / (|a| |b| |c|) over that of the regular cell, a, b, c the edges at the corner:
// grad_a log s = b x c / det - a / |a|^2.
#include "problem/corner_smoothing.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "base/small_matrix.hpp"
#include "base/text.hpp"
#include "check/scaled_jacobian.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/patch.hpp"
#include "mesh/restriction.hpp"
#include "method/local_functional.hpp"
#include "method/newton.hpp"

namespace almesh {
namespace {

constexpr int first_power = 8, last_power = 64, steps_of_power = 8;
constexpr double worthwhile = 0.002;  // part of the energy that a step has to gain for another one
constexpr double quadratic_part = 0.03;
constexpr double margin = 0.15;      // s < s_0 + margin (1 - s_0) is bad
constexpr double stabilising = 1e-3, least_stiffness = 1e-6;  // fractions of the own and of the largest stiffness

// E_p of the corners of elements with a node that moves, as a function of the positions of these nodes.
class CornerFunctional : public Functional {
public:
    CornerFunctional(const Mesh& mesh, const std::vector<char>& moving, double least, int p, DistortionEnergy& energy,
                     const std::vector<double>& x)
        : Functional(energy), least_(least), p_(p), dim_(mesh.dim), around_(restriction_to(moving, mesh)),
          at_(at_nodes(around_.node, x, dim_)) {
        for (std::size_t e = 0; e < around_.element.size(); ++e)
            for (const Corner& of : corners_of(mesh.cell(around_.element[e]))) {
                Place corner{{}, of.regular};
                for (int k = 0; k <= dim_; ++k) corner.node[k] = around_.elements[e * (dim_ + 1) + of.vertex[k]];
                corners_.push_back(corner);
            }
    }

    std::vector<double> read(const std::vector<double>& x) const { return around_.read(x, dim_); }
    void write(const std::vector<double>& y, std::vector<double>& x) const { around_.write(y, dim_, x); }

    BlockCsr hessian_pattern() const {
        std::vector<int> cells;  // in place of a node that does not move one that does: those are the first
        for (const Place& corner : corners_) {
            const int moving = *std::min_element(corner.node.begin(), corner.node.begin() + dim_ + 1);
            for (int k = 0; k <= dim_; ++k) cells.push_back(moves(corner.node[k]) ? corner.node[k] : moving);
        }
        return matrix_of_cells(around_.moving, dim_, cells, dim_ + 1);
    }

    double energy(const std::vector<double>& y) const override {
        std::copy(y.begin(), y.end(), at_.begin());
        double sum = 0;
        for (const Place& corner : corners_) {
            const double s = at(corner, nullptr);
            if (!(s > 0)) return std::numeric_limits<double>::infinity();
            sum += terms(s, 0);
        }
        return sum;
    }

    void gradient(const std::vector<double>& y, std::vector<double>& g) const override {
        std::copy(y.begin(), y.end(), at_.begin());
        std::fill(g.begin(), g.end(), 0.0);
        Slopes slopes;
        for (const Place& corner : corners_) {
            const double weight = -terms(at(corner, &slopes), 1);
            for (int k = 0; k <= dim_; ++k)
                for (int a = 0; a < dim_ && moves(corner.node[k]); ++a)
                    g[offset(corner.node[k], dim_, a)] += weight * slopes[k][a];
        }
    }

    void hessian(const std::vector<double>& y, HessianKind, BlockCsr& H, const Projection&) const override {
        std::copy(y.begin(), y.end(), at_.begin());
        std::fill(H.value.begin(), H.value.end(), 0.0);
        Slopes slopes;
        for (const Place& corner : corners_) {
            const double weight = terms(at(corner, &slopes), 2);
            for (int k = 0; k <= dim_; ++k)
                for (int l = 0; l <= dim_ && moves(corner.node[k]); ++l) {
                    if (!moves(corner.node[l])) continue;
                    double* const block = H.block(H.find(corner.node[k], corner.node[l]));
                    for (int a = 0; a < dim_; ++a)
                        for (int b = 0; b < dim_; ++b) block[a * dim_ + b] += weight * slopes[k][a] * slopes[l][b];
                }
        }
        stabilise(H);
    }

    double distortion_energy(const std::vector<double>&, double energy) const override { return energy; }
    double valid_fraction(const std::vector<double>&, const std::vector<double>&) const override { return 1; }
    std::unique_ptr<LocalFunctional> part(const std::vector<double>&, std::vector<char>) const override { return {}; }

private:
    struct Place {
        std::array<int, 4> node;
        double regular;  // that of a regular cell
    };
    using Slopes = std::array<Vec<3>, 4>;  // of log s, with respect to the nodes

    double least_;
    int p_, dim_;
    Restriction around_;
    mutable std::vector<double> at_;  // of its nodes
    std::vector<Place> corners_;

    bool moves(int node) const { return node < around_.moving; }

    // What a corner adds to E_p, or its derivative of this order with respect to -log s.
    double terms(double s, int order) const {
        const double square = (least_ / s) * (least_ / s);
        double power = square;
        for (int p = 2; p < p_; p *= 2) power *= power;
        double of_square = quadratic_part * square;
        for (int k = 0; k < order; ++k) power *= p_, of_square *= 2;
        return power + of_square;
    }

    double at(const Place& corner, Slopes* slopes) const {
        std::array<Vec<3>, 3> edge{{{}, {}, {0, 0, 1}}};
        double lengths = 1;
        for (int k = 0; k < dim_; ++k) {
            edge[k] = at_node(at_, corner.node[k + 1], dim_) - at_node(at_, corner.node[0], dim_);
            lengths *= length(edge[k]);
        }
        const double det = dot(edge[0], cross(edge[1], edge[2]));
        for (int k = 0; k < dim_ && slopes; ++k) {
            (*slopes)[k + 1] = 1 / det * cross(edge[(k + 1) % 3], edge[(k + 2) % 3]) -
                               1 / dot(edge[k], edge[k]) * edge[k];
            (*slopes)[0] = (k > 0 ? (*slopes)[0] : Vec<3>{}) - (*slopes)[k + 1];
        }
        return lengths > 0 ? det / (lengths * corner.regular) : 0;
    }

    // A node on which no bad corner hangs has no stiffness.
    void stabilise(BlockCsr& H) const {
        double largest = 0;
        const auto each = [&](const auto& body) {
            for (int i = 0; i < H.n; ++i)
                for (int a = 0; a < dim_; ++a) body(H.block(H.find(i, i))[a * dim_ + a]);
        };
        each([&](double& h) { largest = std::max(largest, h); });
        each([&](double& h) { h += stabilising * h + least_stiffness * largest; });
    }
};

// Of the elements with a free node: the least s, and the free nodes of the bad ones.
struct Worst {
    double least = 1;
    std::vector<char> moves;

    bool any() const { return std::find(moves.begin(), moves.end(), 1) != moves.end(); }
};

Worst worst_corners(const Mesh& mesh, const std::vector<char>& fixed, const std::vector<double>& x) {
    const std::vector<double> s = corner_jacobians(mesh, x);
    Worst worst{.moves = std::vector<char>(mesh.nodes(), 0)};
    const auto for_free = [&](int e, const auto& body) {
        for (int k = 0; k < mesh.element_nodes(e); ++k)
            if (!fixed[mesh.element(e)[k]]) body(mesh.element(e)[k]);
    };
    for (int e = 0; e < mesh.element_count(); ++e)
        for_free(e, [&](int) { worst.least = std::min(worst.least, s[e]); });
    for (int e = 0; e < mesh.element_count(); ++e)
        if (s[e] < worst.least + margin * (1 - worst.least))
            for_free(e, [&](int i) { worst.moves[i] = 1; });
    return worst;
}

}  // namespace

CornerSmoothing smooth_corners(const Mesh& mesh, const std::vector<char>& fixed, DistortionEnergy& energy,
                               const LinearSolverParams& linear, std::vector<double>& x) {
    Worst worst = worst_corners(mesh, fixed, x);
    CornerSmoothing result{worst.least, worst.least};
    std::vector<double> at = x;
    for (int p = first_power; p <= last_power && worst.any() && worst.least > 0; p *= 2) {
        CornerFunctional E(mesh, worst.moves, worst.least, p, energy, at);
        Newton newton(E.hessian_pattern(), linear, NewtonPolicies::of_few_nodes());
        std::vector<double> y = E.read(at);
        NewtonParams params{.omega = 0, .max_iterations = steps_of_power, .least_gain = worthwhile * E.energy(y)};
        result.newton_steps += newton.minimise(E, params, y).iterations;
        E.write(y, at);
        worst = worst_corners(mesh, fixed, at);
        if (worst.least <= result.after) continue;
        result.after = worst.least;
        x = at;
    }
    return result;
}

Solution best_of_powers(const ProblemOptions& options, const Problem& problem, const Solve& solve, std::FILE* out) {
    constexpr int lower_power = 8;
    if (options.distortion.objective != Objective::minimax || options.power) return solve(options, problem);
    const auto least = [&](const Solution& solution) {
        const double certified = certify(problem.mesh(), solution.x).min_scaled_jacobian;
        return std::min(certified, least_corner_jacobian(problem.mesh(), solution.x));
    };
    ProblemOptions with_lower = options;
    with_lower.power = lower_power;
    Solution lower = solve(with_lower, problem);
    if (lower.al.status == Status::interrupted) return lower;
    Solution full = solve(options, problem);
    if (lower.al.status != Status::converged || full.al.status == Status::interrupted) return full;
    const double of_lower = least(lower), of_full = least(full);
    std::fprintf(out, "least scaled Jacobian: %s with power = %d, %s with all powers\n",
                 rounded_down(of_lower, 4).c_str(), lower_power, rounded_down(of_full, 4).c_str());
    return full.al.status != Status::converged || of_lower > of_full ? lower : full;
}

}  // namespace almesh
