// v_i = mean of V_e over the elements at node i,   V_e <- mean of v_i over the nodes of e: first for elements without a
// volume, layer by layer, then once for all.
#include "mesh/local_size.hpp"

#include <algorithm>
#include <numeric>

namespace almesh {
namespace {

// 0 for elements and nodes that have none yet.
std::vector<double> at_vertices(const Mesh& mesh, const std::vector<double>& of_elements) {
    std::vector<double> sum(mesh.nodes(), 0);
    std::vector<int> count(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.cell(e).vertices && of_elements[e] > 0; ++k) {
            sum[mesh.element(e)[k]] += of_elements[e];
            ++count[mesh.element(e)[k]];
        }
    for (int i = 0; i < mesh.nodes(); ++i) sum[i] /= std::max(count[i], 1);
    return sum;
}

double mean_of_vertices(const Mesh& mesh, int e, const std::vector<double>& of_vertices) {
    double sum = 0;
    int count = 0;
    for (int k = 0; k < mesh.cell(e).vertices; ++k) {
        sum += of_vertices[mesh.element(e)[k]];
        count += of_vertices[mesh.element(e)[k]] > 0;
    }
    return sum / std::max(count, 1);
}

}  // namespace

std::vector<double> local_volumes(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& valid) {
    std::vector<double> V(mesh.element_count(), 0);
    double total = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const double of = volume(mesh, x, e);
        total += of;
        if (valid[e]) V[e] = std::max(of, 0.0);
    }
    if (std::all_of(V.begin(), V.end(), [](double v) { return v == 0; })) std::fill(V.begin(), V.end(), 1);
    for (std::vector<double> before; V != before;) {  // what hangs together with no element that has one stays 0
        before = V;
        const std::vector<double> of_vertices = at_vertices(mesh, V);
        for (int e = 0; e < mesh.element_count(); ++e)
            if (V[e] == 0) V[e] = mean_of_vertices(mesh, e, of_vertices);
    }
    const std::vector<double> of_vertices = at_vertices(mesh, V);
    for (int e = 0; e < mesh.element_count(); ++e) V[e] = mean_of_vertices(mesh, e, of_vertices);
    const double sum = std::accumulate(V.begin(), V.end(), 0.0), mean = sum / mesh.element_count();
    for (double& v : V) {
        if (v == 0) v = mean;
        if (total > 0) v *= total / sum;
    }
    return V;
}

}  // namespace almesh
