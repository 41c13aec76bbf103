#include "mesh/mesh.hpp"

#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {

Mesh::Mesh() = default;
Mesh::Mesh(const Mesh& other) = default;
Mesh::Mesh(Mesh&& other) noexcept = default;
Mesh& Mesh::operator=(const Mesh& other) = default;
Mesh& Mesh::operator=(Mesh&& other) noexcept = default;
Mesh::~Mesh() = default;

int Mesh::boundary_index(const std::string& name) const {
    const auto it = std::find(boundaries.begin(), boundaries.end(), name);
    return it == boundaries.end() ? -1 : static_cast<int>(it - boundaries.begin());
}

int Mesh::most_sides() const {
    int most = 0;
    for (const ElementGroup& group : element_groups())
        most = std::max(most, static_cast<int>(group.cell->faces.size()));
    return most;
}

std::string Mesh::elements_text() const {
    std::string text;
    for (const ElementGroup& group : element_groups())
        text += concat(text.empty() ? "" : ", ", group.count, " ", group.count == 1 ? group.cell->name
                                                                                   : group.cell->plural);
    return text;
}

std::vector<char> Mesh::boundaries_in(const std::string& group) const {
    std::vector<char> in(boundary_groups.size(), 0);
    for (std::size_t b = 0; b < in.size(); ++b)
        in[b] = std::find(boundary_groups[b].begin(), boundary_groups[b].end(), group) != boundary_groups[b].end();
    return in;
}

std::vector<ElementGroup> groups_of(const std::vector<const CellType*>& types, int degree) {
    std::vector<ElementGroup> groups;
    std::size_t start = 0;
    for (int e = 0; e < static_cast<int>(types.size()); ++e) {
        if (groups.empty() || groups.back().cell != types[e]) groups.push_back({types[e], e, 0, start});
        ++groups.back().count;
        start += types[e]->node_count(degree);
    }
    if (groups.size() == 1 && groups[0].cell->is_simplex()) groups.clear();
    return groups;
}

void group_faces(Mesh& mesh, const std::vector<const CellType*>& types) {
    std::vector<int> order(types.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int f) { return std::pair(types[f], mesh.file.face_physical[f] == not_in_file); };
    std::stable_sort(order.begin(), order.end(), [&](int f, int g) { return key(f) < key(g); });
    std::vector<std::size_t> start = {0};
    for (const CellType* const type : types) start.push_back(start.back() + type->node_count(mesh.degree));
    const auto sort = [&order](auto& values) {
        const auto before = values;
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = before[order[k]];
    };
    const std::vector<int> before = std::move(mesh.faces);
    mesh.faces.clear();
    std::vector<const CellType*> sorted;
    for (const int f : order) {
        sorted.push_back(types[f]);
        mesh.faces.insert(mesh.faces.end(), &before[start[f]], &before[start[f]] + (start[f + 1] - start[f]));
    }
    mesh.groups_of_faces = groups_of(sorted, mesh.degree);
    for (std::vector<int>* const of : {&mesh.face_element, &mesh.face_boundary, &mesh.file.face_physical,
                                       &mesh.file.face_entity})
        sort(*of);
    sort(mesh.file.face_id);
}

std::string face_name(const Mesh& mesh, int f) {
    const long long id = id_in_file(mesh.file.face_id, f);
    return concat(id ? concat("face ", id) : "a face", " of ", mesh.boundaries[mesh.face_boundary[f]]);
}

int add_boundary(Mesh& mesh, const std::vector<std::string>& groups) {
    std::string name;
    for (const std::string& group : groups) name += (name.empty() ? "" : " + ") + group;
    mesh.boundaries.push_back(name);
    mesh.boundary_groups.push_back(groups);
    return static_cast<int>(mesh.boundaries.size()) - 1;
}

std::vector<double> straight_sided(const Mesh& mesh) {
    std::vector<double> y = mesh.x;
    for (const ElementGroup& group : mesh.element_groups()) {
        const LagrangeBasis basis(*group.cell, mesh.degree);
        const int vertices = group.cell->vertices;
        std::vector<std::vector<double>> weight;
        for (int i = vertices; i < basis.count; ++i) weight.push_back(basis.vertex_weights(i));
        for (int e = group.first; e < group.first + group.count; ++e) {
            const int* const node = mesh.element(e);
            for (int i = vertices; i < basis.count; ++i)
                for (int a = 0; a < mesh.dim; ++a) {
                    double position = 0;
                    for (int v = 0; v < vertices; ++v)
                        position += weight[i - vertices][v] * mesh.x[offset(node[v], mesh.dim, a)];
                    y[offset(node[i], mesh.dim, a)] = position / mesh.degree;
                }
        }
    }
    return y;
}

std::array<double, 3> centroid(const Mesh& mesh, const std::vector<double>& x, const int* nodes, int count) {
    std::array<double, 3> mean{};
    for (int k = 0; k < count; ++k)
        for (int a = 0; a < mesh.dim; ++a) mean[a] += point(x, nodes[k], mesh.dim)[a];
    for (double& coordinate : mean) coordinate /= count;
    return mean;
}

std::array<double, 3> element_centre(const Mesh& mesh, const std::vector<double>& x, int e) {
    return centroid(mesh, x, mesh.element(e), mesh.cell(e).vertices);
}

namespace {

// With a rule that is exact for det J of straight-sided cells: of degree 2 in each factor.
const ReferenceElement& linear_reference(const CellType& cell) {
    static const std::vector<ReferenceElement> of_types = [] {
        std::vector<ReferenceElement> references;
        for (const CellType& type : cell_types()) {
            references.emplace_back();
            if (type.dim > 1) references.back() = reference_element(type, 1, cell_quadrature(type, 2));
        }
        return references;
    }();
    return of_types[&cell - cell_types().data()];
}

}  // namespace

double volume(const Mesh& mesh, const std::vector<double>& y) {
    return deterministic_sum(mesh.element_count(), [&](int e) { return volume(mesh, y, e); });
}

double volume(const Mesh& mesh, const std::vector<double>& y, int e) {
    const int* const node = mesh.element(e);
    double size = 0;
    with_dimension(mesh.dim, [&](auto n) {
        size = determinant(straight_jacobian<n>(node, y)) / simplex(n).inverse_volume;
        if (mesh.cell(e).is_simplex()) return;
        if constexpr (n() == 3) {
            size = 0;
            const ReferenceElement& reference = linear_reference(mesh.cell(e));
            for (int q = 0; q < reference.points; ++q)
                size += reference.weight[q] * determinant(jacobian_at<3>(node, y, reference, q));
            return;
        }
        const int other[] = {node[0], node[2], node[3], -1};  // the triangle on the other side of the diagonal
        size += determinant(straight_jacobian<n>(other, y)) / simplex(n).inverse_volume;
    });
    return size;
}

}  // namespace almesh
