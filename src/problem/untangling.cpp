#include "problem/untangling.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "base/disjoint_sets.hpp"
#include "base/interrupt.hpp"
#include "check/certificate.hpp"
#include "check/infeasible.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/face_patches.hpp"
#include "mesh/local_size.hpp"
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
constexpr double largest_delta = 1e4;  // of a start anew: what is minimised does not depend on the determinant
constexpr int layers_of_few = 2;  // around up to 1 % of all elements, in which nodes slide
constexpr int most_deltas = 100, steps_of_first_delta = 100, steps_of_delta = 5, steps_of_barrier = 20;

using Moves = std::vector<char>;  // per node

struct Ideal {
    std::unique_ptr<DistortionEnergy> energy;
    std::vector<double> volume;  // per element
};

struct Untangling {
    const Problem& problem_;
    const LinearSolverParams& linear_;
    const std::vector<Ideal> ideals_;  // in the order in which they are tried
    std::vector<double>& x_;
    const Mesh& mesh_ = problem_.mesh();
    Constraint& constraint_ = *problem_.level->constraint;

    const Moves held_ = held_nodes(mesh_, problem_.target);  // per node: whether the boundary does not leave it free
    const std::vector<int> directions_ = held_directions(constraint_, x_, mesh_.dim);  // before any node moves
    const Ideal* ideal_ = nullptr;
    double penalty_ = 0;
    Moves fixed_ = Moves(mesh_.nodes(), 0);
    std::vector<ReferenceElement> reference_ = {};  // by group of elements
    UntanglingResult result_ = {};
    bool anew_ = false;

    UntanglingResult run() {
        for (const ElementGroup& group : mesh_.element_groups())
            reference_.push_back(
                reference_element(*group.cell, mesh_.degree, element_quadrature(*group.cell, mesh_.degree, 0)));
        find_left();
        untangle_all(false);
        if (100 * result_.left.size() > static_cast<std::size_t>(mesh_.element_count())) untangle_all(true);
        return std::move(result_);
    }

    // anew: from positions that do not depend on where the nodes are.
    void untangle_all(bool anew) {
        anew_ = anew;
        int before = 0;  // nodes that could move in the last round
        for (int layers = 1; !result_.left.empty() && !interrupted(); layers *= 2) {
            int count = 0;
            const std::size_t invalid = result_.left.size();
            for (const bool slide : {false, true}) {
                const bool are_few = 100 * std::ssize(result_.left) <= mesh_.element_count();
                if (slide && (!can_slide() || result_.left.empty() || (are_few && layers > layers_of_few))) break;
                fix_boundary(slide);
                for (const auto& [first, nodes] : regions(layers, slide)) {
                    Moves moves(mesh_.nodes(), 0);
                    for (const int i : nodes) moves[i] = 1;
                    count += static_cast<int>(nodes.size());
                    const auto untangles = [&](const Ideal& ideal) {
                        ideal_ = &ideal;
                        return slide ? untangle_sliding(moves) : untangle(moves, x_);
                    };
                    result_.regions += std::any_of(ideals_.begin(), ideals_.end(), untangles);
                }
                find_left();
            }
            if (count == before && result_.left.size() == invalid) break;  // there is no more room
            before = count;
        }
    }

    void find_left() {
        result_.left = certify(mesh_, x_).uncertified;
        std::erase_if(result_.left, [&](int e) { return !problem_.is_feasible(e); });
    }

    bool slides(int i) const { return !directions_.empty() && directions_[i] > 0 && directions_[i] < mesh_.dim; }
    bool can_slide() const {
        for (int i = 0; i < mesh_.nodes(); ++i)
            if (slides(i)) return true;
        return false;
    }

    // All nodes of the boundary but for free ones; or without those that slide. Those of periodic sides stay.
    void fix_boundary(bool slide) {
        for (const int i : constraint_.nodes()) fixed_[i] = held_[i] && !(slide && slides(i));
        for (const auto& pair : problem_.level->pairs.pairs) fixed_[pair.slave] = fixed_[pair.master] = 1;
    }

    std::unique_ptr<LocalFunctional> part(const std::vector<double>& x, const Moves& moves) const {
        const std::vector<double> lambda(constraint_.multipliers(), 0.0);
        return AugmentedFunctional(*ideal_->energy, constraint_, lambda, penalty_, fixed_).part(x, moves);
    }

    void project(const Moves& moves, std::vector<double>& x) const {
        const std::vector<int>& nodes = constraint_.nodes();
        const std::vector<double> targets = constraint_.targets(x);
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
            penalty_ = penalty * std::pow(constraint_.norm_of_one(), 2);
            if (untangle(moves, x)) project(moves, x);
        }
        penalty_ = 0;
        if (!is_valid(moves, x) || is_folded(moves, x)) return false;
        minimise_inside(moves, x);
        minimise_inside(put_back(moves, x_, x), x);
        x_ = x;
        return true;
    }

    void minimise_inside(const Moves& moves, std::vector<double>& x) {
        fix_boundary(false);
        minimise(moves, x);
        fix_boundary(true);
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
        for (int i = 0; i < mesh_.nodes(); ++i) near[i] = near[i] && !fixed_[i];
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
            if (!problem_.is_feasible(e)) continue;
            const ReferenceElement& reference = reference_[mesh_.group_number(e)];
            const double ideal = ideal_->volume[e] / reference.cell->volume();
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
        return is_valid(*part(x, moves), restriction_to(moves, mesh_).element, x);
    }

    // Of the nodes of the region, valid at x, those that have moved least since `from` go back, as many as leave no
    // element much more distorted than in both; returns the others.
    Moves put_back(Moves moves, const std::vector<double>& from, std::vector<double>& x) {
        constexpr double harmless = 1.2, more = 1.2;  // distortion; that of x times this
        const std::unique_ptr<LocalFunctional> local = part(x, moves);
        const std::vector<int> elements = restriction_to(moves, mesh_).element;
        local->distortion.set_delta(0);
        const std::vector<double> before = local->statistics(local->read(from)).element_max;
        std::vector<double> most = local->statistics(local->read(x)).element_max;
        for (std::size_t e = 0; e < most.size(); ++e)
            most[e] = std::max({harmless, more * most[e], std::isfinite(before[e]) ? before[e] : 0.0});
        const auto squared_distance = [&](const std::vector<double>& a, int i, const std::vector<double>& b, int j) {
            const Vec<3> way = at_node(a, i, mesh_.dim) - at_node(b, j, mesh_.dim);
            return dot(way, way);
        };
        std::vector<double> size(mesh_.nodes(), std::numeric_limits<double>::infinity());  // squared: shortest edge
        for (const int e : elements)
            for (const auto [v, w] : mesh_.cell(e).edges) {
                const int i = mesh_.element(e)[v], j = mesh_.element(e)[w];
                const double squared = squared_distance(x, i, x, j);
                size[i] = std::min(size[i], squared);
                size[j] = std::min(size[j], squared);
            }
        std::vector<std::pair<double, int>> by_distance;
        for (int i = 0; i < mesh_.nodes(); ++i)
            if (moves[i]) by_distance.push_back({squared_distance(x, i, from, i) / size[i], i});
        std::sort(by_distance.begin(), by_distance.end());
        std::size_t good = 0, bad = by_distance.size() + 1;
        std::vector<double> y, best = x;
        while (bad - good > 1) {
            const std::size_t count = (good + bad) / 2;
            y = x;
            for (std::size_t k = 0; k < count; ++k)
                std::copy_n(point(from, by_distance[k].second, mesh_.dim), mesh_.dim,
                            point(y, by_distance[k].second, mesh_.dim));
            const std::vector<double> now = local->statistics(local->read(y)).element_max;
            const bool is_good = std::equal(now.begin(), now.end(), most.begin(), std::less_equal<>()) &&
                                 is_valid(*local, elements, y);
            (is_good ? good : bad) = count;
            if (is_good) best = y;
        }
        x = best;
        for (std::size_t k = 0; k < good; ++k) moves[by_distance[k].second] = 0;
        return moves;
    }

    // Minimises the functional without regularisation from x, which is valid.
    void minimise(const Moves& moves, std::vector<double>& x) {
        bool any = false;
        for (int i = 0; i < mesh_.nodes(); ++i) any = any || (moves[i] && !fixed_[i]);
        if (!any) return;
        const std::unique_ptr<LocalFunctional> local = part(x, moves);
        local->distortion.set_delta(0);
        Newton newton(local->hessian_pattern(), linear_, NewtonPolicies::of_few_nodes());
        NewtonParams params{.omega = std::numeric_limits<double>::max(), .reduction = 0.01};
        params.max_iterations = steps_of_barrier;
        std::vector<double> y = local->read(x);
        result_.newton_iterations += newton.minimise(*local, params, y).iterations;
        local->write(y, x);
    }

    // Moves the nodes of the region in `at` where that makes it valid; whether it does.
    bool untangle(const Moves& moves, std::vector<double>& at) {
        const std::unique_ptr<LocalFunctional> local = part(at, moves);
        DistortionEnergy& distortion = local->distortion;
        std::vector<double> y = local->read(at), x = at;
        const std::vector<int> elements = restriction_to(moves, mesh_).element;
        const auto is_valid_now = [&] { return is_valid(*local, elements, x); };
        if (is_valid_now()) return false;  // a neighbour of one that is not
        Newton newton(local->hessian_pattern(), linear_, NewtonPolicies::of_few_nodes());
        const auto minimise_with = [&](double delta, double reduction, int steps) {
            distortion.set_delta(delta);
            NewtonParams params{.omega = std::numeric_limits<double>::max(), .reduction = reduction};
            params.max_iterations = steps;
            const NewtonResult found = newton.minimise(*local, params, y);
            result_.newton_iterations += found.iterations;
            local->write(y, x);
            return std::clamp(1 - found.energy / found.start_energy, least_fall, most_fall);
        };
        if (anew_) minimise_with(largest_delta, 0.01, steps_of_first_delta);
        double D = least_determinant(elements, x), D_before = D;
        double delta = std::sqrt(first_sigma * (first_sigma - std::min(D, 0.0))), delta_before = delta;
        for (int k = 0; k < most_deltas && delta > least_delta && !is_valid_now() && !interrupted(); ++k) {
            const bool first = k == 0;  // the functional is next to convex: what comes is from near its minimum
            const double fall =
                minimise_with(delta, first ? 0.01 : 0.1, first ? steps_of_first_delta : steps_of_delta);
            D = least_determinant(elements, x);
            const double sigma = (1 - fall) * (D + std::sqrt(D * D + 4 * delta * delta)) / 2;
            delta = D < sigma ? std::sqrt(sigma * (sigma - D)) : 0.1 * delta;
            if (k > 0 && delta > 0.1 * delta_before) continue;
            if (k > 0 && delta < -0.1 * D && D < 0.9 * D_before) break;  // it stays where it is, whatever delta
            delta_before = delta;
            D_before = D;
        }
        if (!is_valid_now()) return false;
        minimise(moves, x);
        if (penalty_ == 0) minimise(put_back(moves, at, x), x);
        at = x;
        return true;
    }
};

// Per element whether it has no vertex of these.
std::vector<char> far_from(const Mesh& mesh, const std::vector<int>& elements) {
    std::vector<char> near(mesh.nodes(), 0), far(mesh.element_count(), 1);
    for (const int e : elements)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) near[mesh.element(e)[v]] = 1;
    for (const int e : restriction_to(near, mesh).element) far[e] = 0;
    return far;
}

// regular: DistortionParams::regular.
Ideal make_ideal(const Problem& problem, const std::vector<double>& regular) {
    const Mesh& mesh = problem.mesh();
    Ideal ideal{make_energy(problem, *problem.level,
                            {.objective = Objective::tangled, .curved_ideal = true, .regular = regular}), {}};
    for (int e = 0; e < mesh.element_count(); ++e)
        with_dimension(mesh.dim, [&](auto n) {
            if (regular.empty()) ideal.volume.push_back(volume(mesh, problem.ideal(), e));
            else if (regular.size() == offset(mesh.element_count(), 1)) ideal.volume.push_back(regular[e]);
            else ideal.volume.push_back(determinant(matrix_at<n()>(regular, e)) * mesh.cell(e).volume());
        });
    return ideal;
}

}  // namespace

UntanglingResult untangle(const ProblemOptions& options, Problem& problem, std::vector<int> invalid,
                          std::vector<double>& x) {
    const Mesh& mesh = problem.mesh();
    UntanglingResult all{std::move(invalid)};
    const auto leave_out = [&](const std::vector<int>& elements) {
        if (!elements.empty()) problem.infeasible.resize(mesh.element_count());
        for (const int e : elements)
            if (problem.is_feasible(e)) problem.infeasible[e] = "no positions were found at which it is valid";
        std::erase_if(all.left, [&](int e) { return !problem.is_feasible(e); });
    };
    for (std::size_t before = 0; !all.left.empty() && all.left.size() != before && !interrupted();) {
        const std::vector<char> counts = far_from(mesh, all.left);
        std::vector<Ideal> ideals;
        if (options.ideal == IdealKind::mesh) ideals.push_back(make_ideal(problem, {}));
        if (const std::vector<double> maps = local_shapes(mesh, x, counts); !maps.empty())
            ideals.push_back(make_ideal(problem, maps));
        ideals.push_back(make_ideal(problem, local_volumes(mesh, x, counts)));
        const UntanglingResult found = Untangling{problem, options.linear, std::move(ideals), x}.run();
        all = {found.left, all.regions + found.regions, all.newton_iterations + found.newton_iterations};
        before = all.left.size();
        if (before > 0)  // others are in their regions
            leave_out(elements_of(
                mesh, {{}, infeasible_elements(mesh, x, held_nodes(mesh, problem.target), flat_jacobian)}));
    }
    leave_out(std::vector(all.left));
    return all;
}

}  // namespace almesh
