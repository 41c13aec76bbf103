#include "app/untangling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/disjoint_sets.hpp"
#include "base/interrupt.hpp"
#include "check/certificate.hpp"
#include "mesh/part.hpp"
#include "mesh/quadrature.hpp"
#include "method/local_functional.hpp"
#include "method/newton.hpp"

namespace almesh {
namespace {

constexpr double first_sigma = 1;  // of the least determinant
constexpr double least_fall = 0.1, most_fall = 0.5;  // s
constexpr double least_delta = 1e-9;
constexpr int most_deltas = 100, steps_of_delta = 5, steps_of_barrier = 20;

using Moves = std::vector<char>;  // per node

class Untangling {
public:
    Untangling(const Mesh& mesh, const std::vector<double>& volume, DistortionEnergy& energy, Constraint& constraint,
               const LinearSolverParams& linear, std::vector<double>& x)
        : mesh_(mesh), volume_(volume), linear_(linear), x_(x),
          E_(energy, constraint, std::vector<double>(constraint.multipliers(), 0.0), 0, Moves(mesh.nodes(), 0)) {
        for (const int i : constraint.nodes()) E_.fixed[i] = 1;
        for (const ElementGroup& group : mesh.element_groups())
            reference_.push_back(
                reference_element(*group.cell, mesh.degree, element_quadrature(*group.cell, mesh.degree, 0)));
    }

    UntanglingResult run() {
        result_.left = certify(mesh_, x_).uncertified;
        int before = 0;  // nodes that could move in the last round
        for (int layers = 1; !result_.left.empty() && !interrupted(); layers *= 2) {
            int count = 0;
            for (const auto& [first, nodes] : regions(layers)) {
                Moves moves(mesh_.nodes(), 0);
                for (const int i : nodes) moves[i] = 1;
                count += static_cast<int>(nodes.size());
                result_.regions += untangle(moves);
            }
            const std::size_t invalid = result_.left.size();
            result_.left = certify(mesh_, x_).uncertified;
            if (count == before && result_.left.size() == invalid) break;  // there is no more room
            before = count;
        }
        return std::move(result_);
    }

private:
    const Mesh& mesh_;
    const std::vector<double>& volume_;
    const LinearSolverParams& linear_;
    std::vector<double>& x_;
    AugmentedFunctional E_;
    std::vector<ReferenceElement> reference_;  // by group of elements
    UntanglingResult result_;

    template <class Body>
    void for_nodes(int e, const Body& body) const {
        for (int k = 0; k < mesh_.element_nodes(e); ++k) body(mesh_.element(e)[k]);
    }

    // The nodes of inverted elements and of so many layers around them, in sets that have no element in common.
    std::map<int, std::vector<int>> regions(int layers) const {
        Moves near(mesh_.nodes(), 0);
        for (const int e : result_.left) for_nodes(e, [&](int i) { near[i] = 1; });
        for (int layer = 0; layer < layers; ++layer)
            for (const int e : elements_around(mesh_, near).place) for_nodes(e, [&](int i) { near[i] = 1; });
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
            const ReferenceElement& reference = reference_[mesh_.group_number(e)];
            const double ideal = volume_[e] / reference.cell->volume();
            with_dimension(mesh_.dim, [&](auto n) {
                for (int q = 0; q < reference.points; ++q)
                    least = std::min(least, determinant(jacobian_at<n()>(mesh_.element(e), x, reference, q)) / ideal);
            });
        }
        return least;
    }

    // Whether the region is valid now.
    bool untangle(const Moves& moves) {
        const std::unique_ptr<LocalFunctional> local = E_.part(x_, moves);
        DistortionEnergy& distortion = local->distortion;
        std::vector<double> y = local->read(x_), x = x_;
        const auto is_valid = [&] {
            distortion.set_delta(0);
            return std::isfinite(local->energy(y)) && local->valid_fraction(y, y) == 1;
        };
        if (is_valid()) return false;  // a neighbour of one that is not
        Newton newton(local->hessian_pattern(), linear_,
                      {.damping = Damping::none(),
                       .filtering = EigenvalueFiltering::of_few_nodes(),
                       .elimination = LocalElimination(LocalElimination::Of::nothing)});
        const auto minimise = [&](double reduction, int steps) {
            NewtonParams params{.omega = std::numeric_limits<double>::max(), .reduction = reduction};
            params.max_iterations = steps;
            const NewtonResult found = newton.minimise(*local, params, y);
            result_.newton_iterations += found.iterations;
            local->write(y, x);
            return std::max(least_fall, 1 - found.energy / found.start_energy);
        };
        const std::vector<int> elements = elements_around(mesh_, moves).place;
        double D = least_determinant(elements, x);
        double delta = std::sqrt(first_sigma * (first_sigma - std::min(D, 0.0)));
        for (int k = 0; k < most_deltas && delta > least_delta && !is_valid() && !interrupted(); ++k) {
            distortion.set_delta(delta);
            const double fall = std::min(most_fall, minimise(0.1, steps_of_delta));
            D = least_determinant(elements, x);
            const double sigma = (1 - fall) * (D + std::sqrt(D * D + 4 * delta * delta)) / 2;
            delta = D < sigma ? std::sqrt(sigma * (sigma - D)) : 0.1 * delta;
        }
        if (!is_valid()) return false;
        minimise(0.01, steps_of_barrier);
        x_ = x;
        return true;
    }
};

}  // namespace

UntanglingResult untangle_regions(const Mesh& mesh, const std::vector<double>& volume, DistortionEnergy& energy,
                                  Constraint& constraint, const LinearSolverParams& linear, std::vector<double>& x) {
    return Untangling(mesh, volume, energy, constraint, linear, x).run();
}

}  // namespace almesh
