// The sections of the mesh in the order of the file that it comes from, between what that file has besides them. Each
// zone has nodes and elements of its own, numbered from 0.
#include <algorithm>
#include <map>

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
    FileMarker of_file;
    std::vector<MarkerFace> faces{};
};

struct Zone {
    std::vector<int> nodes{}, elements{};
    std::vector<Marker> markers{};

    Marker& marker(const std::string& group) {
        const auto is_it = [&](const Marker& marker) { return marker.of_file.group == group; };
        const auto found = std::find_if(markers.begin(), markers.end(), is_it);
        return found != markers.end() ? *found : markers.emplace_back(Marker{{group, group}});
    }
};

struct Su2Writer {
    const TextSink& sink;
    const Mesh& mesh;
    const std::vector<double>& x;
    std::vector<FilePiece> pieces = mesh.file.pieces;
    std::vector<Zone> zones{};
    std::map<const CellType*, std::vector<int>> orders{};  // of nodes
    std::vector<int> number = std::vector<int>(mesh.nodes());  // of each node in its zone

    void write() {
        if (pieces.empty())
            pieces = {{concat("NDIME= ", mesh.dim, "\n")}, {"NELEM", 1}, {"NPOIN", 1}, {"NMARK", 1}};
        for (const CellType& cell : cell_types()) orders[&cell] = su2_node_order(cell, mesh.degree);
        zones.resize(mesh.file.zones);
        for (const FilePiece& piece : pieces)
            for (const FileMarker& marker : piece.markers) zones[piece.zone - 1].markers.push_back({marker});
        fill_elements();
        fill_markers();
        if (!mesh.file.comment.empty()) sink("% " + mesh.file.comment + "\n");
        for (const FilePiece& piece : pieces) {
            if (piece.zone == 0) sink(piece.text);
            else if (piece.text == "NELEM") write_elements(zones[piece.zone - 1]);
            else if (piece.text == "NPOIN") write_nodes(zones[piece.zone - 1]);
            else write_markers(zones[piece.zone - 1]);
        }
    }

    Zone& zone_of(int element) { return zones[std::max(mesh.file.zone(element), 1) - 1]; }

    void fill_elements() {
        std::vector<int> element_of(mesh.nodes());
        for (int e = 0; e < mesh.element_count(); ++e) {
            zone_of(e).elements.push_back(e);
            for (int k = 0; k < mesh.element_nodes(e); ++k) element_of[mesh.element(e)[k]] = e;
        }
        const std::vector<long long>& id = mesh.file.element_id;
        for (Zone& zone : zones)  // in the file's order, not that of the groups
            if (!mesh.is_simplicial())
                std::stable_sort(zone.elements.begin(), zone.elements.end(),
                                 [&](int e, int f) { return id[e] < id[f]; });
        for (int i = 0; i < mesh.nodes(); ++i) zone_of(element_of[i]).nodes.push_back(i);
        if (!mesh.file.pieces.empty()) add_loose_nodes();
        for (const Zone& zone : zones)
            for (int k = 0; k < static_cast<int>(zone.nodes.size()); ++k)
                if (zone.nodes[k] >= 0) number[zone.nodes[k]] = k;
    }

    // Those that the file has without an element keep their numbers, which other lines of it may know.
    void add_loose_nodes() {
        const std::vector<LooseNode>& loose = mesh.file.loose;
        const auto id = [&](int i) { return i < 0 ? loose[-1 - i].id : mesh.file.node_id[i]; };
        for (int k = 0; k < static_cast<int>(loose.size()); ++k)
            zones[zones.size() > 1 ? loose[k].entity.tag - 1 : 0].nodes.push_back(-1 - k);
        for (Zone& zone : zones)
            std::sort(zone.nodes.begin(), zone.nodes.end(), [&](int i, int j) { return id(i) < id(j); });
    }

    // The boundaries, and the tagged faces inside the mesh.
    void fill_markers() {
        for (const auto& [cell, first, count, start] : faces_in_file(mesh))
            for (int f = first; f < first + count; ++f)
                zone_of(mesh.face_element[f])
                    .marker(group_name(mesh.file.groups, mesh.dim - 1, mesh.file.face_physical[f]))
                    .faces.push_back({mesh.file.face_id[f], cell, mesh.face(f)});
        for (const KeptFace& face : kept_faces(mesh))
            if (face.physical)
                zone_of(face.element)
                    .marker(group_name(mesh.file.groups, mesh.dim - 1, face.physical))
                    .faces.push_back({face.id, face.cell, face.nodes});
        if (mesh.groups_of_faces.empty()) return;
        for (Zone& zone : zones)  // in the file's order
            for (Marker& marker : zone.markers)
                std::stable_sort(marker.faces.begin(), marker.faces.end(),
                                 [](const MarkerFace& a, const MarkerFace& b) { return a.id < b.id; });
    }

    void append_cell(std::string& text, const CellType& cell, const int* node) const {
        append(text, static_cast<long long>(cell.vtk_types[0] + 100 * (mesh.degree - 1)));
        for (const int i : orders.at(&cell)) {
            text += ' ';
            append(text, static_cast<long long>(number[node[i]]));
        }
    }

    void write_elements(const Zone& zone) const {
        sink(concat("NELEM= ", zone.elements.size(), "\n"));
        append_rows(sink, static_cast<int>(zone.elements.size()), [&](std::string& text, int e) {
            append_cell(text, mesh.cell(zone.elements[e]), mesh.element(zone.elements[e]));
            text += ' ';
            append(text, static_cast<long long>(e));
            text += '\n';
        });
    }

    void write_nodes(const Zone& zone) const {
        sink(concat("NPOIN= ", zone.nodes.size(), "\n"));
        append_rows(sink, static_cast<int>(zone.nodes.size()), [&](std::string& text, int i) {
            const int node = zone.nodes[i];
            const double* const at = node < 0 ? mesh.file.loose[-1 - node].x.data() : point(x, node, mesh.dim);
            for (int a = 0; a < mesh.dim; ++a) {
                append(text, at[a]);
                text += ' ';
            }
            append(text, static_cast<long long>(i));
            text += '\n';
        });
    }

    void write_markers(const Zone& zone) const {
        sink(concat("NMARK= ", zone.markers.size(), "\n"));
        for (const auto& [of_file, faces] : zone.markers) {
            sink(concat("MARKER_TAG= ", of_file.name, "\nMARKER_ELEMS= ", faces.size() + of_file.points, "\n"));
            sink(of_file.lines);
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
