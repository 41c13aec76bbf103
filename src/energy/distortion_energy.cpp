// What plain and SIMD assembly of the energy share: see the formulas of distortion_energy.hpp.
#include "energy/distortion_energy.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "energy/densities.hpp"
#include "energy/plain_energy.hpp"
#include "energy/simd_energy.hpp"

namespace almesh {

double DistortionEnergy::uniform(double eta) const {
    return volume_ * with_density(params_.objective, [eta](auto density) { return density.f(eta); });
}

double DistortionEnergy::mean_slope(double energy) const {
    const double mean = std::max(0.0, energy) / volume_;
    return with_density(params_.objective, [mean](auto density) { return density.half_slope(mean); });
}

std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params) {
    if (params.assembly == Assembly::plain) return std::make_unique<PlainEnergy>(mesh, ideal, params);
    return std::make_unique<SimdEnergy>(mesh, ideal, params);
}

double damping_exponent(int dim, double weight_exponent) { return std::min(1.5 / dim, weight_exponent); }

SubMesh elements_around(const std::vector<int>& elements, int count, int m, const std::vector<char>& moves) {
    SubMesh part;
    std::vector<int> number(moves.size(), -1);  // node of the mesh -> node of the part
    for (int e = 0; e < count; ++e) {
        const int* const node = &elements[offset(e, m)];
        if (std::none_of(node, node + m, [&](int i) { return moves[i]; })) continue;
        part.place.push_back(e);
        for (int i = 0; i < m; ++i) {
            int& own = number[node[i]];
            if (own < 0) {
                own = static_cast<int>(part.node.size());
                part.node.push_back(node[i]);
            }
            part.elements.push_back(own);
        }
    }
    return part;
}

}  // namespace almesh
