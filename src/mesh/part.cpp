#include "mesh/part.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>

#include "mesh/sides.hpp"

namespace almesh {
namespace {

// The chosen elements and their nodes; number: per node of the mesh, its number in the part or -1.
void add_elements(const Mesh& mesh, const std::vector<char>& chosen, Mesh& part, std::vector<int>& number) {
    number.assign(mesh.nodes(), -1);
    std::vector<const CellType*> types;
    for (int e = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        types.push_back(&mesh.cell(e));
        for (int k = 0; k < mesh.element_nodes(e); ++k) {
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
    part.groups = groups_of(types, mesh.degree);
}

// The sides of the chosen elements that are neither shared by two of them nor boundary faces, by their numbers
// (for_sides()), ascending.
std::vector<int> cut_sides(const Mesh& mesh, const std::vector<char>& chosen) {
    const int boundary = -1;
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[mesh.face_element[f]]) sides.emplace_back(mesh.face_vertices(f), boundary);
    for_sides(mesh, [&](int e, int k, int number) {
        if (chosen[e]) sides.push_back(side_of_element(mesh, e, k, number));
    });
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
    part.contact = mesh.contact;
    part.rounding = mesh.rounding;
    part.cut = add_boundary(part, {cut});
    if (!part.inner.empty()) part.inner.push_back(0);
    if (!part.contact.empty()) part.contact.push_back(0);
    part.file.groups = mesh.file.groups;
    part.file.format = mesh.file.format;
    part.file.zones = mesh.file.zones;

    std::vector<int> number, element(mesh.element_count(), -1);  // of nodes and elements in the part
    add_elements(mesh, chosen, part, number);
    for (int e = 0, next = 0; e < mesh.element_count(); ++e)
        if (chosen[e]) element[e] = next++;

    std::vector<const CellType*> types;  // of the faces
    const auto add_face = [&](const CellType& cell, const int* face, int of_element, int boundary, long long id,
                              int physical, int entity) {
        types.push_back(&cell);
        for (int k = 0; k < cell.node_count(mesh.degree); ++k) part.faces.push_back(number[face[k]]);
        part.face_element.push_back(of_element);
        part.face_boundary.push_back(boundary);
        part.file.face_id.push_back(id);
        part.file.face_physical.push_back(physical);
        part.file.face_entity.push_back(entity);
    };
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f];
        if (!chosen[e]) continue;
        add_face(mesh.face_cell(f), mesh.face(f), element[e], mesh.face_boundary[f], mesh.file.face_id[f],
                 mesh.file.face_physical[f], mesh.file.face_entity[f]);
    }
    const SideNodes side_nodes(mesh.dim, mesh.degree);
    std::vector<int> face;
    for (const int side : cut_sides(mesh, chosen)) {
        const int e = side / mesh.most_sides(), k = side % mesh.most_sides();
        face.clear();
        for (const int i : side_nodes.of(mesh.cell(e), k)) face.push_back(mesh.element(e)[i]);
        add_face(mesh.cell(e).face_type(k), face.data(), element[e], part.cut, 0, 0, 0);
    }
    group_faces(part, types);
    return part;
}

std::vector<char> surroundings(const Mesh& mesh, const std::vector<char>& chosen, double reach) {
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
        const int vertices = mesh.cell(e).vertices;
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
            for (int k = 0; k < mesh.cell(e).vertices; ++k) {
                const int next = mesh.element(e)[k];
                const double length = way.length + edge_length(way.vertex, next) / way.unit;
                if (!is_reached[next] && length <= reach) front.push({length, next, way.unit});
            }
        }
    }
    return result;
}

std::vector<int> elements_of(const ElementGroup& group) {
    std::vector<int> elements(group.count);
    std::iota(elements.begin(), elements.end(), group.first);
    return elements;
}

Mesh of_one_type(const Mesh& mesh, const std::vector<int>& elements) {
    Mesh part;
    part.dim = mesh.dim;
    part.degree = mesh.degree;
    part.x = mesh.x;
    for (const int e : elements) {
        part.elements.insert(part.elements.end(), mesh.element(e), mesh.element(e) + mesh.element_nodes(e));
        part.file.element_id.push_back(mesh.file.element_id[e]);
    }
    part.groups = {{&mesh.cell(elements[0]), 0, static_cast<int>(elements.size()), 0}};
    return part;
}

}  // namespace almesh
