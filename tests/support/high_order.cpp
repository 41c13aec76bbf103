#include "support/high_order.hpp"

#include <map>

#include "mesh/lagrange.hpp"

namespace almesh::test {

Mesh with_degree(const Mesh& linear, int degree) {
    Mesh mesh = linear;
    mesh.degree = degree;
    mesh.elements.clear();
    mesh.faces.clear();
    std::map<std::map<int, int>, int> known;  // vertex -> barycentric index of it, zeros left out
    const auto append_nodes = [&](const int* vertex, int dim, std::vector<int>& out) {
        for (const MultiIndex& a : gmsh_node_order(dim, degree)) {
            std::map<int, int> key;
            for (int k = 0; k <= dim; ++k)
                if (a[k] > 0) key[vertex[k]] = a[k];
            const auto [place, added] = known.insert({key, mesh.nodes()});
            if (key.size() == 1) place->second = key.begin()->first;
            else if (added)
                for (int c = 0; c < mesh.dim; ++c) {
                    double position = 0;
                    for (const auto& [v, weight] : key) position += weight * linear.x[v * mesh.dim + c];
                    mesh.x.push_back(position / degree);
                }
            out.push_back(place->second);
        }
    };
    for (int e = 0; e < linear.element_count(); ++e) append_nodes(linear.element(e), mesh.dim, mesh.elements);
    for (int f = 0; f < linear.face_count(); ++f) append_nodes(linear.face(f), mesh.dim - 1, mesh.faces);
    mesh.file.node_id.clear();
    for (int i = 0; i < mesh.nodes(); ++i) mesh.file.node_id.push_back(i + 1);
    return mesh;
}

std::vector<double> mapped(const Mesh& mesh, const std::function<void(double*)>& map) {
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i) map(&x[static_cast<std::size_t>(i) * mesh.dim]);
    return x;
}

std::vector<double> on_faces(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<double> target;
    for (int node : mesh.faces)
        for (int c = 0; c < mesh.dim; ++c) target.push_back(x[static_cast<std::size_t>(node) * mesh.dim + c]);
    return target;
}

}  // namespace almesh::test
