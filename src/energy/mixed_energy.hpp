// The energy of a mesh with elements of several types: the sum of those of its groups of elements, each with its own
// reference element and rules. Gradient and Hessian are added one group after the other.
//
// Infeasible elements, which need not be valid, are groups of their own. Their density is eta^2 of Tangled with a fixed
// delta, finite at all positions, so that they never shorten a step. Norms and maxima are of the other elements only.
#pragma once
#include <memory>
#include <vector>

#include "energy/group_energy.hpp"

namespace almesh {

class MixedEnergy : public DistortionEnergy {
public:
    // infeasible: per element; empty: none. make: the energies of its groups; null: SimdEnergy.
    using MakeGroup = std::unique_ptr<GroupEnergy>(const Mesh&, const std::vector<double>&, const DistortionParams&);
    MixedEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params,
                const std::vector<char>& infeasible = {}, MakeGroup* make = nullptr);

    double energy(const std::vector<double>& x) override;
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                     const Projection& projection = {}) override;
    DistortionStatistics statistics(const std::vector<double>& x) override;
    std::unique_ptr<DistortionEnergy> part(const std::vector<double>& x, const std::vector<char>& moves,
                                           Restriction& around) const override;

    void set_power(const PowerParams& power) override;
    void set_delta(double delta) override;
    double valid_fraction(const std::vector<double>& x, const std::vector<double>& to) override;
    bool certified(const std::vector<double>& x) const override {
        return total([&](GroupEnergy& group) { return !group.certified(x); }) == 0;
    }
    bool refine_quadrature(const std::vector<double>& x = {}) override {
        return total([&x](GroupEnergy& group) { return group.refine_quadrature(x); }) > 0;
    }
    bool take_over_refinements(const DistortionEnergy& part) override;
    QuadratureState quadrature() const override;
    void set_quadrature(const QuadratureState& state) override;
    int refined_elements() const override {
        return static_cast<int>(total([](GroupEnergy& group) { return group.refined_elements(); }));
    }
    bool is_curved() const override {
        return total([](GroupEnergy& group) { return group.is_curved(); }) > 0;
    }
    double nodes_in_elements() const override {
        return total([](GroupEnergy& group) { return group.nodes_in_elements(); });
    }
    double hessian_work() const override {
        return total([](GroupEnergy& group) { return group.hessian_work(); });
    }

private:
    struct Group {
        std::unique_ptr<GroupEnergy> energy;  // null in a restriction without elements of the group
        bool is_infeasible;
        std::vector<int> element;  // numbers of its elements in the mesh
    };
    // A restriction of `whole`: groups[g] has elements of groups_[g] there, or none.
    MixedEnergy(const MixedEnergy& whole, std::vector<Group> groups);

    std::vector<Group> groups_;

    void join_patterns();
    void blocks_moved(const LargeVector<int>& place) override;
    // body(energy, group) for all that have elements.
    template <class Body>
    void every_group(const Body& body) const {
        for (const Group& group : groups_)
            if (group.energy) body(*group.energy, group);
    }
    template <class Value>
    double total(const Value& value) const {
        double sum = 0;
        every_group([&](GroupEnergy& energy, const Group&) { sum += value(energy); });
        return sum;
    }
};

}  // namespace almesh
