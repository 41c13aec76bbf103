#include "mesh/part.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include "mesh/lagrange.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// The chosen elements and their nodes; number: per node of the mesh, its number in the part or -1.
void add_elements(const Mesh& mesh, const std::vector<char>& chosen, Mesh& part, std::vector<int>& number) {
    number.assign(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        for (int k = 0; k < mesh.element_nodes(); ++k) {
            int& node = number[mesh.element(e)[k]];
            if (node < 0) {
                node = part.nodes();
                const double* const x = point(mesh.x, mesh.element(e)[k], mesh.dim);
                part.x.insert(part.x.end(), x, x + mesh.dim);
                part.file.node_id.push_back(mesh.file.node_id[mesh.element(e)[k]]);
            }
            part.elements.push_back(node);
        }
        part.file.element_id.push_back(mesh.file.element_id[e]);
        part.file.element_physical.push_back(mesh.file.element_physical[e]);
        part.file.element_entity.push_back(mesh.file.element_entity[e]);
    }
}

// The sides of the chosen elements that are neither shared by two of them nor boundary faces: element * (dim + 1) + k,
// ascending.
std::vector<int> cut_sides(const Mesh& mesh, const std::vector<char>& chosen) {
    const int corners = mesh.dim + 1, boundary = -1;
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[mesh.face_element[f]]) sides.emplace_back(std::span(mesh.face(f), mesh.dim), boundary);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < corners && chosen[e]; ++k)
            sides.push_back(side_of_simplex(mesh.dim, mesh.element(e), k, e * corners + k));
    std::vector<int> cut;
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        if (equal.size() == 1) cut.push_back(equal[0].number);
    });
    std::sort(cut.begin(), cut.end());
    return cut;
}

}  // namespace

Mesh part_of(const Mesh& mesh, const std::vector<char>& chosen, const std::string& cut) {
    Mesh part;
    part.dim = mesh.dim;
    part.degree = mesh.degree;
    part.boundaries = mesh.boundaries;
    part.boundary_groups = mesh.boundary_groups;
    part.inner = mesh.inner;
    part.cut = add_boundary(part, {cut});
    if (!part.inner.empty()) part.inner.push_back(0);
    part.file.groups = mesh.file.groups;
    part.file.format = mesh.file.format;
    part.file.zones = mesh.file.zones;

    std::vector<int> number, element(mesh.element_count(), -1);  // of nodes and elements in the part
    add_elements(mesh, chosen, part, number);
    for (int e = 0, next = 0; e < mesh.element_count(); ++e)
        if (chosen[e]) element[e] = next++;

    const auto add_face = [&](const int* face, int of_element, int boundary, long long id, int physical, int entity) {
        for (int k = 0; k < mesh.face_nodes(); ++k) part.faces.push_back(number[face[k]]);
        part.face_element.push_back(of_element);
        part.face_boundary.push_back(boundary);
        part.file.face_id.push_back(id);
        part.file.face_physical.push_back(physical);
        part.file.face_entity.push_back(entity);
    };
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f];
        if (!chosen[e]) continue;
        add_face(mesh.face(f), element[e], mesh.face_boundary[f], mesh.file.face_id[f], mesh.file.face_physical[f],
                 mesh.file.face_entity[f]);
    }
    const std::vector<std::vector<int>> local = LagrangeBasis(mesh.dim, mesh.degree).face_nodes();
    std::vector<int> face(mesh.face_nodes());
    for (const int side : cut_sides(mesh, chosen)) {
        const int e = side / (mesh.dim + 1);
        for (int k = 0; k < mesh.face_nodes(); ++k) face[k] = mesh.element(e)[local[side % (mesh.dim + 1)][k]];
        add_face(face.data(), element[e], part.cut, 0, 0, 0);
    }
    return part;
}

std::vector<char> surroundings(const Mesh& mesh, const std::vector<char>& chosen, double reach) {
    const int vertices = mesh.dim + 1;
    const auto edge_length = [&](int i, int j) {
        double sum = 0;
        for (int a = 0; a < mesh.dim; ++a) {
            const double d = point(mesh.x, j, mesh.dim)[a] - point(mesh.x, i, mesh.dim)[a];
            sum += d * d;
        }
        return std::sqrt(sum);
    };
    struct Way {
        double length;  // over that of the edge it started with
        int vertex;
        double unit;
        bool operator>(const Way& other) const {
            if (length != other.length) return length > other.length;
            return vertex != other.vertex ? vertex > other.vertex : unit < other.unit;
        }
    };
    std::priority_queue<Way, std::vector<Way>, std::greater<>> front;
    std::vector<std::vector<int>> elements_at(mesh.nodes());
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* const node = mesh.element(e);
        double longest = 0;
        for (int k = 0; k < vertices; ++k) {
            elements_at[node[k]].push_back(e);
            for (int j = 0; j < k; ++j) longest = std::max(longest, edge_length(node[j], node[k]));
        }
        for (int k = 0; k < vertices && chosen[e]; ++k) front.push({0, node[k], longest});
    }
    std::vector<char> is_reached(mesh.nodes(), 0), result(mesh.element_count(), 0);
    while (!front.empty()) {
        const Way way = front.top();
        front.pop();
        if (is_reached[way.vertex]) continue;
        is_reached[way.vertex] = 1;
        for (const int e : elements_at[way.vertex]) {
            result[e] = 1;
            for (int k = 0; k < vertices; ++k) {
                const int next = mesh.element(e)[k];
                const double length = way.length + edge_length(way.vertex, next) / way.unit;
                if (!is_reached[next] && length <= reach) front.push({length, next, way.unit});
            }
        }
    }
    return result;
}

SubMesh elements_around(const std::vector<int>& elements, int count, int m, const std::vector<char>& moves) {
    SubMesh part;
    for (int e = 0; e < count; ++e) {
        const int* const node = &elements[offset(e, m)];
        if (std::any_of(node, node + m, [&](int i) { return moves[i]; })) part.place.push_back(e);
    }
    std::vector<int> number(moves.size(), -1);  // node of the mesh -> node of the part
    for (const bool moving : {true, false})
        for (const int e : part.place)
            for (int i = 0; i < m; ++i) {
                const int node = elements[offset(e, m, i)];
                if (number[node] >= 0 || static_cast<bool>(moves[node]) != moving) continue;
                number[node] = static_cast<int>(part.node.size());
                part.node.push_back(node);
            }
    for (const int e : part.place)
        for (int i = 0; i < m; ++i) part.elements.push_back(number[elements[offset(e, m, i)]]);
    return part;
}

}  // namespace almesh
