#include "library/mesh_arrays.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// Of the group of this dimension and name, which is appended if there is none.
int tag_of(PhysicalGroup group, std::vector<PhysicalGroup>& groups) {
    for (const PhysicalGroup& other : groups)
        if (other.dim == group.dim && other.name == group.name) return other.tag;
    group.tag = static_cast<int>(groups.size()) + 1;
    groups.push_back(group);
    return group.tag;
}

// Appends cells with the physical group `tag`; their ids go on from those before.
void add_cells(const MeshArrays& arrays, const Cells& cells, int dim, int tag, const std::string& what, RawMesh& raw) {
    const CellType& type = type_of(cells.type);
    const auto size = static_cast<std::size_t>(type.node_count(arrays.degree));
    if (type.dim != dim) throw UsageError(arrays_name, ": ", what, ": a ", type.name, " in ", dim, " dimensions");
    if (cells.nodes.size() % size != 0)
        throw UsageError(arrays_name, ": ", what, ": ", cells.nodes.size(), " nodes, but each ", type.name,
                         " of degree ", arrays.degree, " has ", size);
    for (std::size_t first = 0; first < cells.nodes.size(); first += size) {
        raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, dim,
                                arrays.degree, tag, 0, &type});
        for (std::size_t k = first; k < first + size; ++k) {
            const int node = cells.nodes[k];
            if (node < 0 || node >= static_cast<int>(raw.nodes.size()))
                throw UsageError(arrays_name, ": ", what, ": node ", node, ", of ", raw.nodes.size());
            raw.element_nodes.push_back(node);
        }
    }
}

}  // namespace

const CellType& type_of(Cell cell) {
    const CellType* const types[] = {&simplex(1), &simplex(2), &quadrilateral(), &simplex(3),
                                     &hexahedron(), &prism(), &pyramid()};  // in the order of Cell
    const auto number = static_cast<std::size_t>(cell);
    if (number >= std::size(types)) throw UsageError(arrays_name, ": a cell of no known type");
    return *types[number];
}

Cell cell_of(const CellType& type) {
    for (auto cell = Cell::line;; cell = static_cast<Cell>(static_cast<int>(cell) + 1))
        if (&type_of(cell) == &type) return cell;
}

void check_form(const MeshArrays& arrays) {
    if (arrays.dim != 2 && arrays.dim != 3)
        throw UsageError(arrays_name, ": dim = ", arrays.dim, ": a mesh has 2 or 3 dimensions");
    if (arrays.degree < 1 || arrays.degree > max_degree)
        throw UsageError(arrays_name, ": degree = ", arrays.degree, ": degrees are 1 to ", max_degree);
}

MeshSource source_of(const MeshArrays& arrays) {
    const int dim = arrays.dim;
    check_form(arrays);
    if (arrays.x.empty() || arrays.x.size() % dim != 0)
        throw UsageError(arrays_name, ": ", arrays.x.size(), " coordinates are not those of nodes in ", dim,
                         " dimensions");
    MeshSource source;
    RawMesh& raw = source.raw;
    raw.path = arrays_name;
    for (std::size_t i = 0; i < arrays.x.size() / dim; ++i) {
        RawNode node{static_cast<long long>(i) + 1, {}, 0};
        std::copy_n(point(arrays.x, i, dim), dim, node.x);
        if (!std::all_of(node.x, node.x + dim, [](double v) { return std::abs(v) <= 1e50; }))
            throw InputError(arrays_name, ": node ", i, " is not at a finite position, or beyond 1e50");
        raw.nodes.push_back(node);
    }
    for (const Cells& cells : arrays.elements) {
        const int tag = cells.volume.empty() ? 0 : tag_of({dim, 0, cells.volume}, raw.groups);
        add_cells(arrays, cells, dim, tag, "elements", raw);
    }
    for (const Faces& faces : arrays.faces) {
        const int tag = tag_of({dim - 1, 0, faces.boundary}, raw.groups);
        add_cells(arrays, faces.cells, dim - 1, tag, "faces of " + in_backquotes(faces.boundary), raw);
    }
    std::string bytes(reinterpret_cast<const char*>(arrays.x.data()), arrays.x.size() * sizeof(double));
    bytes.append(reinterpret_cast<const char*>(raw.element_nodes.data()), raw.element_nodes.size() * sizeof(int));
    source.hash = hash_of(bytes);
    return source;
}

}  // namespace almesh
