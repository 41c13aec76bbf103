#include "io/foreign_cells.hpp"

#include <algorithm>
#include <numeric>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// VTK's edges and faces of a tetrahedron (vtkLagrangeTetra), each face from the vertex its interior nodes begin at. Its
// lines and triangles have Gmsh's order.
constexpr std::array<CellEdge, 6> tetrahedron_edges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<CellFace, 4> tetrahedron_faces = {
    {{0, 1, 3, -1}, {2, 3, 1, -1}, {0, 3, 2, -1}, {0, 2, 1, -1}}};

std::vector<int> lexicographic_order(const CellType& cell, int degree) {
    const LagrangeBasis gmsh(cell, degree);
    std::vector<int> order(gmsh.count);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int i, int j) {
        const std::array<double, 3> a = gmsh.point(i), b = gmsh.point(j);
        return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
    });
    return order;
}

}  // namespace

std::vector<int> vtk_node_order(const CellType& cell, int degree) {
    const LagrangeBasis gmsh(cell, degree);
    std::vector<int> order;
    if (!cell.is_simplex()) {  // edges against Gmsh's where a coordinate falls along these, the inside lexicographic
        const int inside = 4 * degree;
        for (int i = 0; i < inside; ++i) order.push_back(i);
        for (int k = 2; k < 4; ++k)
            std::reverse(order.begin() + 4 + k * (degree - 1), order.begin() + 4 + (k + 1) * (degree - 1));
        const std::vector<int> all = lexicographic_order(cell, degree);
        std::copy_if(all.begin(), all.end(), std::back_inserter(order), [&](int i) { return i >= inside; });
        return order;
    }
    for (const MultiIndex& a :
         cell.dim == 3 ? lattice_nodes(cell, degree, tetrahedron_edges, tetrahedron_faces) : gmsh.nodes)
        order.push_back(gmsh.find(a));
    return order;
}

std::vector<int> su2_node_order(const CellType& cell, int degree) {
    return degree == 1 ? vtk_node_order(cell, 1) : lexicographic_order(cell, degree);
}

std::string readable_cells(int lowest, int highest) {
    std::vector<std::string> names;
    for (int dim = lowest; dim <= highest; ++dim)
        for (const CellType& cell : cell_types())
            if (cell.dim == dim && (dim < 3 || cell.is_simplex())) names.push_back(cell.plural);
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
    return text;
}

void add_centres(RawMesh& mesh) {
    long long id = 0;
    for (const RawNode& node : mesh.nodes) id = std::max(id, node.id);
    const std::size_t before = mesh.nodes.size();
    for (const RawElement& element : mesh.elements) {
        int* const node = &mesh.element_nodes[element.first];
        int& last = node[element.node_count() - 1];
        if (last >= 0) continue;
        last = static_cast<int>(mesh.nodes.size());
        RawNode centre{++id, {}, element.line};
        for (int k = 0; k < 4; ++k)
            for (int a = 0; a < 3; ++a)
                centre.x[a] += mesh.nodes[node[4 + k]].x[a] / 2 - mesh.nodes[node[k]].x[a] / 4;
        if (!mesh.node_blocks.empty()) mesh.node_blocks.push_back({mesh.nodes.size(), {2, element.entity}});
        mesh.nodes.push_back(centre);
    }
    if (const std::size_t added = mesh.nodes.size() - before)
        mesh.notes.push_back(counted(added, "quadrilateral") + " of 8 nodes: a ninth one is added in the centre");
}

void check_cells(const RawMesh& mesh) {
    const auto is_solid = [](const RawElement& element) { return element.dim == 3; };
    const auto is_foreign = [](const RawElement& element) { return element.dim == 2 && !element.cell().is_simplex(); };
    const auto first = std::find_if(mesh.elements.begin(), mesh.elements.end(), is_foreign);
    if (first == mesh.elements.end() || std::none_of(mesh.elements.begin(), mesh.elements.end(), is_solid)) return;
    throw InputError(mesh.path, first->line ? concat(":", first->line) : "", ": ",
                     std::count_if(mesh.elements.begin(), mesh.elements.end(), is_foreign), " ", first->cell().plural,
                     " beside ", std::find_if(mesh.elements.begin(), mesh.elements.end(), is_solid)->cell().plural,
                     ": a mesh is read that has ", readable_cells(2, 2), ", or tetrahedra with triangles");
}

}  // namespace almesh
