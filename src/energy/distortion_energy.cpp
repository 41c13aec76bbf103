// What all energies share: see the formulas of distortion_energy.hpp.
#include "energy/distortion_energy.hpp"

#include <algorithm>
#include <utility>

#include "energy/densities.hpp"
#include "energy/mixed_energy.hpp"
#include "energy/simd_energy.hpp"

namespace almesh {

BlockCsr DistortionEnergy::hessian_pattern() const {
    BlockCsr H = pattern_;
    H.set_zero();
    return H;
}

void DistortionEnergy::order_hessian(const ChooseOrder& choose) {
    auto order = choose(pattern_);
    if (!order) return;
    LargeVector<int> place;
    pattern_ = ordered_pattern(pattern_, std::move(order), place);
    blocks_moved(place);
}

void DistortionEnergy::set_pairs(const PeriodicPairs& pairs) {
    pairs_ = pairs;
    if (pairs.pairs.empty()) return;
    const BlockCsr more = pairs.pattern(pattern_);
    std::vector<LargeVector<int>> place;
    pattern_ = joint_pattern({&pattern_, &more}, place);
    blocks_moved(place[0]);
}

double DistortionEnergy::uniform(double eta) const {
    return volume_ * with_density(params_, [eta](auto density) { return density.f(eta); });
}

double DistortionEnergy::mean_slope(double energy) const {
    const double mean = std::max(0.0, energy) / volume_;
    return with_density(params_, [mean](auto density) { return density.half_slope(mean); });
}

std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params) {
    if (mesh.groups.size() > 1) return std::make_unique<MixedEnergy>(mesh, ideal, params);
    return std::make_unique<SimdEnergy>(mesh, ideal, params);
}

}  // namespace almesh
