// The two assemblies of the energy of elements of one type, for tests that ask the same of both.
#pragma once
#include <memory>
#include <vector>

#include "energy/mixed_energy.hpp"
#include "lessons/plain_energy.hpp"

namespace almesh::test {

enum class Assembly { simd, plain };
inline constexpr Assembly assemblies[] = {Assembly::simd, Assembly::plain};

struct AssembledParams : DistortionParams {
    Assembly assembly = Assembly::simd;
};

inline std::unique_ptr<GroupEnergy> make_plain(const Mesh& mesh, const std::vector<double>& ideal,
                                               const DistortionParams& params) {
    return std::make_unique<PlainEnergy>(mesh, ideal, params);
}

inline MixedEnergy::MakeGroup* maker_of(Assembly assembly) {
    return assembly == Assembly::plain ? make_plain : nullptr;
}

inline std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                                     const AssembledParams& params) {
    if (params.assembly == Assembly::simd) return almesh::make_energy(mesh, ideal, params);
    if (mesh.groups.size() < 2) return make_plain(mesh, ideal, params);
    return std::make_unique<MixedEnergy>(mesh, ideal, params, std::vector<char>(), make_plain);
}

}  // namespace almesh::test
