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
        {"hexahedra (mesh without Recombine)", {{5, 5}, {12, 12}, {17, 17}, {92, 105}}},
        {"prisms (mesh without Recombine)", {{6, 6}, {13, 13}, {18, 18}, {90, 91}, {106, 117}}},
        {"pyramids (mesh without Recombine)", {{7, 7}, {14, 14}, {19, 19}, {118, 132}}},
        {"incomplete triangles (mesh with Mesh.SecondOrderIncomplete = 0)", {{20, 20}, {22, 22}, {24, 24}, {52, 56}}},
        {"incomplete quadrilaterals (mesh with Mesh.SecondOrderIncomplete = 0)", {{39, 41}, {57, 61}}},
        {"incomplete tetrahedra (mesh with Mesh.SecondOrderIncomplete = 0)", {{79, 83}}},
        {"cells of a degree above 7 (mesh with a lower Mesh.ElementOrder)", {{44, 46}, {49, 51}, {64, 66}, {73, 75}}},
        {"elements of degree 0 (mesh with Mesh.ElementOrder = 1)", {{84, 89}}}};
    for (const auto& [name, ranges] : foreign)
        for (const auto& [first, last] : ranges)
            if (first <= number && number <= last) return name;
    return "elements of an unknown kind";
}

}  // namespace

MshType msh_type(int number) {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree; ++degree)
            if (cell.msh_types[degree - 1] == number && (cell.dim < 3 || cell.is_simplex()))
                return {number, &cell, degree, cell.node_count(degree)};
    if (number == 16) return {number, &quadrilateral(), 2, 8};  // without its centre
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
