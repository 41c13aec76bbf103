// MSH 2.2 has a list of nodes and one of elements, each element with its tags. MSH 4 has a block of nodes and one of
// elements for each elementary entity.
#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "io/msh.hpp"
#include "io/msh_blocks.hpp"

namespace almesh {
namespace {

struct MshWriter {
    const TextSink& sink;
    const Mesh& mesh;
    const std::vector<double>& x;
    const FileFormat format;
    const FileTags& file = mesh.file;
    const MshNumbers numbers{format, 1 - file.format.first_id()};
    const bool is_4_1 = format.msh_version == 41;

    void write() const {
        header();
        physical_names();
        if (is_4_1) body_4_1();
        else body_2_2();
        if (!file.comment.empty()) sink("$Comments\n" + file.comment + "\n$EndComments\n");
    }

    void header() const {
        std::string text = concat("$MeshFormat\n", is_4_1 ? "4.1" : "2.2", format.binary ? " 1 8\n" : " 0 8\n");
        if (format.binary) numbers.integer(text, 1);  // tells the order of bytes
        sink(text + numbers.end_section("MeshFormat"));
    }

    void physical_names() const {
        std::vector<PhysicalGroup> groups = file.groups;
        std::erase_if(groups, [](const PhysicalGroup& group) { return group.is_entity; });
        if (groups.empty()) return;
        std::string text = concat("$PhysicalNames\n", groups.size(), "\n");
        for (const PhysicalGroup& group : groups)
            text += concat(group.dim, " ", group.tag, " \"", group.name, "\"\n");
        sink(text + "$EndPhysicalNames\n");
    }

    void body_2_2() const {
        sink(concat("$Nodes\n", mesh.nodes(), "\n"));
        append_rows(sink, mesh.nodes(), [&](std::string& part, int i) {
            numbers.id(part, file.node_id[i]);
            append_position(part, i);
        });
        sink(numbers.end_section("Nodes"));

        std::vector<MshCells> all = msh_cells(mesh);
        const MshCopies copies = msh_copies(mesh, all);
        all.insert(all.end(), copies.cells.begin(), copies.cells.end());
        int count = 0;
        for (const MshCells& cells : all) count += cells.count();
        sink(concat("$Elements\n", count, "\n"));
        for (const MshCells& cells : all) {
            std::string head;
            for (const int number : {cells.type, cells.count(), 2}) numbers.integer(head, number);
            if (format.binary) sink(head);
            append_rows(sink, cells.count(), [&](std::string& part, int c) {
                numbers.id(part, cells.id[c]);
                for (const int number : {cells.type, 2})
                    if (!format.binary) numbers.integer(part, number);
                for (const int tag : {cells.physical_of(c), cells.entity[c]}) numbers.integer(part, tag);
                append_nodes(part, cells.nodes_of(c));
            });
        }
        sink(numbers.end_section("Elements"));
    }

    void body_4_1() const {
        const MshBlocks blocks = msh_blocks(mesh, x);
        entities(blocks.entities);
        nodes(blocks.nodes);
        elements(blocks.elements);
    }

    void entities(const std::vector<FileEntity>& all) const {
        std::string text = "$Entities\n";
        for (int dim = 0; dim <= 3; ++dim)
            numbers.size(text, std::count_if(all.begin(), all.end(),
                                             [dim](const FileEntity& entity) { return entity.key.dim == dim; }));
        numbers.end_record(text);
        for (const FileEntity& entity : all) {
            numbers.integer(text, entity.key.tag);
            const int coordinates = entity.key.dim == 0 ? 3 : 6;
            for (int k = 0; k < coordinates; ++k) numbers.real(text, entity.box[k]);
            append_tags(text, entity.physical);
            if (entity.key.dim > 0) append_tags(text, entity.bounds);
            numbers.end_record(text);
        }
        sink(text + numbers.end_section("Entities"));
    }

    void append_tags(std::string& text, const std::vector<int>& tags) const {
        numbers.size(text, static_cast<long long>(tags.size()));
        for (const int tag : tags) numbers.integer(text, tag);
    }

    void nodes(const std::vector<MshNodeBlock>& blocks) const {
        begin_items("$Nodes\n", blocks.size(), file.node_id);
        for (const MshNodeBlock& block : blocks) {
            const int count = static_cast<int>(block.nodes.size());
            begin_block(block.entity, 0, count);
            append_rows(sink, count, [&](std::string& part, int i) { append_nodes(part, {&block.nodes[i], 1}); });
            append_rows(sink, count, [&](std::string& part, int i) { append_position(part, block.nodes[i]); });
        }
        sink(numbers.end_section("Nodes"));
    }

    void elements(const std::vector<MshElementBlock>& blocks) const {
        std::vector<long long> id;
        for (const MshCells& cells : msh_cells(mesh)) id.insert(id.end(), cells.id.begin(), cells.id.end());
        begin_items("$Elements\n", blocks.size(), id);
        for (const MshElementBlock& block : blocks) {
            const int count = static_cast<int>(block.cells.size());
            begin_block(block.entity, block.of.type, count);
            append_rows(sink, count, [&](std::string& part, int i) {
                numbers.id(part, block.of.id[block.cells[i]]);
                append_nodes(part, block.of.nodes_of(block.cells[i]));
            });
        }
        sink(numbers.end_section("Elements"));
    }

    void begin_items(std::string text, std::size_t blocks, const std::vector<long long>& id) const {
        numbers.size(text, static_cast<long long>(blocks));
        numbers.size(text, static_cast<long long>(id.size()));
        const auto [least, largest] = std::minmax_element(id.begin(), id.end());
        numbers.id(text, *least);
        numbers.id(text, *largest);
        numbers.end_record(text);
        sink(text);
    }

    // third: 0 of nodes (not parametric), the type of elements.
    void begin_block(const EntityKey& entity, int third, int count) const {
        std::string text;
        for (const int number : {entity.dim, entity.tag, third}) numbers.integer(text, number);
        numbers.size(text, count);
        numbers.end_record(text);
        sink(text);
    }

    void append_position(std::string& text, int node) const {
        for (const double coordinate : msh_position(mesh, x, node)) numbers.real(text, coordinate);
        numbers.end_record(text);
    }

    void append_nodes(std::string& text, std::span<const int> nodes) const {
        for (const int node : nodes) numbers.id(text, file.node_id[node]);
        numbers.end_record(text);
    }
};

}  // namespace

void check_ids_fit(const Mesh& mesh, const FileFormat& format) {
    if (!format.binary || format.msh_version == 41) return;
    long long largest = 0;
    const auto see = [&](std::span<const long long> ids) {
        for (const long long id : ids) largest = std::max(largest, id);
    };
    see(mesh.file.node_id);
    for (const MshCells& cells : msh_cells(mesh)) see(cells.id);
    if (largest + 1 - mesh.file.format.first_id() > std::numeric_limits<int>::max())
        throw InputError("id ", largest,
                         " is beyond what binary MSH files before version 4.1 can hold: take final = "
                         "msh41-binary");
}

std::string msh_text(const Mesh& mesh, const std::vector<double>& x, const FileFormat& format) {
    check_ids_fit(mesh, format);
    std::string text;
    const TextSink sink = [&](std::string_view piece) { text += piece; };
    MshWriter{sink, mesh, x, format}.write();
    return text;
}

void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x, const FileFormat& format) {
    check_ids_fit(mesh, format);
    write_file(path, [&](const TextSink& sink) { MshWriter{sink, mesh, x, format}.write(); });
}

std::string msh_text(const Mesh& mesh, const std::vector<double>& x) {
    return msh_text(mesh, x, written_msh(mesh.file.format));
}
void write_msh(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    write_msh(path, mesh, x, written_msh(mesh.file.format));
}

FileFormat written_msh(const FileFormat& format) {
    if (format.ending != ".msh") return {};
    return {format.ending, format.msh_version < 40 ? 22 : 41, format.binary};
}

}  // namespace almesh
