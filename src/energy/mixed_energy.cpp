#include "energy/mixed_energy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace almesh {
namespace {

std::unique_ptr<GroupEnergy> energy_of(const Mesh& mesh, const ElementGroup& group, const std::vector<double>& ideal,
                                       DistortionParams params) {
    if (!params.regular.empty())
        params.regular = {params.regular.begin() + group.first, params.regular.begin() + group.first + group.count};
    auto energy = make_energy(of_one_type(mesh, group), ideal, params);
    return std::unique_ptr<GroupEnergy>(static_cast<GroupEnergy*>(energy.release()));
}

}  // namespace

// With the weights w_e = u_g |e|^(alpha - 1) of each group g, for which sum w_e |e| is its volume, the same unit u for
// all groups is |Omega| over the sum of (volume of g) / u_g.
MixedEnergy::MixedEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : DistortionEnergy(params, mesh.dim) {
    std::array<double, 2> sum{};
    for (const ElementGroup& of : mesh.groups) {
        groups_.push_back(energy_of(mesh, of, ideal, params));
        volume_ += groups_.back()->domain_volume();
        for (int k = 0; k < 2; ++k) sum[k] += groups_.back()->domain_volume() / groups_.back()->weight_units()[k];
    }
    every_group([&](GroupEnergy& group, int) {
        const std::array<double, 2>& unit = group.weight_units();
        group.scale_weights({volume_ / (sum[0] * unit[0]), volume_ / (sum[1] * unit[1])});
    });
    join_patterns();
}

MixedEnergy::MixedEnergy(const MixedEnergy& whole, std::vector<std::unique_ptr<GroupEnergy>> groups)
    : DistortionEnergy(whole.params_, whole.dim_), groups_(std::move(groups)) {
    volume_ = total([](GroupEnergy& group) { return group.domain_volume(); });
    join_patterns();
}

void MixedEnergy::join_patterns() {
    std::vector<const BlockCsr*> patterns;
    every_group([&](GroupEnergy& group, int) { patterns.push_back(&group.pattern()); });
    std::vector<LargeVector<int>> place;
    pattern_ = joint_pattern(patterns, place);
    std::size_t k = 0;
    every_group([&](GroupEnergy& group, int) { group.use_pattern_of_mesh(place[k++]); });
}

void MixedEnergy::blocks_moved(const LargeVector<int>& place) {
    every_group([&](GroupEnergy& group, int) { group.blocks_moved(place); });
}

double MixedEnergy::energy(const std::vector<double>& x) {
    return total([&](GroupEnergy& group) { return group.energy(x); });
}

void MixedEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) {
    every_group([&](GroupEnergy& group, int) { group.add_gradient(x, g); });
}

void MixedEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                              const Projection& projection) {
    every_group([&](GroupEnergy& group, int) { group.add_hessian(x, kind, H, projection); });
}

DistortionStatistics MixedEnergy::statistics(const std::vector<double>& x) {
    DistortionStatistics all;
    double squared_norm = 0;  // |M phi|^2
    every_group([&](GroupEnergy& group, int) {
        const DistortionStatistics of = group.statistics(x);
        squared_norm += group.domain_volume() / (of.relative_quality * of.relative_quality);
        all.max_distortion = std::max(all.max_distortion, of.max_distortion);
        all.element_max.insert(all.element_max.end(), of.element_max.begin(), of.element_max.end());
    });
    all.relative_quality = std::sqrt(volume_ / squared_norm);
    return all;
}

std::unique_ptr<DistortionEnergy> MixedEnergy::part(const std::vector<double>& x, const std::vector<char>& moves,
                                                    std::vector<int>& node) const {
    std::vector<CellNodes> cells;
    every_group([&](GroupEnergy& group, int) { cells.push_back(group.cell_nodes()); });
    std::vector<SubMesh> chosen = elements_around(cells, moves);
    node = chosen.front().node;
    std::vector<std::unique_ptr<GroupEnergy>> groups;
    for (std::size_t g = 0, k = 0; g < groups_.size(); ++g) {
        groups.emplace_back();
        if (!groups_[g]) continue;
        if (!chosen[k].place.empty()) groups.back() = groups_[g]->part(x, chosen[k]);
        ++k;
    }
    return std::unique_ptr<MixedEnergy>(new MixedEnergy(*this, std::move(groups)));
}

void MixedEnergy::set_power(const PowerParams& power) {
    DistortionEnergy::set_power(power);
    every_group([&](GroupEnergy& group, int) { group.set_power(power); });
}

void MixedEnergy::set_delta(double delta) {
    DistortionEnergy::set_delta(delta);
    every_group([&](GroupEnergy& group, int) { group.set_delta(delta); });
}

double MixedEnergy::valid_fraction(const std::vector<double>& x, const std::vector<double>& to) {
    double fraction = 1;
    every_group([&](GroupEnergy& group, int) { fraction = std::min(fraction, group.valid_fraction(x, to)); });
    return fraction;
}

bool MixedEnergy::take_over_refinements(const DistortionEnergy& part) {
    const auto& of_part = static_cast<const MixedEnergy&>(part).groups_;
    bool changed = false;
    for (std::size_t g = 0; g < groups_.size(); ++g)
        if (of_part[g]) changed = groups_[g]->take_over_refinements(*of_part[g]) || changed;
    return changed;
}

QuadratureState MixedEnergy::quadrature() const {
    QuadratureState all;
    every_group([&](const GroupEnergy& group, int first) {
        QuadratureState of = group.quadrature();
        for (const auto list : {&QuadratureState::refinements, &QuadratureState::inversions})
            for (Inversion inversion : of.*list) {
                inversion.element += first;
                (all.*list).push_back(inversion);
            }
    });
    return all;
}

void MixedEnergy::set_quadrature(const QuadratureState& state) {
    every_group([&](GroupEnergy& group, int first) {
        QuadratureState of;
        for (const auto list : {&QuadratureState::refinements, &QuadratureState::inversions})
            for (Inversion inversion : state.*list) {
                inversion.element -= first;
                if (inversion.element >= 0 && inversion.element < group.element_count())
                    (of.*list).push_back(inversion);
            }
        group.set_quadrature(of);
    });
}

}  // namespace almesh
