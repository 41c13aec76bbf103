#include "mesh/build_boundary.hpp"

#include <algorithm>

#include "linalg/ordering/graph.hpp"
#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

// Elements by their vertices.
struct ElementsAround {
    explicit ElementsAround(const Mesh& mesh) {
        for (const ElementGroup& group : mesh.element_groups()) corners = std::max(corners, group.cell->vertices);
        std::vector<int> vertex(offset(mesh.element_count(), corners));
        for (int e = 0; e < mesh.element_count(); ++e)  // the last one of an element with fewer more than once
            for (int v = 0; v < corners; ++v)
                vertex[offset(e, corners, v)] = mesh.element(e)[std::min(v, mesh.cell(e).vertices - 1)];
        sorted = sorted_by_group(vertex, mesh.nodes());
    }
    int corners = 0;
    Groups sorted;  // items: element * corners + local vertex
};

// An element that has the cell with the given nodes, -1: none.
int element_of(const Subcells& subcells, const ElementsAround& around, const std::vector<int>& nodes,
               const CellType& cell) {
    for (const int item : around.sorted.of(nodes[0])) {
        const int e = item / around.corners;
        if (subcells.has(e, nodes.data(), cell) && subcells.nodes(e, nodes.data(), cell) == nodes) return e;
    }
    return -1;
}

void append(KeptCells& kept, const RawElement& cell, const std::vector<int>& nodes, int element) {
    kept.nodes.insert(kept.nodes.end(), nodes.begin(), nodes.end());
    kept.element.push_back(element);
    kept.id.push_back(cell.id);
    kept.physical.push_back(cell.physical);
    kept.entity.push_back(cell.entity);
}

}  // namespace

void fill_kept(MeshBuild& build) {
    Mesh& mesh = build.mesh;
    const RawMesh& raw = build.raw;
    if (build.kept.empty()) return;
    std::sort(build.kept.begin(), build.kept.end());  // file order
    const ElementsAround around(mesh);
    const Subcells subcells(mesh);
    const RawElement* first_dropped = nullptr;
    std::size_t dropped = 0, copies = 0;  // copies: other elements than simplices that are given again
    for (const int i : build.kept) {
        const RawElement& cell = raw.elements[i];
        std::vector<int> nodes;
        for (int k = 0; k < cell.node_count(); ++k)
            nodes.push_back(build.node[raw.element_nodes[cell.first + k]]);
        if (cell.dim == 0) {
            if (nodes[0] >= 0) append(mesh.kept[0], cell, nodes, -1);
            continue;
        }
        const bool is_copy = cell.dim == mesh.dim && !cell.cell().is_simplex();
        const bool in_mesh =
            !is_copy && cell.degree == mesh.degree && *std::min_element(nodes.begin(), nodes.end()) >= 0;
        const int element = in_mesh ? element_of(subcells, around, nodes, cell.cell()) : -1;
        if (element >= 0) append(mesh.kept[&cell.cell() - cell_types().data()], cell, nodes, element);
        else if (is_copy) ++copies;
        else if (++dropped == 1) first_dropped = &cell;
    }
    if (copies)
        build.notes.push_back(concat(counted(copies, mesh.dim == 2 ? "quadrilateral" : "cell"),
                                     " given again left out: the groups of what is given first count"));
    if (dropped)
        build.notes.push_back(concat(counted(dropped, "element"), " of the file that ", dropped == 1 ? "is" : "are",
                                     " no edge or face of the mesh left out, the first is ", name_of(*first_dropped)));
}

}  // namespace almesh
