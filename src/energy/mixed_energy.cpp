#include "energy/mixed_energy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "energy/simd_energy.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

constexpr double delta_of_infeasible = 0.5;  // of elements that need not be valid

std::unique_ptr<GroupEnergy> energy_of(const Mesh& mesh, const std::vector<int>& elements,
                                       const std::vector<double>& ideal, DistortionParams params, bool is_infeasible,
                                       MixedEnergy::MakeGroup* make) {
    std::vector<double> regular;
    const std::size_t stride = params.regular.size() / mesh.element_count();
    for (const int e : elements)
        for (std::size_t k = 0; k < stride; ++k) regular.push_back(params.regular[offset(e, stride, k)]);
    params.regular = std::move(regular);
    if (is_infeasible) {
        params.objective = Objective::tangled;
        params.delta = delta_of_infeasible;
        params.power = {};
    }
    const Mesh group = of_one_type(mesh, elements);
    return make ? make(group, ideal, params) : std::make_unique<SimdEnergy>(group, ideal, params);
}

}  // namespace

// With the weights w_e = u_g |e|^(alpha - 1) of each group g, for which sum w_e |e| is its volume, the same unit u for
// all groups is |Omega| over the sum of (volume of g) / u_g.
MixedEnergy::MixedEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params,
                         const std::vector<char>& infeasible, MakeGroup* make)
    : DistortionEnergy(params, mesh.dim) {
    std::array<double, 2> sum{};
    for (const ElementGroup& cells : mesh.element_groups())
        for (const bool is_infeasible : {false, true}) {
            std::vector<int> elements = elements_of(cells);
            std::erase_if(elements, [&](int e) {
                return is_infeasible != (!infeasible.empty() && infeasible[e]);
            });
            if (elements.empty()) continue;
            auto energy = energy_of(mesh, elements, ideal, params, is_infeasible, make);
            volume_ += energy->domain_volume();
            for (int k = 0; k < 2; ++k) sum[k] += energy->domain_volume() / energy->weight_units()[k];
            groups_.push_back({std::move(energy), is_infeasible, std::move(elements)});
        }
    every_group([&](GroupEnergy& group, const Group&) {
        const std::array<double, 2>& unit = group.weight_units();
        group.scale_weights({volume_ / (sum[0] * unit[0]), volume_ / (sum[1] * unit[1])});
    });
    join_patterns();
}

MixedEnergy::MixedEnergy(const MixedEnergy& whole, std::vector<Group> groups)
    : DistortionEnergy(whole.params_, whole.dim_), groups_(std::move(groups)) {
    volume_ = total([](GroupEnergy& group) { return group.domain_volume(); });
    join_patterns();
}

void MixedEnergy::join_patterns() {
    std::vector<const BlockCsr*> patterns;
    every_group([&](GroupEnergy& group, const Group&) { patterns.push_back(&group.pattern()); });
    std::vector<LargeVector<int>> place;
    pattern_ = joint_pattern(patterns, place);
    std::size_t k = 0;
    every_group([&](GroupEnergy& group, const Group&) { group.use_pattern_of_mesh(place[k++]); });
}

void MixedEnergy::blocks_moved(const LargeVector<int>& place) {
    every_group([&](GroupEnergy& group, const Group&) { group.blocks_moved(place); });
}

double MixedEnergy::energy(const std::vector<double>& x) {
    return total([&](GroupEnergy& group) { return group.energy(x); });
}

void MixedEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) {
    every_group([&](GroupEnergy& group, const Group&) { group.add_gradient(x, g); });
}

void MixedEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                              const Projection& projection) {
    every_group([&](GroupEnergy& group, const Group&) { group.add_hessian(x, kind, H, projection); });
}

DistortionStatistics MixedEnergy::statistics(const std::vector<double>& x) {
    DistortionStatistics all;
    std::size_t count = 0;
    for (const Group& group : groups_) count += group.element.size();
    all.element_max.resize(count);
    double volume = 0, squared_norm = 0;  // |M phi|^2
    every_group([&](GroupEnergy& energy, const Group& group) {
        const DistortionStatistics local = energy.statistics(x);
        for (std::size_t k = 0; k < group.element.size(); ++k) all.element_max[group.element[k]] = local.element_max[k];
        if (group.is_infeasible) return;
        volume += energy.domain_volume();
        squared_norm += energy.domain_volume() / (local.relative_quality * local.relative_quality);
        all.max_distortion = std::max(all.max_distortion, local.max_distortion);
    });
    all.relative_quality = std::sqrt(volume / squared_norm);
    return all;
}

std::unique_ptr<DistortionEnergy> MixedEnergy::part(const std::vector<double>& x, const std::vector<char>& moves,
                                                    Restriction& around) const {
    std::vector<CellNodes> cells;
    every_group([&](GroupEnergy& group, const Group&) { cells.push_back(group.cell_nodes()); });
    around = restriction_to(moves, cells);
    std::vector<Group> groups;
    auto element = around.element.begin();
    auto node = around.elements.begin();
    int first = 0;  // of the group's elements, here
    for (const Group& group : groups_) {
        groups.push_back({nullptr, group.is_infeasible, {}});
        if (!group.energy) continue;
        const CellNodes all = group.energy->cell_nodes();
        Restriction of_group{around.moving, around.node, {}, {}};
        for (; element != around.element.end() && *element < first + all.count; ++element, node += all.m) {
            groups.back().element.push_back(static_cast<int>(element - around.element.begin()));
            of_group.element.push_back(*element - first);
            of_group.elements.insert(of_group.elements.end(), node, node + all.m);
        }
        first += all.count;
        if (!of_group.element.empty()) groups.back().energy = group.energy->part(x, of_group);
    }
    return std::unique_ptr<MixedEnergy>(new MixedEnergy(*this, std::move(groups)));
}

void MixedEnergy::set_power(const PowerParams& power) {
    DistortionEnergy::set_power(power);
    every_group([&](GroupEnergy& energy, const Group& group) {
        if (!group.is_infeasible) energy.set_power(power);
    });
}

void MixedEnergy::set_delta(double delta) {
    DistortionEnergy::set_delta(delta);
    every_group([&](GroupEnergy& energy, const Group& group) {
        if (!group.is_infeasible) energy.set_delta(delta);
    });
}

double MixedEnergy::valid_fraction(const std::vector<double>& x, const std::vector<double>& to) {
    double fraction = 1;
    every_group([&](GroupEnergy& group, const Group&) { fraction = std::min(fraction, group.valid_fraction(x, to)); });
    return fraction;
}

bool MixedEnergy::take_over_refinements(const DistortionEnergy& part) {
    const auto& of_part = static_cast<const MixedEnergy&>(part).groups_;
    bool changed = false;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        if (of_part[g].energy) changed = groups_[g].energy->take_over_refinements(*of_part[g].energy) || changed;
    return changed;
}

QuadratureState MixedEnergy::quadrature() const {
    QuadratureState all;
    every_group([&](const GroupEnergy& energy, const Group& group) {
        QuadratureState of_group = energy.quadrature();
        for (const auto list : {&QuadratureState::refinements, &QuadratureState::inversions})
            for (Inversion inversion : of_group.*list) {
                inversion.element = group.element[inversion.element];
                (all.*list).push_back(inversion);
            }
    });
    return all;
}

void MixedEnergy::set_quadrature(const QuadratureState& state) {
    every_group([&](GroupEnergy& energy, const Group& group) {
        QuadratureState of_group;
        for (const auto list : {&QuadratureState::refinements, &QuadratureState::inversions})
            for (Inversion inversion : state.*list) {
                const auto place = std::lower_bound(group.element.begin(), group.element.end(), inversion.element);
                if (place == group.element.end() || *place != inversion.element) continue;
                inversion.element = static_cast<int>(place - group.element.begin());
                (of_group.*list).push_back(inversion);
            }
        energy.set_quadrature(of_group);
    });
}

}  // namespace almesh
