#include "mesh/part.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>

#include "mesh/sides.hpp"

namespace almesh {
namespace {

template <class Values>
Values picked(const Values& values, const std::vector<int>& numbers) {
    Values some;
    for (const int i : numbers) some.push_back(values[i]);
    return some;
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

// number, element: of the whole's nodes and elements in the part.
void add_faces(const Mesh& mesh, const std::vector<char>& chosen, const std::vector<int>& number,
               const std::vector<int>& element, MeshPart& part) {
    struct Face {
        const CellType* cell;
        int face, side;  // in the whole, -1 at the cut; there a side of an element
    };
    std::vector<Face> faces;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[mesh.face_element[f]]) faces.push_back({&mesh.face_cell(f), f, -1});
    const int sides = mesh.most_sides();
    for (const int side : cut_sides(mesh, chosen))
        faces.push_back({&mesh.cell(side / sides).face_type(side % sides), -1, side});
    std::stable_sort(faces.begin(), faces.end(), [](const Face& f, const Face& g) { return f.cell < g.cell; });
    const SideNodes side_nodes(mesh.dim, mesh.degree);
    part.on_cut.assign(part.nodes(), 0);
    std::vector<const CellType*> types;
    for (const auto& [cell, f, side] : faces) {
        const int e = f < 0 ? side / sides : mesh.face_element[f];
        types.push_back(cell);
        part.face_of.push_back(f);
        part.face_element.push_back(element[e]);
        part.face_boundary.push_back(f < 0 ? part.cut() : mesh.face_boundary[f]);
        part.file.face_id.push_back(f < 0 ? 0 : mesh.file.face_id[f]);
        for (int k = 0; k < cell->node_count(mesh.degree); ++k) {
            const int i = number[f < 0 ? mesh.element(e)[side_nodes.of(mesh.cell(e), side % sides)[k]]
                                       : mesh.face(f)[k]];
            part.faces.push_back(i);
            if (f < 0) part.on_cut[i] = 1;
        }
    }
    part.groups_of_faces = groups_of(types, mesh.degree);
}

}  // namespace

MeshPart part_of(const Mesh& mesh, const std::vector<char>& chosen, const std::string& cut) {
    MeshPart part;
    part.dim = mesh.dim;
    part.degree = mesh.degree;
    part.boundaries = mesh.boundaries;
    part.boundary_groups = mesh.boundary_groups;
    part.inner = mesh.inner;
    part.contact = mesh.contact;
    part.rounding = mesh.rounding;
    add_boundary(part, {cut});
    if (!part.inner.empty()) part.inner.push_back(0);
    if (!part.contact.empty()) part.contact.push_back(0);

    std::vector<int> number(mesh.nodes(), -1), element(mesh.element_count(), -1);
    std::vector<const CellType*> types;
    for (int e = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        element[e] = static_cast<int>(part.element_of.size());
        part.element_of.push_back(e);
        types.push_back(&mesh.cell(e));
        for (int k = 0; k < mesh.element_nodes(e); ++k) {
            const int i = mesh.element(e)[k];
            if (number[i] < 0) {
                number[i] = static_cast<int>(part.node_of.size());
                part.node_of.push_back(i);
            }
            part.elements.push_back(number[i]);
        }
    }
    part.groups = groups_of(types, mesh.degree);
    part.x = part.restricted(mesh.x);
    part.file.node_id = picked(mesh.file.node_id, part.node_of);
    part.file.element_id = picked(mesh.file.element_id, part.element_of);
    part.file.element_entity = picked(mesh.file.element_entity, part.element_of);
    part.file.zones = mesh.file.zones;
    add_faces(mesh, chosen, number, element, part);
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
