#include "constraint/trace_part.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "linalg/vector_ops.hpp"

namespace almesh {

TracePart::TracePart(const TraceSpace& trace, const std::vector<double>& v, double factor,
                     const std::vector<int>& part, const BlockCsr& pattern)
    : dim_(trace.dim) {
    std::vector<int> number(trace.nodes.back() + 1, -1), entry_of(trace.count(), -1);  // mesh node, trace node -> ours
    for (std::size_t k = 0; k < part.size(); ++k)
        if (part[k] <= trace.nodes.back()) number[part[k]] = static_cast<int>(k);
    for (int t = 0; t < trace.count(); ++t) {
        const int k = number[trace.nodes[t]];
        if (k < 0) continue;
        entry_of[t] = static_cast<int>(node.size());
        node.push_back(k);
        trace_node.push_back(t);
    }
    g.resize(node.size() * dim_);
    C.n = static_cast<int>(node.size());
    C.row.assign(1, 0);
    for (int i = 0; i < C.n; ++i) {
        const int t = trace_node[i];
        with_dimension(dim_, [&](auto n) { trace.mass_times<n>(v, t, &g[offset(i, n)]); });
        for (int k = trace.M.row[t]; k < trace.M.row[t + 1]; ++k) {
            const int j = entry_of[trace.M.col[k]], found = j < 0 ? -1 : pattern.find(node[i], node[j]);
            if (found < 0) continue;  // both are fixed, at no cell in common that has a node that moves
            C.col.push_back(j);
            C.value.push_back(factor * trace.M.value[k]);
            block.push_back(found);
        }
        C.row.push_back(C.blocks());
    }
}

void TracePart::set_force(const std::vector<double>& u, std::vector<double>& force) const {
    force.resize(g.size());
    with_dimension(dim_, [&](auto n) {
        for (int i = 0; i < C.n; ++i) {
            Vec<n> sum;
            std::copy_n(&g[offset(i, n)], n(), sum.begin());
            for (int k = C.row[i]; k < C.row[i + 1]; ++k)
                for (int a = 0; a < n; ++a) sum[a] += C.value[k] * u[offset(C.col[k], n, a)];
            std::copy_n(sum.begin(), n(), &force[offset(i, n)]);
        }
    });
}

double TracePart::value(const std::vector<double>& u, std::vector<double>& force) const {
    set_force(u, force);
    return 0.5 * (dot(g, u) + dot(force, u));
}

}  // namespace almesh
