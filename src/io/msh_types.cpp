#include "io/msh_types.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "io/foreign_cells.hpp"

namespace almesh {

namespace {

// What the elements of a type are, with what to do about them.
const char* foreign_name(int number) {
    static const std::vector<std::pair<const char*, std::vector<std::array<int, 2>>>> foreign = {
        {"incomplete triangles (mesh with Mesh.SecondOrderIncomplete = 0)", {{20, 20}, {22, 22}, {24, 24}, {52, 56}}},
        {"incomplete quadrilaterals (mesh with Mesh.SecondOrderIncomplete = 0)", {{39, 41}, {57, 61}}},
        {"incomplete tetrahedra (mesh with Mesh.SecondOrderIncomplete = 0)", {{79, 83}, {137, 137}}},
        {"incomplete hexahedra (mesh with Mesh.SecondOrderIncomplete = 0)", {{99, 105}}},
        {"incomplete prisms (mesh with Mesh.SecondOrderIncomplete = 0)", {{111, 117}}},
        {"incomplete pyramids (mesh with Mesh.SecondOrderIncomplete = 0)", {{125, 131}}},
        {"cells of a degree above 7 (mesh with a lower Mesh.ElementOrder)",
         {{44, 46}, {49, 51}, {64, 66}, {73, 75}, {97, 98}, {109, 110}, {123, 124}}},
        {"elements of degree 0 (mesh with Mesh.ElementOrder = 1)", {{84, 89}, {132, 132}}}};
    for (const auto& [name, ranges] : foreign)
        for (const auto& [first, last] : ranges)
            if (first <= number && number <= last) return name;
    return "elements of an unknown kind";
}

}  // namespace

MshType msh_type(int number) {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree; ++degree)
            if (cell.msh_types[degree - 1] == number) return {number, &cell, degree, cell.node_count(degree)};
    for (const SerendipityCell& kind : serendipity_cells())
        if (kind.msh_type == number) return {number, kind.cell, 2, kind.nodes()};
    return {number};
}

void ForeignMshElements::add(int type, int line, long long count) {
    const auto same = std::find_if(kinds.begin(), kinds.end(), [type](const Kind& kind) { return kind.type == type; });
    if (same == kinds.end()) kinds.push_back({type, line, count});
    else same->count += count;
}

std::string ForeignMshElements::message() const {
    std::string what;
    for (const Kind& kind : kinds)
        what += concat(what.empty() ? "" : "; ", kind.count, " ", foreign_name(kind.type), " of type ", kind.type,
                       kind.line ? concat(", the first in line ", kind.line) : "");
    return what + ": only " + readable_cells() + " of degree 1 to 7 with all their nodes are read";
}

}  // namespace almesh
