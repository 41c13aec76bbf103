#include "io/vtk.hpp"

#include <algorithm>
#include <cmath>

#include "base/files.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// VTK's edges and faces of a tetrahedron (vtkLagrangeTetra), each face from the vertex its inner nodes begin at.
constexpr int tetrahedron_edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr int tetrahedron_faces[4][3] = {{0, 1, 3}, {2, 3, 1}, {0, 3, 2}, {0, 2, 1}};

// Multi-indices of the nodes in VTK's order: like Gmsh's, vertices, edges, faces and recursively the inside.
std::vector<MultiIndex> vtk_tetrahedron(int p) {
    if (p == 0) return {MultiIndex{}};
    std::vector<MultiIndex> nodes;
    for (int v = 0; v < 4; ++v) {
        nodes.push_back({});
        nodes.back()[v] = p;
    }
    for (const auto& edge : tetrahedron_edges)
        for (int s = 1; s < p; ++s) {
            nodes.push_back({});
            nodes.back()[edge[0]] = p - s;
            nodes.back()[edge[1]] = s;
        }
    if (p >= 3)
        for (const auto& face : tetrahedron_faces)
            for (const MultiIndex& b : gmsh_node_order(2, p - 3)) {
                nodes.push_back({});
                for (int k = 0; k < 3; ++k) nodes.back()[face[k]] = b[k] + 1;
            }
    if (p >= 4)
        for (MultiIndex a : vtk_tetrahedron(p - 4)) {
            for (int& entry : a) ++entry;
            nodes.push_back(a);
        }
    return nodes;
}

int vtk_cell_type(int cell_dim, int degree) {
    constexpr int types[3][3] = {{3, 21, 68}, {5, 22, 69}, {10, 24, 71}};
    return types[cell_dim - 1][degree < 3 ? degree - 1 : 2];
}

// Names and strings: blanks, control characters, quotes and % as %XX.
std::string encoded(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c > ' ' && c <= '~' && c != '%' && c != '"') {
            result += c;
            continue;
        }
        const auto byte = static_cast<unsigned char>(c);
        for (const char part : {'%', "0123456789ABCDEF"[byte / 16], "0123456789ABCDEF"[byte % 16]}) result += part;
    }
    return result;
}

void append_data(std::string& text, double value) {
    constexpr double large = 1e300;
    append(text, std::isfinite(value) ? value : value < 0 ? -large : large, 9);
}

void append_array(std::string& text, const VtkArray& array) {
    if (array.components == 1) text += "SCALARS " + encoded(array.name) + " double 1\nLOOKUP_TABLE default\n";
    else text += "VECTORS " + encoded(array.name) + " double\n";
    const int shown = array.components == 1 ? 1 : 3;
    for (std::size_t i = 0; i < array.value.size(); i += array.components)
        for (int k = 0; k < shown; ++k) {
            if (k < array.components) append_data(text, array.value[i + k]);
            else text += '0';
            text += k + 1 < shown ? ' ' : '\n';
        }
}

void append_arrays(std::string& text, const std::string& kind, std::size_t count, const std::vector<VtkArray>& arrays) {
    if (arrays.empty()) return;
    text += kind + std::to_string(count) + "\n";
    for (const VtkArray& array : arrays) append_array(text, array);
}

void append_cells(std::string& text, const std::vector<int>& cells, int cell_dim, int degree) {
    const std::vector<int> order = vtk_node_order(cell_dim, degree);
    const std::size_t count = cells.size() / order.size();
    text += "CELLS " + std::to_string(count) + " " + std::to_string(count * (order.size() + 1)) + "\n";
    const std::string size = std::to_string(order.size());
    for (std::size_t c = 0; c < count; ++c) {
        text += size;
        for (int local : order) {
            text += ' ';
            append(text, static_cast<long long>(cells[c * order.size() + local]));
        }
        text += '\n';
    }
    const std::string type = std::to_string(vtk_cell_type(cell_dim, degree)) + "\n";
    text += "CELL_TYPES " + std::to_string(count) + "\n";
    for (std::size_t c = 0; c < count; ++c) text += type;
}

}  // namespace

std::vector<int> vtk_node_order(int cell_dim, int degree) {
    const LagrangeBasis gmsh(cell_dim, degree);
    std::vector<int> order;
    for (const MultiIndex& a : cell_dim == 3 ? vtk_tetrahedron(degree) : gmsh.nodes) order.push_back(gmsh.find(a));
    return order;
}

std::string vtk_text(const std::string& title, int dim, int degree, const std::vector<double>& positions,
                     const std::vector<int>& cells, int cell_dim, const std::vector<VtkArray>& point_data,
                     const std::vector<VtkArray>& cell_data,
                     const std::vector<std::pair<std::string, std::string>>& provenance) {
    std::string text = "# vtk DataFile Version 3.0\n" + title.substr(0, std::min<std::size_t>(title.find('\n'), 255));
    text += "\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    if (!provenance.empty()) text += "FIELD FieldData " + std::to_string(provenance.size()) + "\n";
    for (const auto& [name, value] : provenance) text += encoded(name) + " 1 1 string\n" + encoded(value) + "\n";
    const std::size_t nodes = positions.size() / dim;
    text += "POINTS " + std::to_string(nodes) + " double\n";
    for (std::size_t i = 0; i < nodes; ++i)
        for (int a = 0; a < 3; ++a) {
            append(text, a < dim ? positions[i * dim + a] : 0.0);
            text += a < 2 ? ' ' : '\n';
        }
    append_cells(text, cells, cell_dim, degree);
    append_arrays(text, "POINT_DATA ", nodes, point_data);
    append_arrays(text, "CELL_DATA ", cells.size() / simplex_node_count(cell_dim, degree), cell_data);
    return text;
}

void write_vtk(const std::string& path, const std::string& title, int dim, int degree,
               const std::vector<double>& positions, const std::vector<int>& cells, int cell_dim,
               const std::vector<VtkArray>& point_data, const std::vector<VtkArray>& cell_data,
               const std::vector<std::pair<std::string, std::string>>& provenance) {
    write_file(path, vtk_text(title, dim, degree, positions, cells, cell_dim, point_data, cell_data, provenance));
}

}  // namespace almesh
