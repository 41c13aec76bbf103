#include "mesh/restriction.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "mesh/mesh.hpp"

namespace almesh {
namespace {

std::vector<double> of_first(int count, const std::vector<int>& node, const std::vector<double>& x, int dim) {
    std::vector<double> y;
    for (int i = 0; i < count; ++i) y.insert(y.end(), point(x, node[i], dim), point(x, node[i], dim) + dim);
    return y;
}

}  // namespace

std::vector<double> Restriction::all(const std::vector<double>& x, int dim) const {
    return of_first(static_cast<int>(node.size()), node, x, dim);
}

std::vector<double> Restriction::read(const std::vector<double>& x, int dim) const {
    return of_first(moving, node, x, dim);
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
