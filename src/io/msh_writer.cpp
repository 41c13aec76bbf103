#include "io/msh_writer.hpp"

#include <algorithm>
#include <utility>

#include "base/files.hpp"
#include "io/msh_types.hpp"

namespace almesh {
namespace {

// The boundary faces, or the elements, of a mesh.
struct Cells {
    int dim, count, nodes;  // nodes of one cell
    const std::vector<int>& node;
    const std::vector<long long>& id;
    const std::vector<int>&physical, &entity;

    const int* cell(int c) const { return node.data() + static_cast<std::size_t>(c) * nodes; }
};

Cells faces_of(const Mesh& m) {
    return {m.dim - 1,      m.face_count(),       m.face_nodes(), m.faces,
            m.file.face_id, m.file.face_physical, m.file.face_entity};
}

Cells elements_of(const Mesh& m) {
    return {m.dim,        m.element_count(),  m.element_nodes(), m.elements,
            m.file.element_id, m.file.element_physical, m.file.element_entity};
}

void append_row(std::string& text, std::initializer_list<long long> numbers) {
    for (const long long number : numbers) {
        append(text, number);
        text += ' ';
    }
    text.back() = '\n';
}

std::string row_of(std::initializer_list<long long> numbers) {
    std::string text;
    append_row(text, numbers);
    return text;
}

void append_position(std::string& text, const Mesh& mesh, const std::vector<double>& x, int node) {
    for (int a = 0; a < 3; ++a) {
        append(text, a < mesh.dim ? x[static_cast<std::size_t>(node) * mesh.dim + a] : 0.0);
        text += a < 2 ? ' ' : '\n';
    }
}

// Behind what the row holds already.
void append_cell_nodes(std::string& text, const Mesh& mesh, const Cells& cells, int c) {
    for (int k = 0; k < cells.nodes; ++k) {
        text.back() = ' ';
        append(text, mesh.file.node_id[cells.cell(c)[k]]);
        text += '\n';
    }
}

void append_header(const TextSink& sink, const Mesh& mesh) {
    sink(mesh.file.msh_version == 41 ? "$MeshFormat\n4.1" : "$MeshFormat\n2.2");
    sink(" 0 8\n$EndMeshFormat\n");
    if (mesh.file.groups.empty()) return;
    sink("$PhysicalNames\n" + std::to_string(mesh.file.groups.size()) + "\n");
    for (const PhysicalGroup& group : mesh.file.groups)
        sink(std::to_string(group.dim) + " " + std::to_string(group.tag) + " \"" + group.name + "\"\n");
    sink("$EndPhysicalNames\n");
}

void append_body_2_2(const TextSink& sink, const Mesh& mesh, const std::vector<double>& x) {
    sink("$Nodes\n" + std::to_string(mesh.nodes()) + "\n");
    append_rows(sink, mesh.nodes(), [&](std::string& part, int i) {
        append(part, mesh.file.node_id[i]);
        part += ' ';
        append_position(part, mesh, x, i);
    });
    sink("$EndNodes\n$Elements\n" + std::to_string(mesh.face_count() + mesh.element_count()) + "\n");
    for (const Cells& cells : {faces_of(mesh), elements_of(mesh)}) {
        const int type = msh_type(cells.dim, mesh.degree);
        append_rows(sink, cells.count, [&](std::string& part, int c) {
            append_row(part, {cells.id[c], type, 2, cells.physical[c], cells.entity[c]});
            append_cell_nodes(part, mesh, cells, c);
        });
    }
    sink("$EndElements\n");
}

// MSH 4.1 hangs the physical tag on the elementary entity: an entity, its cells and the nodes listed with it.
struct Block {
    int dim, entity, physical;
    std::vector<int> cells, nodes;
};

// By ascending (entity, physical). An entity of several physical tags (possible in MSH 2.2) becomes several entities.
std::vector<Block> blocks_of(const Cells& cells) {
    std::vector<std::pair<int, int>> keys;
    for (int c = 0; c < cells.count; ++c) {
        const std::pair key(cells.entity[c], cells.physical[c]);
        if (keys.empty() || keys.back() != key) keys.push_back(key);
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<Block> blocks;
    int next = keys.empty() ? 1 : keys.back().first + 1;
    for (const auto& [entity, physical] : keys) {
        const bool taken = !blocks.empty() && entity == keys[blocks.size() - 1].first;
        blocks.push_back({cells.dim, taken ? next++ : entity, physical, {}, {}});
    }
    for (int c = 0; c < cells.count; ++c) {
        const auto key = std::lower_bound(keys.begin(), keys.end(), std::pair(cells.entity[c], cells.physical[c]));
        blocks[key - keys.begin()].cells.push_back(c);
    }
    return blocks;
}

// Each node goes to the first block that has it: those on the boundary to the boundary's.
void collect_nodes(const Cells& cells, std::vector<Block>& blocks, std::vector<char>& is_listed) {
    for (Block& block : blocks) {
        for (int c : block.cells)
            for (int k = 0; k < cells.nodes; ++k) {
                const int node = cells.cell(c)[k];
                if (!is_listed[node]) block.nodes.push_back(node);
                is_listed[node] = 1;
            }
        std::sort(block.nodes.begin(), block.nodes.end());
    }
}

std::string entity_text(const Mesh& mesh, const std::vector<double>& x, const Cells& cells, const Block& block) {
    double low[3] = {}, high[3] = {};
    for (int a = 0; a < mesh.dim; ++a) {
        low[a] = high[a] = x[static_cast<std::size_t>(cells.cell(block.cells[0])[0]) * mesh.dim + a];
        for (int c : block.cells)
            for (int k = 0; k < cells.nodes; ++k) {
                const double coordinate = x[static_cast<std::size_t>(cells.cell(c)[k]) * mesh.dim + a];
                low[a] = std::min(low[a], coordinate);
                high[a] = std::max(high[a], coordinate);
            }
    }
    std::string text = std::to_string(block.entity);
    for (const double* corner : {low, high})
        for (int a = 0; a < 3; ++a) {
            text += ' ';
            append(text, corner[a]);
        }
    if (block.physical) append_row(text += ' ', {1, block.physical, 0});
    else append_row(text += ' ', {0, 0});
    return text;
}

void append_body_4_1(const TextSink& sink, const Mesh& mesh, const std::vector<double>& x) {
    const Cells cells[2] = {faces_of(mesh), elements_of(mesh)};
    std::vector<Block> blocks[2] = {blocks_of(cells[0]), blocks_of(cells[1])};
    std::vector<char> is_listed(mesh.nodes(), 0);
    for (int k : {0, 1}) collect_nodes(cells[k], blocks[k], is_listed);
    const auto faces = static_cast<long long>(blocks[0].size()), elements = static_cast<long long>(blocks[1].size());

    sink("$Entities\n");
    if (mesh.dim == 2) sink(row_of({0, faces, elements, 0}));
    else sink(row_of({0, 0, faces, elements}));
    for (int k : {0, 1})
        for (const Block& block : blocks[k]) sink(entity_text(mesh, x, cells[k], block));

    const auto [node_low, node_high] = std::minmax_element(mesh.file.node_id.begin(), mesh.file.node_id.end());
    sink("$EndEntities\n$Nodes\n");
    sink(row_of({faces + elements, mesh.nodes(), *node_low, *node_high}));
    for (const auto& of_dim : blocks)
        for (const Block& block : of_dim) {
            const int count = static_cast<int>(block.nodes.size());
            sink(row_of({block.dim, block.entity, 0, count}));
            const std::vector<int>& node = block.nodes;
            append_rows(sink, count, [&](std::string& part, int k) { append_row(part, {mesh.file.node_id[node[k]]}); });
            append_rows(sink, count, [&](std::string& part, int k) { append_position(part, mesh, x, node[k]); });
        }

    std::vector<long long> id = mesh.file.face_id;
    id.insert(id.end(), mesh.file.element_id.begin(), mesh.file.element_id.end());
    const auto [id_low, id_high] = std::minmax_element(id.begin(), id.end());
    sink("$EndNodes\n$Elements\n");
    sink(row_of({faces + elements, static_cast<long long>(id.size()), *id_low, *id_high}));
    for (int k : {0, 1})
        for (const Block& block : blocks[k]) {
            const int count = static_cast<int>(block.cells.size());
            sink(row_of({block.dim, block.entity, msh_type(block.dim, mesh.degree), count}));
            append_rows(sink, count, [&](std::string& part, int j) {
                append_row(part, {cells[k].id[block.cells[j]]});
                append_cell_nodes(part, mesh, cells[k], block.cells[j]);
            });
        }
    sink("$EndElements\n");
}

void write_text(const TextSink& sink, const Mesh& mesh, const std::vector<double>& x) {
    append_header(sink, mesh);
    if (mesh.file.msh_version == 41) append_body_4_1(sink, mesh, x);
    else append_body_2_2(sink, mesh, x);
}

}  // namespace

std::string msh_text(const Mesh& mesh, const std::vector<double>& x) {
    std::string text;
    write_text([&](std::string_view piece) { text += piece; }, mesh, x);
    return text;
}

void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    write_file(path, [&](const TextSink& sink) { write_text(sink, mesh, x); });
}

}  // namespace almesh
