#include "mesh/build_boundary.hpp"

#include <algorithm>

#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

// The elements at the nodes with which kept cells begin.
std::vector<std::vector<int>> elements_around(const MeshBuild& build) {
    const Mesh& mesh = build.mesh;
    std::vector<char> begins(mesh.nodes(), 0);
    for (const int i : build.kept)
        if (const int node = build.node[build.raw.element_nodes[build.raw.elements[i].first]]; node >= 0)
            begins[node] |= build.raw.elements[i].dim > 0;
    std::vector<std::vector<int>> around(mesh.nodes());
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v)
            if (const int node = mesh.element(e)[v]; begins[node]) around[node].push_back(e);
    return around;
}

// Of these one that has the cell with the given nodes, -1: none.
int element_of(const Subcells& subcells, const std::vector<int>& elements, const std::vector<int>& nodes,
               const CellType& cell) {
    for (const int e : elements)
        if (subcells.has(e, nodes.data(), cell) && subcells.nodes(e, nodes.data(), cell) == nodes) return e;
    return -1;
}

}  // namespace

void fill_kept(MeshBuild& build) {
    Mesh& mesh = build.mesh;
    const RawMesh& raw = build.raw;
    if (build.kept.empty()) return;
    std::sort(build.kept.begin(), build.kept.end());  // file order
    const std::vector<std::vector<int>> around = elements_around(build);
    const Subcells subcells(mesh);
    const RawElement* first_dropped = nullptr;
    std::size_t dropped = 0, copies = 0;  // copies: other elements than simplices that are given again
    for (const int i : build.kept) {
        const RawElement& cell = raw.elements[i];
        std::vector<int> nodes;
        for (int k = 0; k < cell.node_count(); ++k)
            nodes.push_back(build.node[raw.element_nodes[cell.first + k]]);
        const bool is_point = cell.dim == 0, is_copy = cell.dim == mesh.dim && !cell.cell().is_simplex();
        const bool in_mesh = !is_copy && (is_point || cell.degree == mesh.degree) &&
                             *std::min_element(nodes.begin(), nodes.end()) >= 0;
        const int element = in_mesh && !is_point ? element_of(subcells, around[nodes[0]], nodes, cell.cell()) : -1;
        if (element >= 0 || (is_point && in_mesh)) {
            KeptCells& kept = mesh.kept[&cell.cell() - cell_types().data()];
            kept.nodes.insert(kept.nodes.end(), nodes.begin(), nodes.end());
            append_tags({{}, {element}, {cell.id}, {cell.physical}, {cell.entity}}, 0, kept);
        } else if (is_copy) ++copies;
        else if (!is_point && ++dropped == 1) first_dropped = &cell;
    }
    if (copies)
        build.notes.push_back(concat(counted(copies, mesh.dim == 2 ? "quadrilateral" : "cell"),
                                     " given again left out: the groups of what is given first count"));
    if (dropped)
        build.notes.push_back(concat(counted(dropped, "element"), " of the file that ", dropped == 1 ? "is" : "are",
                                     " no edge or face of the mesh left out, the first is ", name_of(*first_dropped)));
}

}  // namespace almesh
