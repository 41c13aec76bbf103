// A constraint under which no minimisation ends: instead of holding the boundary it pulls all nodes the same way, so
// that the mesh moves on and on as a whole.
#pragma once
#include <memory>
#include <vector>

#include "constraint/dirichlet.hpp"
#include "energy/distortion_energy.hpp"
#include "method/continuation.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

namespace almesh::test {

class Endless : public Dirichlet {
public:
    using Dirichlet::Dirichlet;

    double value(const std::vector<double>& x, const std::vector<double>&, double) override {
        double sum = 0;
        for (const double v : x) sum -= v;
        return sum;
    }
    void add_gradient(const std::vector<double>&, const std::vector<double>&, double, std::vector<double>& g) override {
        for (double& v : g) v -= 1;
    }
    void add_hessian(const std::vector<double>&, const std::vector<double>&, double, bool, BlockCsr& H) override {
        for (int i = 0; i < H.n; ++i)
            for (int a = 0; a < H.d; ++a) H.block(H.find(i, i))[a * H.d + a] += 1;
    }
};

// With a motion that can be followed.
inline std::unique_ptr<Level> endless_level() {
    auto level = std::make_unique<Level>();
    level->mesh = ring_mesh(6, 2, 3);
    level->ideal = level->mesh.x;
    level->energy = make_energy(level->mesh, level->ideal, {.objective = Objective::squared});
    const auto constraint = [at = level.get()] {
        const BoundaryTarget target = target_of(at->mesh, {{"inner", "translate 0.1 0"}});
        return std::make_unique<Endless>(at->mesh, at->ideal, target, TargetKind::least_squares);
    };
    level->constraint = constraint();
    level->constraint_at = [constraint](double) { return constraint(); };
    return level;
}

}  // namespace almesh::test
