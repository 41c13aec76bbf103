// The mesh of the vertices, and meshes of other degrees. New nodes are numbered in the order in which the elements meet
// them. A node is identified by the vertices of the edge, face or element it lies in and its barycentric coordinates there.
#include <unordered_map>

#include "mesh/kept_cells.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/node_key.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// A new degree or number of vertices: where the nodes of each group begin.
void start_groups(std::vector<ElementGroup>& groups, int degree) {
    std::size_t start = 0;
    for (ElementGroup& group : groups) {
        group.start = start;
        start += offset(group.count, group.cell->node_count(degree));
    }
}

}  // namespace

Mesh linear_part(const Mesh& mesh) {
    Mesh linear = mesh;
    linear.degree = 1;
    if (mesh.degree > 1) linear.file.leave_file();
    linear.x.clear();
    linear.file.node_id.clear();
    linear.elements.clear();
    for (int e = 0; e < mesh.element_count(); ++e)
        linear.elements.insert(linear.elements.end(), mesh.element(e), mesh.element(e) + mesh.cell(e).vertices);
    std::vector<int> index(mesh.nodes(), -1);
    for (const int node : linear.elements) index[node] = 0;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (index[i] < 0) continue;
        index[i] = linear.nodes();
        linear.file.node_id.push_back(mesh.file.node_id[i]);
        linear.x.insert(linear.x.end(), point(mesh.x, i, mesh.dim), point(mesh.x, i, mesh.dim) + mesh.dim);
    }
    for (int& node : linear.elements) node = index[node];
    start_groups(linear.groups, 1);
    start_groups(linear.groups_of_faces, 1);
    linear.faces.clear();
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const int node : mesh.face_vertices(f)) linear.faces.push_back(index[node]);
    restrict_kept_cells(mesh, index, linear);
    return linear;
}

Mesh raise_degree(const Mesh& mesh, int degree) {
    if (degree < mesh.degree)
        throw InputError("cannot lower the degree of the mesh from ", mesh.degree, " to ", degree);
    return interpolated(mesh, degree);
}

Mesh interpolated(const Mesh& mesh, int degree) {
    if (degree == mesh.degree) return mesh;
    const int dim = mesh.dim;
    check_size(mesh, degree, 1, "degree");
    const Mesh linear = linear_part(mesh);
    Mesh raised = linear;
    raised.file.leave_file();
    raised.degree = degree;
    raised.elements.clear();
    std::unordered_map<NodeKey, int, NodeKeyHash> node_of;
    for (const ElementGroup& group : mesh.element_groups()) {
        const CellType& cell = *group.cell;
        const LagrangeBasis coarse(cell, mesh.degree), fine(cell, degree);
        const auto weights = shared_weights(fine);
        std::vector<double> N(offset(fine.count, coarse.count));  // coarse basis at the fine nodes
        for (int i = 0; i < fine.count; ++i) coarse.values(fine.point(i).data(), &N[offset(i, coarse.count)]);
        for (int e = group.first; e < group.first + group.count; ++e) {
            const int* vertex = linear.element(e);  // in the new numbering
            for (int i = 0; i < fine.count; ++i) {
                if (i < cell.vertices) {
                    raised.elements.push_back(vertex[i]);
                    continue;
                }
                const int next = raised.nodes();
                const int node =
                    weights[i].empty() ? next : node_of.try_emplace(key_of(weights[i], vertex), next).first->second;
                raised.elements.push_back(node);
                if (node < next) continue;
                for (int a = 0; a < dim; ++a) {
                    double position = 0;
                    for (int j = 0; j < coarse.count; ++j)
                        position += N[offset(i, coarse.count, j)] * mesh.x[offset(mesh.element(e)[j], dim, a)];
                    raised.x.push_back(position);
                }
            }
        }
    }
    start_groups(raised.groups, degree);
    start_groups(raised.groups_of_faces, degree);
    raised.faces.clear();
    const SideNodes side_nodes(dim, degree);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f];
        for (int k : side_nodes.of(mesh.cell(e), side_number(mesh, e, mesh.face_vertices(f))))
            raised.faces.push_back(raised.element(e)[k]);
    }
    raise_kept_cells(raised);
    append_node_ids(mesh, raised);
    return raised;
}

}  // namespace almesh
