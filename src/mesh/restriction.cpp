#include "mesh/restriction.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

std::vector<double> at_nodes(std::span<const int> nodes, const std::vector<double>& field, int dim) {
    std::vector<double> rows;
    for (const int i : nodes) rows.insert(rows.end(), point(field, i, dim), point(field, i, dim) + dim);
    return rows;
}

std::vector<double> Restriction::read(const std::vector<double>& x, int dim) const {
    return at_nodes(std::span(node).first(moving), x, dim);
}

void Restriction::write(const std::vector<double>& y, int dim, std::vector<double>& x) const {
    for (int i = 0; i < moving; ++i) std::copy_n(point(y, i, dim), dim, point(x, node[i], dim));
}

Restriction restriction_to(const std::vector<char>& moves, const std::vector<CellNodes>& types) {
    Restriction found;
    int first = 0;
    for (const CellNodes& type : types) {
        for (int e = 0; e < type.count; ++e) {
            const int* const node = &type.elements[offset(e, type.m)];
            if (std::none_of(node, node + type.m, [&](int i) { return moves[i]; })) continue;
            found.element.push_back(first + e);
            found.elements.insert(found.elements.end(), node, node + type.m);
        }
        first += type.count;
    }
    std::vector<int> number(moves.size(), -1);  // mesh -> here
    for (const bool moving : {true, false}) {
        for (const int i : found.elements) {
            if (number[i] >= 0 || static_cast<bool>(moves[i]) != moving) continue;
            number[i] = static_cast<int>(found.node.size());
            found.node.push_back(i);
        }
        if (moving) found.moving = static_cast<int>(found.node.size());
    }
    for (int& node : found.elements) node = number[node];
    return found;
}

Restriction restriction_to(const std::vector<char>& moves, const Mesh& mesh) {
    std::vector<CellNodes> types;
    for (const ElementGroup& group : mesh.element_groups())
        types.push_back({&mesh.elements[group.start], group.count, group.cell->node_count(mesh.degree)});
    return restriction_to(moves, types);
}

}  // namespace almesh
