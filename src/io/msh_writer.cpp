// MSH 2.2 has a list of nodes and one of elements, each element with its tags. MSH 4.1 has a block of nodes and one of
// elements for each elementary entity, which carries the physical tag.
#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "base/files.hpp"
#include "base/text.hpp"
#include "io/msh.hpp"

namespace almesh {
namespace {

// The boundary faces, or the elements, of a mesh.
struct Cells {
    int dim, type, count, width;  // width: nodes of one cell
    const std::vector<int>& nodes;
    const std::vector<long long>& id;
    const std::vector<int>&physical, &entity;

    std::span<const int> nodes_of(int c) const { return std::span(nodes).subspan(offset(c, width), width); }
};

// An elementary entity with its cells and the nodes that are listed with it.
struct Block {
    const Cells& of;
    int entity, physical;
    std::vector<int> cells, nodes;
};

// Appends each number with a blank behind it.
void append_all(std::string& text, std::initializer_list<long long> numbers) {
    for (const long long number : numbers) {
        append(text, number);
        text += ' ';
    }
}

std::string row(std::initializer_list<long long> numbers) {
    std::string text;
    append_all(text, numbers);
    text.back() = '\n';
    return text;
}

// Row of MSH 4.1 that begins $Nodes or $Elements.
std::string counts_row(const std::vector<Block>& blocks, const std::vector<long long>& id) {
    const auto [low, high] = std::minmax_element(id.begin(), id.end());
    return row({static_cast<long long>(blocks.size()), static_cast<long long>(id.size()), *low, *high});
}

// Blocks by ascending (entity, physical). An entity of several physical tags (possible in MSH 2.2) becomes several
// entities. Each node goes to the first block that has it.
void append_blocks(std::vector<Block>& blocks, const Cells& of, std::vector<char>& is_listed) {
    std::map<int, std::map<int, std::vector<int>>> entities;  // cells by entity and physical tag
    for (int c = 0; c < of.count; ++c) entities[of.entity[c]][of.physical[c]].push_back(c);
    int unused = entities.empty() ? 1 : entities.rbegin()->first + 1;
    for (auto& [entity, parts] : entities)
        for (auto& [physical, cells] : parts) {
            const bool is_first = physical == parts.begin()->first;
            Block& block = blocks.emplace_back(Block{of, is_first ? entity : unused++, physical, std::move(cells), {}});
            for (int c : block.cells)
                for (int node : of.nodes_of(c))
                    if (!std::exchange(is_listed[node], 1)) block.nodes.push_back(node);
            std::sort(block.nodes.begin(), block.nodes.end());
        }
}

struct MshWriter {
    const TextSink& sink;
    const Mesh& mesh;
    const std::vector<double>& x;
    const FileTags& file = mesh.file;
    const Cells faces{mesh.dim - 1, simplex(mesh.dim - 1).msh_types[mesh.degree - 1], mesh.face_count(),
                      mesh.face_nodes(), mesh.faces, file.face_id, file.face_physical, file.face_entity};
    const Cells elements{mesh.dim, mesh.cell().msh_types[mesh.degree - 1], mesh.element_count(),
                         mesh.element_nodes(), mesh.elements, file.element_id, file.element_physical,
                         file.element_entity};

    void write() const {
        sink(file.format.msh_version == 41 ? "$MeshFormat\n4.1" : "$MeshFormat\n2.2");
        sink(" 0 8\n$EndMeshFormat\n");
        if (!file.groups.empty()) {
            sink("$PhysicalNames\n" + row({static_cast<long long>(file.groups.size())}));
            for (const PhysicalGroup& group : file.groups)
                sink(concat(group.dim, " ", group.tag, " \"", group.name, "\"\n"));
            sink("$EndPhysicalNames\n");
        }
        if (file.format.msh_version == 41) body_4_1();
        else body_2_2();
    }

    void body_2_2() const {
        sink("$Nodes\n" + row({mesh.nodes()}));
        append_rows(sink, mesh.nodes(), [&](std::string& part, int i) {
            append_all(part, {file.node_id[i]});
            append_position(part, i);
        });
        sink("$EndNodes\n$Elements\n" + row({faces.count + elements.count}));
        for (const Cells* cells : {&faces, &elements})
            append_rows(sink, cells->count, [&](std::string& part, int c) {
                append_all(part, {cells->id[c], cells->type, 2, cells->physical[c], cells->entity[c]});
                append_nodes(part, cells->nodes_of(c));
            });
        sink("$EndElements\n");
    }

    void body_4_1() const {
        std::vector<Block> blocks;
        std::vector<char> is_listed(mesh.nodes(), 0);
        append_blocks(blocks, faces, is_listed);
        const auto face_blocks = static_cast<long long>(blocks.size());
        append_blocks(blocks, elements, is_listed);
        const long long element_blocks = static_cast<long long>(blocks.size()) - face_blocks;
        sink("$Entities\n");
        sink(mesh.dim == 2 ? row({0, face_blocks, element_blocks, 0}) : row({0, 0, face_blocks, element_blocks}));
        for (const Block& block : blocks) sink(entity_row(block));

        sink("$EndEntities\n$Nodes\n" + counts_row(blocks, file.node_id));
        for (const Block& block : blocks) {
            const int count = static_cast<int>(block.nodes.size());
            sink(row({block.of.dim, block.entity, 0, count}));
            append_rows(sink, count, [&](std::string& part, int i) { append_nodes(part, {&block.nodes[i], 1}); });
            append_rows(sink, count, [&](std::string& part, int i) { append_position(part, block.nodes[i]); });
        }

        std::vector<long long> id = file.face_id;
        id.insert(id.end(), file.element_id.begin(), file.element_id.end());
        sink("$EndNodes\n$Elements\n" + counts_row(blocks, id));
        for (const Block& block : blocks) {
            const int count = static_cast<int>(block.cells.size());
            sink(row({block.of.dim, block.entity, block.of.type, count}));
            append_rows(sink, count, [&](std::string& part, int i) {
                append_all(part, {block.of.id[block.cells[i]]});
                append_nodes(part, block.of.nodes_of(block.cells[i]));
            });
        }
        sink("$EndElements\n");
    }

    // Tag, bounding box and physical tag; the bounding entities are left out.
    std::string entity_row(const Block& block) const {
        double low[3] = {}, high[3] = {};
        for (int a = 0; a < mesh.dim; ++a) {
            low[a] = high[a] = x[offset(block.of.nodes_of(block.cells[0])[0], mesh.dim, a)];
            for (int c : block.cells)
                for (int node : block.of.nodes_of(c)) {
                    low[a] = std::min(low[a], x[offset(node, mesh.dim, a)]);
                    high[a] = std::max(high[a], x[offset(node, mesh.dim, a)]);
                }
        }
        std::string text = std::to_string(block.entity);
        for (const double* corner : {low, high})
            for (int a = 0; a < 3; ++a) append(text += ' ', corner[a]);
        return text + ' ' + (block.physical ? row({1, block.physical, 0}) : row({0, 0}));
    }

    void append_position(std::string& text, int node) const {
        for (int a = 0; a < 3; ++a) {
            append(text, a < mesh.dim ? x[offset(node, mesh.dim, a)] : 0.0);
            text += a < 2 ? ' ' : '\n';
        }
    }

    void append_nodes(std::string& text, std::span<const int> nodes) const {
        for (int node : nodes) append_all(text, {file.node_id[node]});
        text.back() = '\n';
    }
};

}  // namespace

std::string msh_text(const Mesh& mesh, const std::vector<double>& x) {
    std::string text;
    const TextSink sink = [&](std::string_view piece) { text += piece; };
    MshWriter{sink, mesh, x}.write();
    return text;
}

void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    write_file(path, [&](const TextSink& sink) { MshWriter{sink, mesh, x}.write(); });
}

}  // namespace almesh
