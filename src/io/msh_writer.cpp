// MSH 2.2 has a list of nodes and one of elements, each element with its tags. MSH 4.1 has a block of nodes and one of
// elements for each elementary entity, which carries the physical tag.
#include <algorithm>
#include <map>
#include <utility>

#include "base/files.hpp"
#include "io/msh.hpp"

namespace almesh {
namespace {

// The boundary faces, or the elements, of a mesh.
struct Cells {
    int dim, degree, count, nodes;  // nodes of one cell
    const std::vector<int>& node;
    const std::vector<long long>& id;
    const std::vector<int>&physical, &entity;

    const int* cell(int c) const { return node.data() + offset(c, nodes); }
    int type() const { return simplex(dim).msh_types[degree - 1]; }
};

Cells faces_of(const Mesh& m) {
    return {m.dim - 1, m.degree,       m.face_count(),       m.face_nodes(),
            m.faces,   m.file.face_id, m.file.face_physical, m.file.face_entity};
}

Cells elements_of(const Mesh& m) {
    return {m.dim,      m.degree,          m.element_count(),       m.element_nodes(),
            m.elements, m.file.element_id, m.file.element_physical, m.file.element_entity};
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
        append(text, a < mesh.dim ? x[offset(node, mesh.dim, a)] : 0.0);
        text += a < 2 ? ' ' : '\n';
    }
}

// Continues the row that ends the text.
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
        const int type = cells.type();
        append_rows(sink, cells.count, [&](std::string& part, int c) {
            append_row(part, {cells.id[c], type, 2, cells.physical[c], cells.entity[c]});
            append_cell_nodes(part, mesh, cells, c);
        });
    }
    sink("$EndElements\n");
}

// An elementary entity with its cells and the nodes that are listed with it.
struct Block {
    int entity, physical;
    std::vector<int> cells, nodes;
};

// By ascending (entity, physical). An entity of several physical tags (possible in MSH 2.2) becomes several entities.
// Each node goes to the first block that has it: pass the boundary's cells before the elements.
std::vector<Block> blocks_of(const Cells& cells, std::vector<char>& is_listed) {
    std::map<std::pair<int, int>, std::vector<int>> cells_of;  // by (entity, physical)
    for (int c = 0; c < cells.count; ++c) cells_of[{cells.entity[c], cells.physical[c]}].push_back(c);
    std::vector<Block> blocks;
    int last = 0, unused = cells_of.empty() ? 1 : cells_of.rbegin()->first.first + 1;
    for (auto& [key, of_block] : cells_of) {
        const auto [entity, physical] = key;
        const bool taken = !blocks.empty() && entity == last;
        last = entity;
        blocks.push_back({taken ? unused++ : entity, physical, std::move(of_block), {}});
    }
    for (Block& block : blocks) {
        for (int c : block.cells)
            for (int k = 0; k < cells.nodes; ++k) {
                const int node = cells.cell(c)[k];
                if (!is_listed[node]) block.nodes.push_back(node);
                is_listed[node] = 1;
            }
        std::sort(block.nodes.begin(), block.nodes.end());
    }
    return blocks;
}

std::string entity_text(const Mesh& mesh, const std::vector<double>& x, const Cells& cells, const Block& block) {
    double low[3] = {}, high[3] = {};
    for (int a = 0; a < mesh.dim; ++a) {
        low[a] = high[a] = x[offset(cells.cell(block.cells[0])[0], mesh.dim, a)];
        for (int c : block.cells)
            for (int k = 0; k < cells.nodes; ++k) {
                const double coordinate = x[offset(cells.cell(c)[k], mesh.dim, a)];
                low[a] = std::min(low[a], coordinate);
                high[a] = std::max(high[a], coordinate);
            }
    }
    std::string text = std::to_string(block.entity);
    for (const double* corner : {low, high})
        for (int a = 0; a < 3; ++a) append(text += ' ', corner[a]);
    if (block.physical) append_row(text += ' ', {1, block.physical, 0});
    else append_row(text += ' ', {0, 0});
    return text;
}

void append_body_4_1(const TextSink& sink, const Mesh& mesh, const std::vector<double>& x) {
    const Cells cells[2] = {faces_of(mesh), elements_of(mesh)};
    std::vector<char> is_listed(mesh.nodes(), 0);
    std::vector<Block> blocks[2];
    for (int k : {0, 1}) blocks[k] = blocks_of(cells[k], is_listed);
    const auto faces = static_cast<long long>(blocks[0].size()), elements = static_cast<long long>(blocks[1].size());

    sink("$Entities\n");
    if (mesh.dim == 2) sink(row_of({0, faces, elements, 0}));
    else sink(row_of({0, 0, faces, elements}));
    for (int k : {0, 1})
        for (const Block& block : blocks[k]) sink(entity_text(mesh, x, cells[k], block));

    const std::vector<long long>& node_id = mesh.file.node_id;
    const auto [node_low, node_high] = std::minmax_element(node_id.begin(), node_id.end());
    sink("$EndEntities\n$Nodes\n");
    sink(row_of({faces + elements, mesh.nodes(), *node_low, *node_high}));
    for (int k : {0, 1})
        for (const Block& block : blocks[k]) {
            const std::vector<int>& node = block.nodes;
            const int count = static_cast<int>(node.size());
            sink(row_of({cells[k].dim, block.entity, 0, count}));
            append_rows(sink, count, [&](std::string& part, int i) { append_row(part, {node_id[node[i]]}); });
            append_rows(sink, count, [&](std::string& part, int i) { append_position(part, mesh, x, node[i]); });
        }

    std::vector<long long> id = mesh.file.face_id;
    id.insert(id.end(), mesh.file.element_id.begin(), mesh.file.element_id.end());
    const auto [id_low, id_high] = std::minmax_element(id.begin(), id.end());
    sink("$EndNodes\n$Elements\n");
    sink(row_of({faces + elements, static_cast<long long>(id.size()), *id_low, *id_high}));
    for (int k : {0, 1})
        for (const Block& block : blocks[k]) {
            const int count = static_cast<int>(block.cells.size());
            sink(row_of({cells[k].dim, block.entity, cells[k].type(), count}));
            append_rows(sink, count, [&](std::string& part, int i) {
                append_row(part, {cells[k].id[block.cells[i]]});
                append_cell_nodes(part, mesh, cells[k], block.cells[i]);
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
