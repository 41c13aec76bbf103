#include "problem/untangling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/disjoint_sets.hpp"
#include "base/interrupt.hpp"
#include "check/certificate.hpp"
#include "check/infeasible.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/restriction.hpp"
#include "mesh/quadrature.hpp"
#include "mesh/sides.hpp"
#include "method/local_functional.hpp"
#include "method/newton.hpp"

namespace almesh {
namespace {

constexpr double first_sigma = 1;  // of the least determinant
constexpr double least_fall = 0.1, most_fall = 0.5;  // s
constexpr double least_delta = 1e-9;
constexpr double flat = 1e-12;  // determinant, relative to the ideal one's, that may be rounding
constexpr double penalties[] = {1e3, 1e8};  // of nodes that slide, in units of |1|^2 per |1|^2
constexpr int most_deltas = 100, steps_of_first_delta = 100, steps_of_delta = 5, steps_of_barrier = 20;

using Moves = std::vector<char>;  // per node
using Reasons = std::vector<std::string>;

struct Untangling {
    const Mesh& mesh_;
    const std::vector<double>& volume_;
    DistortionEnergy& energy_;
    Constraint& constraint_;
    const BoundaryTarget& target_;
    const LinearSolverParams& linear_;
    const Reasons& infeasible_;
    std::vector<double>& x_;

    const Moves held_ = held_nodes(mesh_, target_);  // per node: whether the boundary does not leave it free
    const std::vector<int> directions_ = held_directions(constraint_, x_, mesh_.dim);  // before any node moves
    AugmentedFunctional E_{energy_, constraint_, std::vector<double>(constraint_.multipliers(), 0.0), 0,
                           Moves(mesh_.nodes(), 0)};
    std::vector<ReferenceElement> reference_ = {};  // by group of elements
    UntanglingResult result_ = {};

    UntanglingResult run() {
        for (const ElementGroup& group : mesh_.element_groups())
            reference_.push_back(
                reference_element(*group.cell, mesh_.degree, element_quadrature(*group.cell, mesh_.degree, 0)));
        find_left();
        int before = 0;  // nodes that could move in the last round
        for (int layers = 1; !result_.left.empty() && !interrupted(); layers *= 2) {
            int count = 0;
            const std::size_t invalid = result_.left.size();
            for (const bool slide : {false, true}) {
                if (slide && (!can_slide() || result_.left.empty())) break;
                fix_boundary(slide);
                for (const auto& [first, nodes] : regions(layers, slide)) {
                    Moves moves(mesh_.nodes(), 0);
                    for (const int i : nodes) moves[i] = 1;
                    count += static_cast<int>(nodes.size());
                    result_.regions += slide ? untangle_sliding(moves) : untangle(moves, x_);
                }
                find_left();
            }
            if (count == before && result_.left.size() == invalid) break;  // there is no more room
            before = count;
        }
        return std::move(result_);
    }

    bool is_infeasible(int e) const { return !infeasible_.empty() && !infeasible_[e].empty(); }

    void find_left() {
        result_.left = certify(mesh_, x_).uncertified;
        std::erase_if(result_.left, [&](int e) { return is_infeasible(e); });
    }

    bool slides(int i) const { return !directions_.empty() && directions_[i] > 0 && directions_[i] < mesh_.dim; }
    bool can_slide() const {
        for (int i = 0; i < mesh_.nodes(); ++i)
            if (slides(i)) return true;
        return false;
    }

    // All nodes of the boundary but for free ones; or without those that slide. Those of periodic sides stay.
    void fix_boundary(bool slide) {
        for (const int i : E_.constraint.nodes()) E_.fixed[i] = held_[i] && !(slide && slides(i));
        for (const PeriodicPairs::Pair& pair : energy_.pairs().pairs) E_.fixed[pair.slave] = E_.fixed[pair.master] = 1;
    }

    void project(const Moves& moves, std::vector<double>& x) const {
        const std::vector<int>& nodes = E_.constraint.nodes();
        const std::vector<double> targets = E_.constraint.targets(x);
        for (std::size_t t = 0; t < nodes.size(); ++t)
            if (const int i = nodes[t]; moves[i])
                std::copy_n(point(targets, static_cast<int>(t), mesh_.dim), mesh_.dim, point(x, i, mesh_.dim));
    }

    // Whether the boundary is folded over along a side with a node that slides: it has gone past a corner.
    bool is_folded(const Moves& moves, const std::vector<double>& x) const {
        constexpr double most = -0.5;  // cosine of the angle between normals
        std::vector<Side> sides;
        for (int f = 0; f < mesh_.face_count(); ++f) {
            const std::span<const int> vertices = mesh_.face_vertices(f);
            if (std::any_of(vertices.begin(), vertices.end(), [&](int i) { return moves[i] != 0; }))
                append_sides_of_face(mesh_, f, f, sides);
        }
        bool folded = false;
        for_equal_sides(sides, [&](std::span<const Side> equal) {
            const auto begin = equal[0].vertex.begin();
            const auto on_one_surface = [&](int i) { return slides(i) && directions_[i] == 1; };
            if (!std::any_of(begin, begin + mesh_.dim - 1, on_one_surface)) return;
            const Vec<3> normal = unit_normal(mesh_, x, equal[0].number);
            for (const Side& other : equal.subspan(1))
                folded = folded || dot(normal, unit_normal(mesh_, x, other.number)) < most;
        });
        return folded;
    }

    bool untangle_sliding(const Moves& moves) {
        if (is_valid(moves, x_)) return false;
        std::vector<double> x = x_;
        for (const double penalty : penalties) {
            E_.penalty = penalty * std::pow(E_.constraint.norm_of_one(), 2);
            if (untangle(moves, x)) project(moves, x);
        }
        E_.penalty = 0;
        if (!is_valid(moves, x) || is_folded(moves, x)) return false;
        x_ = x;
        return true;
    }

    template <class Body>
    void for_nodes(int e, const Body& body) const {
        for (int k = 0; k < mesh_.element_nodes(e); ++k) body(mesh_.element(e)[k]);
    }

    // The nodes of inverted elements and of so many layers around them, in sets that have no element in common. Where
    // the boundary stays, without elements that it makes infeasible.
    std::map<int, std::vector<int>> regions(int layers, bool slide) const {
        Moves near(mesh_.nodes(), 0), infeasible(mesh_.element_count(), 0);
        if (!slide)
            for (const InfeasibleElement& of : infeasible_elements(mesh_, x_, held_, flat_jacobian))
                infeasible[of.element] = 1;
        for (const int e : result_.left)
            if (!infeasible[e]) for_nodes(e, [&](int i) { near[i] = 1; });
        for (int layer = 0; layer < layers; ++layer)
            for (const int e : restriction_to(near, mesh_).element) for_nodes(e, [&](int i) { near[i] = 1; });
        for (int i = 0; i < mesh_.nodes(); ++i) near[i] = near[i] && !E_.fixed[i];
        DisjointSets sets(mesh_.nodes());
        for (int e = 0; e < mesh_.element_count(); ++e) {
            int first = -1;
            for_nodes(e, [&](int i) {
                if (!near[i]) return;
                if (first >= 0) sets.join(first, i);
                first = i;
            });
        }
        std::map<int, std::vector<int>> found;  // by the least of their nodes
        for (int i = 0; i < mesh_.nodes(); ++i)
            if (near[i]) found[sets.find(i)].push_back(i);
        return found;
    }

    // Over the points of the elements, relative to the ideal ones.
    double least_determinant(const std::vector<int>& elements, const std::vector<double>& x) const {
        double least = std::numeric_limits<double>::infinity();
        for (const int e : elements) {
            if (is_infeasible(e)) continue;
            const ReferenceElement& reference = reference_[mesh_.group_number(e)];
            const double ideal = volume_[e] / reference.cell->volume();
            with_dimension(mesh_.dim, [&](auto n) {
                for (int q = 0; q < reference.points; ++q)
                    least = std::min(least, determinant(jacobian_at<n()>(mesh_.element(e), x, reference, q)) / ideal);
            });
        }
        return least;
    }

    // elements: those of the functional.
    bool is_valid(LocalFunctional& local, const std::vector<int>& elements, const std::vector<double>& x) const {
        const std::vector<double> y = local.read(x);
        local.distortion.set_delta(0);
        return least_determinant(elements, x) > flat && std::isfinite(local.energy(y)) &&
               local.valid_fraction(y, y) == 1;
    }

    bool is_valid(const Moves& moves, const std::vector<double>& x) const {
        return is_valid(*E_.part(x, moves), restriction_to(moves, mesh_).element, x);
    }

    // Moves the nodes of the region in `at` where that makes it valid; whether it does.
    bool untangle(const Moves& moves, std::vector<double>& at) {
        const std::unique_ptr<LocalFunctional> local = E_.part(at, moves);
        DistortionEnergy& distortion = local->distortion;
        std::vector<double> y = local->read(at), x = at;
        const std::vector<int> elements = restriction_to(moves, mesh_).element;
        const auto is_valid_now = [&] { return is_valid(*local, elements, x); };
        if (is_valid_now()) return false;  // a neighbour of one that is not
        Newton newton(local->hessian_pattern(), linear_, NewtonPolicies::of_few_nodes());
        const auto minimise = [&](double reduction, int steps) {
            NewtonParams params{.omega = std::numeric_limits<double>::max(), .reduction = reduction};
            params.max_iterations = steps;
            const NewtonResult found = newton.minimise(*local, params, y);
            result_.newton_iterations += found.iterations;
            local->write(y, x);
            return std::max(least_fall, 1 - found.energy / found.start_energy);
        };
        double D = least_determinant(elements, x);
        double delta = std::sqrt(first_sigma * (first_sigma - std::min(D, 0.0)));
        for (int k = 0; k < most_deltas && delta > least_delta && !is_valid_now() && !interrupted(); ++k) {
            distortion.set_delta(delta);
            const bool first = k == 0;  // the functional is next to convex: what comes is from near its minimum
            const double fall =
                std::min(most_fall, minimise(first ? 0.01 : 0.1, first ? steps_of_first_delta : steps_of_delta));
            D = least_determinant(elements, x);
            const double sigma = (1 - fall) * (D + std::sqrt(D * D + 4 * delta * delta)) / 2;
            delta = D < sigma ? std::sqrt(sigma * (sigma - D)) : 0.1 * delta;
        }
        if (!is_valid_now()) return false;
        minimise(0.01, steps_of_barrier);
        at = x;
        return true;
    }
};

}  // namespace

UntanglingResult untangle_regions(const Mesh& mesh, const std::vector<double>& volume, DistortionEnergy& energy,
                                  Constraint& constraint, const BoundaryTarget& target,
                                  const LinearSolverParams& linear, const Reasons& infeasible,
                                  std::vector<double>& x) {
    return Untangling{mesh, volume, energy, constraint, target, linear, infeasible, x}.run();
}

}  // namespace almesh
