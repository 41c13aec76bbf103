#include <algorithm>
#include <map>
#include <numeric>

#include "base/files.hpp"
#include "base/text.hpp"
#include "io/foreign_cells.hpp"
#include "io/su2.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

struct MarkerFace {
    long long id;
    const CellType* cell;
    const int* nodes;
};

struct Marker {
    std::string name;
    std::vector<MarkerFace> faces{};
};

struct Su2Writer {
    const TextSink& sink;
    const Mesh& mesh;
    const std::vector<double>& x;
    std::vector<Marker> markers{};
    std::map<const CellType*, std::vector<int>> orders{};  // of nodes

    void write() {
        for (const CellType& cell : cell_types()) orders[&cell] = su2_node_order(cell, mesh.degree);
        fill_markers();
        if (!mesh.file.comment.empty()) sink("% " + mesh.file.comment + "\n");
        sink(concat("NDIME= ", mesh.dim, "\n"));
        write_elements();
        write_nodes();
        write_markers();
    }

    Marker& marker(const std::string& name) {
        Marker* const found = find_row(markers, name);
        return found ? *found : markers.emplace_back(Marker{name});
    }

    // The boundaries, and the tagged faces inside the mesh; a marker of a file without faces stays.
    void fill_markers() {
        const auto name_of = [&](int tag) { return group_name(mesh.file.groups, mesh.dim - 1, tag); };
        for (const PhysicalGroup& group : mesh.file.groups)
            if (group.dim == mesh.dim - 1 && mesh.file.format.ending == ".su2") marker(group.name);
        for (const auto& [cell, first, count, start] : faces_in_file(mesh))
            for (int f = first; f < first + count; ++f)
                if (const int tag = mesh.file.face_physical[f])
                    marker(name_of(tag)).faces.push_back({mesh.file.face_id[f], cell, mesh.face(f)});
        for (const KeptFace& face : kept_faces(mesh))
            if (face.physical) marker(name_of(face.physical)).faces.push_back({face.id, face.cell, face.nodes});
        if (mesh.groups_of_faces.empty()) return;
        for (Marker& one : markers)  // in the file's order
            std::stable_sort(one.faces.begin(), one.faces.end(),
                             [](const MarkerFace& a, const MarkerFace& b) { return a.id < b.id; });
    }

    void append_cell(std::string& text, const CellType& cell, const int* node) const {
        append(text, static_cast<long long>(cell.vtk_types[0] + 100 * (mesh.degree - 1)));
        for (const int i : orders.at(&cell)) append(text += ' ', static_cast<long long>(node[i]));
    }

    void write_elements() const {
        std::vector<int> elements(mesh.element_count());
        std::iota(elements.begin(), elements.end(), 0);
        const std::vector<long long>& id = mesh.file.element_id;
        if (!mesh.is_simplicial())  // in the file's order, not that of the groups
            std::stable_sort(elements.begin(), elements.end(), [&](int e, int f) { return id[e] < id[f]; });
        sink(concat("NELEM= ", elements.size(), "\n"));
        append_rows(sink, mesh.element_count(), [&](std::string& text, int e) {
            append_cell(text, mesh.cell(elements[e]), mesh.element(elements[e]));
            append(text += ' ', static_cast<long long>(e));
            text += '\n';
        });
    }

    void write_nodes() const {
        sink(concat("NPOIN= ", mesh.nodes(), "\n"));
        append_rows(sink, mesh.nodes(), [&](std::string& text, int i) {
            for (int a = 0; a < mesh.dim; ++a) {
                append(text, point(x, i, mesh.dim)[a]);
                text += ' ';
            }
            append(text, static_cast<long long>(i));
            text += '\n';
        });
    }

    void write_markers() const {
        sink(concat("NMARK= ", markers.size(), "\n"));
        for (const auto& [name, faces] : markers) {
            sink(concat("MARKER_TAG= ", name, "\nMARKER_ELEMS= ", faces.size(), "\n"));
            append_rows(sink, static_cast<int>(faces.size()), [&, &nodes = faces](std::string& text, int k) {
                append_cell(text, *nodes[k].cell, nodes[k].nodes);
                text += '\n';
            });
        }
    }
};

}  // namespace

void write_su2(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    write_file(path, [&](const TextSink& sink) { Su2Writer{sink, mesh, x}.write(); });
}

}  // namespace almesh
