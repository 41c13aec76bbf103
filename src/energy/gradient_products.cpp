#include "energy/gradient_products.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

#include "base/index.hpp"
#include "geometry/bezier.hpp"
#include "mesh/cells.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {

GradientProducts::GradientProducts(int n, int degree)
    : nodes(simplex_node_count(n, degree)),
      moments(simplex_node_count(n, 2 * degree - 2)),
      pairs((n + 1) * (n + 2) / 2) {
    const Bernstein powers(n, degree);
    std::map<MultiIndex, int> moment;
    for (const MultiIndex& c : gmsh_node_order(n, 2 * degree - 2)) moment.insert({c, static_cast<int>(moment.size())});
    for (int i = 0; i < nodes; ++i)
        for (int j = 0; j <= i; ++j) {
            const MultiIndex &a = powers.index[i], &b = powers.index[j];
            for (int v = 0; v <= n; ++v)
                for (int w = 0; w <= n; ++w) {
                    if (a[v] * b[w] == 0) continue;
                    MultiIndex c{};
                    for (std::size_t k = 0; k < c.size(); ++k) c[k] = a[k] + b[k];
                    --c[v];
                    --c[w];
                    const auto [low, high] = std::minmax(v, w);
                    term.push_back({moment.at(c), upper_place(n + 1, low, high), v > w,
                                    static_cast<double>(a[v] * b[w])});
                }
            term_start.push_back(static_cast<int>(term.size()));
        }
    const std::vector<double> bezier = bezier_of_lagrange(LagrangeBasis(n, degree));
    for (int i = 0; i < nodes; ++i) {
        for (int a = 0; a < nodes; ++a) {
            const double value = bezier[offset(a, nodes, i)] * powers.multinomial[a];
            if (value != 0) entry.push_back({a, value});
        }
        entry_start.push_back(static_cast<int>(entry.size()));
    }
}

}  // namespace almesh
