#include <map>
#include <tuple>

#include "base/error.hpp"
#include "base/text.hpp"
#include "io/foreign_cells.hpp"
#include "io/vtk.hpp"

namespace almesh {
namespace {

struct VtkCell {
    const CellType* cell = nullptr;
    int degree = 0;
    bool is_lagrange = false;
};

// Of a type with this number of nodes; nullptr: of another kind.
VtkCell cell_of(long long type, long long nodes) {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree; ++degree)
            if (const bool is_lagrange = type > 0 && cell.vtk_types[2] == type;
                (is_lagrange || (degree < 3 && cell.vtk_types[degree - 1] == type)) && cell.node_count(degree) == nodes)
                return {&cell, degree, is_lagrange};
    for (const SerendipityCell& kind : serendipity_cells())
        if (kind.vtk_type == type && kind.nodes() == nodes) return {kind.cell, 2};
    return {};
}

}  // namespace

void append_vtk_cells(const VtkCells& cells, const std::string& path, RawMesh& mesh) {
    std::map<std::tuple<const CellType*, int, bool>, std::vector<int>> orders;
    std::map<std::pair<long long, long long>, std::size_t> foreign;  // by type and number of nodes
    const auto point_count = static_cast<long long>(mesh.nodes.size());
    for (std::size_t c = 0; c < cells.types.size(); ++c) {
        const long long begin = cells.offsets[c], nodes = cells.offsets[c + 1] - begin;
        if (begin < 0 || nodes < 0 || cells.offsets[c + 1] > static_cast<long long>(cells.connectivity.size()))
            throw InputError(path, ": the list of cells ends before cell ", c);
        const auto [cell, degree, is_lagrange] = cell_of(cells.types[c], nodes);
        if (!cell) {
            ++foreign[{cells.types[c], nodes}];
            continue;
        }
        std::vector<int>& order = orders[{cell, degree, is_lagrange}];
        const bool is_mirrored = is_lagrange && (cells.are_of_vtk_8 || cell != &hexahedron());
        if (order.empty()) order = vtk_node_order(*cell, degree, is_mirrored);
        mesh.elements.push_back(
            {static_cast<long long>(c) + 1, mesh.element_nodes.size(), 0, cell->dim, degree, 0, 0, cell});
        mesh.element_nodes.resize(mesh.element_nodes.size() + order.size(), -1);
        for (int k = 0; k < nodes; ++k) {
            const long long node = cells.connectivity[begin + k];
            if (node < 0 || node >= point_count)
                throw InputError(path, ": cell ", c, " has the point ", node, ", of ", point_count);
            mesh.element_nodes[mesh.elements.back().first + order[k]] = static_cast<int>(node);
        }
    }
    std::string text;
    for (const auto& [kind, count] : foreign)
        text += concat(text.empty() ? "" : "; ", count, " of type ", kind.first, " with ", kind.second, " nodes");
    if (!foreign.empty())
        throw InputError(path, ": cells of other kinds, ", text, ": only ", readable_cells(), " with all "
                         "nodes of their degree are read");
}

}  // namespace almesh
