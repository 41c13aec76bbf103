// Meshes in all versions of MSH that are read, in text and in bytes: MSH 2.2 as the program writes it, and as bytes;
// MSH 4.1 with a block of nodes and one of elements for each elementary entity, which carries the physical tag.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/text.hpp"
#include "io/msh.hpp"
#include "mesh/build.hpp"

namespace almesh::test {

class MshText {
public:
    MshText(const Mesh& mesh, const std::vector<double>& x, const FileFormat& format)
        : mesh_(mesh), raw_(parse_msh(almesh::msh_text(mesh, x), "a.msh")), format_(format) {}

    std::string text() {
        text_ = concat("$MeshFormat\n", format_.msh_version == 41 ? "4.1" : "2.2",
                       format_.binary ? " 1 8\n" : " 0 8\n");
        if (format_.binary) integer(1);
        end("MeshFormat");
        if (!mesh_.file.groups.empty()) names();
        if (format_.msh_version == 41) {
            place();
            entities();
            nodes_in_blocks();
            elements_in_blocks();
        } else {
            nodes();
            elements();
        }
        if (!mesh_.file.comment.empty()) text_ += "$Comments\n" + mesh_.file.comment + "\n$EndComments\n";
        return text_;
    }

private:
    const Mesh& mesh_;
    const RawMesh raw_;
    const FileFormat format_;
    std::string text_;
    std::map<std::array<int, 3>, EntityKey> entity_;  // by dimension, entity and group in MSH 2.2
    std::map<EntityKey, std::vector<int>> cells_, nodes_;
    std::map<EntityKey, std::vector<int>> groups_;

    template <class Number>
    void put(Number value) {
        if (format_.binary) append_bytes(text_, value, std::endian::little);
        else text_ += concat(value, " ");
    }
    void integer(long long value) { put(static_cast<std::int32_t>(value)); }
    void size(long long value) { put(static_cast<std::int64_t>(value)); }
    void id(long long value) { format_.msh_version == 41 ? size(value) : integer(value); }
    void end_record() {
        if (!format_.binary) text_.back() = '\n';
    }
    void end(const std::string& name) { text_ += (format_.binary ? "\n$End" : "$End") + name + "\n"; }

    void names() {
        std::string rows;
        int count = 0;
        for (const PhysicalGroup& group : mesh_.file.groups)
            if (!group.is_entity) rows += concat(group.dim, " ", group.tag, " \"", group.name, "\"\n"), ++count;
        if (count > 0) text_ += concat("$PhysicalNames\n", count, "\n", rows, "$EndPhysicalNames\n");
    }

    void position(const RawNode& node) {
        for (const double x : node.x) put(x);
        end_record();
    }
    void nodes_of(const RawElement& element) {
        for (int k = 0; k < element.node_count(); ++k) id(raw_.nodes[raw_.element_nodes[element.first + k]].id);
        end_record();
    }
    static int type_of(const RawElement& element) { return element.cell().msh_types[std::max(element.degree, 1) - 1]; }
    int group_of(const RawElement& element) const {  // 0 where the entities are the names
        for (const PhysicalGroup& group : raw_.groups)
            if (group.is_entity && group.dim == element.dim) return 0;
        return element.physical;
    }

    void nodes() {
        text_ += concat("$Nodes\n", raw_.nodes.size(), "\n");
        for (const RawNode& node : raw_.nodes) id(node.id), position(node);
        end("Nodes");
    }
    void elements() {
        text_ += concat("$Elements\n", raw_.elements.size(), "\n");
        const RawElement* before = nullptr;
        for (const RawElement& element : raw_.elements) {
            if (format_.binary && (!before || type_of(*before) != type_of(element)))
                integer(type_of(element)), integer(count_from(element)), integer(2);
            before = &element;
            id(element.id);
            if (!format_.binary) integer(type_of(element)), integer(2);
            integer(group_of(element)), integer(element.entity);
            nodes_of(element);
        }
        end("Elements");
    }
    // Of the elements of one type that follow one another.
    long long count_from(const RawElement& first) const {
        const RawElement* const end_of_all = raw_.elements.data() + raw_.elements.size();
        const auto is_other = [&](const RawElement& element) { return type_of(element) != type_of(first); };
        return std::find_if(&first, end_of_all, is_other) - &first;
    }

    // Elements and nodes to entities; one with several groups becomes several.
    void place() {
        std::map<int, int> last;
        for (const RawElement& element : raw_.elements)
            last[element.dim] = std::max(last[element.dim], element.entity);
        std::vector<EntityKey> of_node(raw_.nodes.size());
        for (int dim = 0; dim <= 3; ++dim)
            for (std::size_t e = 0; e < raw_.elements.size(); ++e) {
                const RawElement& element = raw_.elements[e];
                if (element.dim != dim) continue;
                const auto [known, is_new] = entity_.try_emplace({dim, element.entity, group_of(element)});
                if (is_new) {
                    const EntityKey own{dim, element.entity};
                    known->second = groups_.contains(own) ? EntityKey{dim, ++last[dim]} : own;
                    groups_[known->second] = std::vector<int>(group_of(element) != 0, group_of(element));
                }
                cells_[known->second].push_back(static_cast<int>(e));
                for (int k = 0; k < element.node_count(); ++k)
                    if (EntityKey& key = of_node[raw_.element_nodes[element.first + k]]; key.dim < 0)
                        key = known->second;
            }
        for (std::size_t i = 0; i < of_node.size(); ++i) nodes_[of_node[i]].push_back(static_cast<int>(i));
    }
    void entities() {
        text_ += "$Entities\n";
        for (int dim = 0; dim <= 3; ++dim)
            size(std::count_if(groups_.begin(), groups_.end(), [dim](const auto& of) { return of.first.dim == dim; }));
        end_record();
        for (const auto& [key, groups] : groups_) {
            integer(key.tag);
            for (int k = 0; k < (key.dim == 0 ? 3 : 6); ++k) put(0.0);
            size(std::ssize(groups));
            for (const int group : groups) integer(group);
            if (key.dim > 0) size(0);
            end_record();
        }
        end("Entities");
    }
    template <class Items>
    void begin(const char* name, std::size_t blocks, const Items& items) {
        text_ += name;
        const auto is_less = [](const auto& a, const auto& b) { return a.id < b.id; };
        const auto [least, largest] = std::minmax_element(items.begin(), items.end(), is_less);
        size(static_cast<long long>(blocks)), size(std::ssize(items)), size(least->id), size(largest->id);
        end_record();
    }
    void begin_block(const EntityKey& key, int third, std::size_t count) {
        integer(key.dim), integer(key.tag), integer(third), size(static_cast<long long>(count));
        end_record();
    }
    void nodes_in_blocks() {
        begin("$Nodes\n", nodes_.size(), raw_.nodes);
        for (const auto& [key, nodes] : nodes_) {
            begin_block(key, 0, nodes.size());
            for (const int i : nodes) id(raw_.nodes[i].id), end_record();
            for (const int i : nodes) position(raw_.nodes[i]);
        }
        end("Nodes");
    }
    void elements_in_blocks() {
        std::map<std::pair<EntityKey, int>, std::vector<int>> blocks;  // by entity and type
        for (const auto& [key, cells] : cells_)
            for (const int e : cells) blocks[{key, type_of(raw_.elements[e])}].push_back(e);
        begin("$Elements\n", blocks.size(), raw_.elements);
        for (const auto& [key, cells] : blocks) {
            begin_block(key.first, key.second, cells.size());
            for (const int e : cells) id(raw_.elements[e].id), nodes_of(raw_.elements[e]);
        }
        end("Elements");
    }
};

inline std::string msh_text(const Mesh& mesh, const std::vector<double>& x, const FileFormat& format) {
    return format == FileFormat() ? almesh::msh_text(mesh, x) : MshText(mesh, x, format).text();
}

}  // namespace almesh::test
