// MSH 2.2 in text: a list of nodes and one of cells, those kept, boundary faces and elements, each with its physical
// and its elementary tag.
#include <algorithm>
#include <set>

#include "base/files.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "io/msh.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

// Cells of one type, whose arrays live elsewhere.
struct MshCells {
    int dim, type, width;        // width: nodes of one cell
    std::span<const int> nodes;  // count x width
    std::span<const long long> id;
    std::span<const int> physical, entity;  // physical: empty where entities are the names

    int physical_of(int c) const { return physical.empty() ? 0 : physical[c]; }
    int count() const { return static_cast<int>(id.size()); }
    std::span<const int> nodes_of(int c) const { return nodes.subspan(offset(c, width), width); }
};

std::vector<MshCells> cells_of(const Mesh& mesh) {
    const FileTags& file = mesh.file;
    std::vector<MshCells> all;
    std::array<bool, 4> is_named_by_entity{};
    for (const PhysicalGroup& group : file.groups) is_named_by_entity[group.dim] |= group.is_entity;
    const auto append = [&](const CellType& cell, std::span<const int> nodes, std::span<const long long> id,
                            std::span<const int> physical, std::span<const int> entity) {
        const int degree = cell.dim == 0 ? 1 : mesh.degree;
        all.push_back({cell.dim, cell.msh_types[degree - 1], cell.node_count(degree), nodes, id,
                       is_named_by_entity[cell.dim] ? std::span<const int>() : physical, entity});
    };
    for (const KeptCells& kept : mesh.kept)
        if (kept.count() > 0) append(mesh.cell_of(kept), kept.nodes, kept.id, kept.physical, kept.entity);
    const auto append_groups = [&](const std::vector<ElementGroup>& groups, std::span<const int> nodes,
                                   std::span<const long long> id, std::span<const int> physical,
                                   std::span<const int> entity) {
        for (const auto& [cell, first, count, start] : groups)
            append(*cell, nodes.subspan(start, offset(count, cell->node_count(mesh.degree))), id.subspan(first, count),
                   physical.subspan(first, count), entity.subspan(first, count));
    };
    append_groups(faces_in_file(mesh), mesh.faces, file.face_id, file.face_physical, file.face_entity);
    append_groups(mesh.element_groups(), mesh.elements, file.element_id, file.element_physical, file.element_entity);
    return all;
}

// Cells of entities with several physical groups, each once more for each further group, with a new id.
KeptCells copies_of(const Mesh& mesh, const std::vector<MshCells>& all, const MshCells& cells,
                    UnusedIds<long long>& unused) {
    std::set<std::array<int, 2>> known;  // entity and group of cells that are there by themselves
    for (const MshCells& some : all)
        for (int c = 0; c < some.count() && some.dim == cells.dim; ++c)
            known.insert({some.entity[c], some.physical_of(c)});
    KeptCells copies;
    for (int c = 0; c < cells.count(); ++c) {
        const FileEntity* const own = find_entity(mesh.file.entities, cells.dim, cells.entity[c]);
        if (!own || own->physical.empty() || own->physical[0] != cells.physical_of(c)) continue;
        for (const int tag : std::span(own->physical).subspan(1)) {
            if (known.contains({cells.entity[c], tag})) continue;
            const std::span<const int> of_cell = cells.nodes_of(c);
            copies.nodes.insert(copies.nodes.end(), of_cell.begin(), of_cell.end());
            append_tags({{}, {-1}, {unused.next()}, {tag}, {cells.entity[c]}}, 0, copies);
        }
    }
    return copies;
}

void write(const TextSink& sink, const Mesh& mesh, const std::vector<double>& x) {
    const FileTags& file = mesh.file;
    const long long shift = 1 - file.format.first_id();  // ids are positive in MSH
    const auto number = [](std::string& text, auto value) { append(text += ' ', value); };
    sink("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
    std::string names;
    const auto is_named = [](const PhysicalGroup& group) { return !group.is_entity; };
    for (const PhysicalGroup& group : file.groups)
        if (is_named(group)) names += concat(group.dim, " ", group.tag, " \"", group.name, "\"\n");
    if (!names.empty())
        sink(concat("$PhysicalNames\n", std::count_if(file.groups.begin(), file.groups.end(), is_named), "\n", names,
                    "$EndPhysicalNames\n"));
    sink(concat("$Nodes\n", mesh.nodes(), "\n"));
    append_rows(sink, mesh.nodes(), [&](std::string& text, int i) {
        append(text, file.node_id[i] + shift);
        for (int a = 0; a < 3; ++a) number(text, a < mesh.dim ? point(x, i, mesh.dim)[a] : file.z);
        text += '\n';
    });
    sink("$EndNodes\n");

    std::vector<MshCells> all = cells_of(mesh);
    std::vector<long long> ids;
    for (const MshCells& cells : all) ids.insert(ids.end(), cells.id.begin(), cells.id.end());
    std::size_t count = ids.size();
    UnusedIds<long long> unused(std::move(ids));
    std::vector<KeptCells> copies;
    for (const MshCells& cells : all)
        if (!file.entities.empty()) copies.push_back(copies_of(mesh, all, cells, unused));
    for (std::size_t k = 0; k < copies.size(); ++k) {
        const KeptCells& copy = copies[k];
        count += copy.id.size();
        all.push_back({all[k].dim, all[k].type, all[k].width, copy.nodes, copy.id, copy.physical, copy.entity});
    }
    sink(concat("$Elements\n", count, "\n"));
    for (const MshCells& cells : all)
        append_rows(sink, cells.count(), [&](std::string& text, int c) {
            append(text, cells.id[c] + shift);
            for (const long long tag : {cells.type, 2, cells.physical_of(c), cells.entity[c]}) number(text, tag);
            for (const int node : cells.nodes_of(c)) number(text, file.node_id[node] + shift);
            text += '\n';
        });
    sink("$EndElements\n");
    if (!file.comment.empty()) sink("$Comments\n" + file.comment + "\n$EndComments\n");
}

}  // namespace

std::string msh_text(const Mesh& mesh, const std::vector<double>& x) {
    std::string text;
    write([&](std::string_view piece) { text += piece; }, mesh, x);
    return text;
}

void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    write_file(path, [&](const TextSink& sink) { write(sink, mesh, x); });
}

}  // namespace almesh
