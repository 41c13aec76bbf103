// set(nodes) = all at once if valid, else set(first half), set(second half); then Newton's method for P grad E = 0.
#include "method/polish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "method/local_functional.hpp"

namespace almesh {
namespace {

constexpr int most_tries = 1000;

// The projector onto the kernel of D, which is symmetric and not negative: takes away the longest of its columns that
// are left until there is none.
Mat<3> kernel_of(const Mat<3>& D, int dim) {
    constexpr double zero = 1e-12;  // squared
    Mat<3> P{};
    for (int a = 0; a < dim; ++a) P[a][a] = 1;
    for (;;) {
        Vec<3> u{};
        for (const Vec<3>& column : D)
            if (const Vec<3> left = times(P, column); dot(left, left) > dot(u, u)) u = left;
        if (dot(u, u) <= zero) return P;
        for (int a = 0; a < dim; ++a)
            for (int b = 0; b < dim; ++b) P[a][b] -= u[a] * u[b] / dot(u, u);
    }
}

}  // namespace

int snap_to_targets(DistortionEnergy& distortion, const Constraint& constraint, std::vector<double>& x,
                    const std::vector<char>& chosen) {
    std::vector<int> nodes = constraint.nodes();
    std::vector<double> targets = constraint.targets(x);
    const int dim = nodes.empty() ? 0 : static_cast<int>(targets.size() / nodes.size());
    std::size_t count = 0;
    for (std::size_t t = 0; t < nodes.size() && dim > 0; ++t) {
        if (!chosen.empty() && !chosen[nodes[t]]) continue;
        std::copy_n(&targets[offset(t, dim)], dim, &targets[offset(count, dim)]);
        nodes[count++] = nodes[t];
    }
    nodes.resize(count);
    int tries = 0;
    std::vector<double> trial = x;
    const auto set = [&](const auto& self, int first, int end) -> void {
        if (first == end || tries == most_tries) return;
        ++tries;
        for (int t = first; t < end; ++t) std::copy_n(&targets[offset(t, dim)], dim, point(trial, nodes[t], dim));
        if (std::isfinite(distortion.energy(trial)) && distortion.valid_fraction(x, trial) == 1) {
            x = trial;
            return;
        }
        for (int t = first; t < end; ++t) std::copy_n(point(x, nodes[t], dim), dim, point(trial, nodes[t], dim));
        const int middle = first + (end - first) / 2;
        if (middle == first) return;
        self(self, first, middle);
        self(self, middle, end);
    };
    set(set, 0, dim == 0 ? 0 : static_cast<int>(nodes.size()));
    return nodes_off_target(constraint, x);
}

int nodes_off_target(const Constraint& constraint, const std::vector<double>& x) {
    const std::vector<char> off = constraint.off_target(x);
    return static_cast<int>(std::count(off.begin(), off.end(), 1));
}

OnTarget::OnTarget(DistortionEnergy& energy, Constraint& on_boundary, int node_count)
    : AugmentedFunctional(energy, on_boundary, std::vector<double>(on_boundary.multipliers(), 0.0)),
      place_(node_count, -1), slides_(on_boundary.corrects_steps()) {
    if (!slides_) fixed.assign(node_count, 0);
    for (const int node : constraint.nodes()) {
        place_[node] = static_cast<int>(nodes_.size());
        nodes_.push_back({node, {}, {}, {}, {}});
        if (!slides_) fixed[node] = 1;
    }
}

std::vector<double> OnTarget::set_point(const std::vector<double>& x) const {
    const int dim = distortion.dim();
    std::vector<double> gradient(x.size(), 0.0);
    distortion.add_gradient(x, gradient);
    distortion.pairs().fold(gradient);
    for (Node& at : nodes_) {
        const Vec<3> position = at_node(x, at.node, dim), force = at_node(gradient, at.node, dim);
        Mat<3> D = constraint.distance(place(at.node), position).slope;
        at.P = kernel_of(D, dim);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) D[a][b] += a < dim ? at.P[a][b] : a == b;
        at.D_inverse = inverse<3>(D);
        at.f = times(at.D_inverse, times(at.P, force) - force);
        at.K = constraint.second_derivative_at(place(at.node), position, at.f);
    }
    project(gradient);
    return gradient;
}

void OnTarget::project(std::vector<double>& v) const {
    const int dim = distortion.dim();
    for (const Node& at : nodes_)
        set_node(v, at.node, dim, times(at.P, at_node(v, at.node, dim)));
}

void OnTarget::project(BlockCsr& H) const {
    const int d = distortion.dim();
    const Node inside{-1, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}, {}, {}};
    const auto node_of_row = [&](int i) -> const Node& {
        const int found = place(H.node_of(i));
        return found < 0 ? inside : nodes_[found];
    };
    parallel_for(H.n, [&](int i) {
        const Node& left = node_of_row(i);
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const Node& right = node_of_row(H.col[k]);
            if (left.node < 0 && right.node < 0) continue;
            const bool is_diagonal = H.col[k] == i;
            double* const block = H.block(k);
            Mat<3> B{};
            for (int a = 0; a < d; ++a)
                for (int b = 0; b < d; ++b) B[a][b] = block[a * d + b] + (is_diagonal ? left.K[a][b] : 0);
            const double size = std::sqrt(frobenius_squared<3>(B)), scale = !is_diagonal ? 0 : size > 0 ? size : 1;
            B = multiply<3>(multiply<3>(left.P, B), right.P);
            for (int a = 0; a < d; ++a)
                for (int b = 0; b < d; ++b) block[a * d + b] = B[a][b] + scale * ((a == b) - left.P[a][b]);
        }
    });
}

std::unique_ptr<LocalFunctional> OnTarget::part(const std::vector<double>& x, std::vector<char> moves) const {
    for (const Node& at : nodes_) moves[at.node] = 0;
    return AugmentedFunctional::part(x, std::move(moves));
}

// Near the minimum the rounding of eta counts: the energy of (eta - 1)^2 is known to 2 (eta - 1) eps, however small it
// is.
NewtonResult polish(OnTarget& E, Newton& newton, double omega, std::vector<double>& x) {
    constexpr double unit = 4 * std::numeric_limits<double>::epsilon();
    if (nodes_off_target(E.constraint, x) > 0 && snap_to_targets(E.distortion, E.constraint, x) > 0)
        return {.status = Status::stalled};
    E.rounding_ = unit * E.distortion.mean_slope(E.distortion.energy(x)) * E.distortion.domain_volume();
    const NewtonResult result = newton.minimise(E, {.omega = omega, .first = HessianKind::full}, x);
    if (E.slides_) snap_to_targets(E.distortion, E.constraint, x);
    return result;
}

}  // namespace almesh
