// set(nodes) = all at once if valid, else set(first half), set(second half).
#include "method/snap.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace almesh {
namespace {

constexpr int most_tries = 1000;

}  // namespace

int snap_to_targets(DistortionEnergy& distortion, const Constraint& constraint, std::vector<double>& x,
                    const std::vector<char>& chosen) {
    std::vector<int> nodes = constraint.nodes();
    std::vector<double> targets = constraint.targets(x);
    const int dim = nodes.empty() ? 0 : static_cast<int>(targets.size() / nodes.size());
    std::size_t count = 0;
    for (std::size_t t = 0; t < nodes.size() && dim > 0; ++t) {
        if (!chosen.empty() && !chosen[nodes[t]]) continue;
        std::copy_n(&targets[offset(t, dim)], dim, &targets[offset(count, dim)]);
        nodes[count++] = nodes[t];
    }
    nodes.resize(count);
    int tries = 0;
    std::vector<double> trial = x;
    const auto set = [&](const auto& self, int first, int end) -> void {
        if (first == end || tries == most_tries) return;
        ++tries;
        for (int t = first; t < end; ++t) std::copy_n(&targets[offset(t, dim)], dim, point(trial, nodes[t], dim));
        if (std::isfinite(distortion.energy(trial)) && distortion.valid_fraction(x, trial) == 1) {
            x = trial;
            return;
        }
        for (int t = first; t < end; ++t) std::copy_n(point(x, nodes[t], dim), dim, point(trial, nodes[t], dim));
        const int middle = first + (end - first) / 2;
        if (middle == first) return;
        self(self, first, middle);
        self(self, middle, end);
    };
    set(set, 0, dim == 0 ? 0 : static_cast<int>(nodes.size()));
    return nodes_off_target(constraint, x);
}

int nodes_off_target(const Constraint& constraint, const std::vector<double>& x) {
    const std::vector<char> off = constraint.off_target(x);
    return static_cast<int>(std::count(off.begin(), off.end(), 1));
}

}  // namespace almesh
