#include "io/msh_blocks.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "geometry/box_tree.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/raw_mesh.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

struct BlockBuilder {
    const Mesh& mesh;
    const std::vector<double>& x;
    std::map<EntityKey, FileEntity> entities{};
    MshBlocks blocks{};

    MshBlocks build() {
        for (const FileEntity& entity : mesh.file.entities) entities.emplace(entity.key, entity);
        const std::vector<MshCells> cells = msh_cells(mesh);
        for (int dim = 0; dim <= mesh.dim; ++dim) append_cells(dim, cells);
        place_nodes();
        set_boxes();
        for (auto& [key, entity] : entities) blocks.entities.push_back(std::move(entity));
        return std::move(blocks);
    }

    using Parts = std::map<int, std::vector<std::vector<int>>>;  // cells of an entity by physical tag and MshCells

    void append_cells(int dim, const std::vector<MshCells>& all) {
        std::map<int, Parts> of_entity;
        for (std::size_t k = 0; k < all.size(); ++k)
            for (int c = 0; all[k].dim == dim && c < all[k].count(); ++c) {
                std::vector<std::vector<int>>& part = of_entity[all[k].entity[c]][all[k].physical_of(c)];
                part.resize(all.size());
                part[k].push_back(c);
            }
        std::vector<int> taken;
        for (const auto& [tag, parts] : of_entity) taken.push_back(tag);
        for (const auto& [key, entity] : entities)
            if (key.dim == dim) taken.push_back(key.tag);
        UnusedIds<int> unused(std::move(taken));
        for (auto& [tag, parts] : of_entity) {
            FileEntity& own = entities[{dim, tag}];
            const bool keeps = !own.physical.empty() && parts.contains(own.physical[0]);
            const int first = keeps ? own.physical[0] : parts.begin()->first;
            for (auto& [physical, part] : parts) {
                const EntityKey key{dim, physical == first ? tag : unused.next()};
                FileEntity& entity = entities[key];
                entity.key = key;
                if (physical != first || !keeps) entity.physical.assign(physical != 0, physical);
                for (std::size_t k = 0; k < all.size(); ++k)
                    if (!part[k].empty()) blocks.elements.push_back({key, all[k], std::move(part[k])});
            }
        }
    }

    void place_nodes() {
        std::vector<EntityKey> place(mesh.nodes());
        for (const MshElementBlock& block : blocks.elements)
            for (const int c : block.cells)
                for (const int node : block.of.nodes_of(c))
                    if (place[node].dim < 0) place[node] = block.entity;
        std::map<EntityKey, std::vector<int>> nodes;
        for (int i = 0; i < mesh.nodes(); ++i) nodes[place[i]].push_back(i);
        for (auto& [key, of_entity] : nodes) {
            entities[key].key = key;
            blocks.nodes.push_back({key, std::move(of_entity)});
        }
    }

    // The box of an entity holds its nodes, those of its cells and the entities around it; without any it stays.
    void set_boxes() {
        std::map<EntityKey, Box> boxes;
        const auto include = [&boxes](const EntityKey& key, const Box& box) {
            boxes.try_emplace(key, box).first->second.include(box);
        };
        const auto include_node = [&](const EntityKey& key, int node) {
            const std::array<double, 3> position = msh_position(mesh, x, node);
            include(key, {position, position});
        };
        for (const MshNodeBlock& block : blocks.nodes)
            for (const int node : block.nodes) include_node(block.entity, node);
        for (const MshElementBlock& block : blocks.elements)
            for (const int c : block.cells)
                for (const int node : block.of.nodes_of(c)) include_node(block.entity, node);
        for (auto& [key, entity] : entities) {
            for (const int tag : entity.bounds)
                if (const auto around = boxes.find({key.dim - 1, std::abs(tag)}); around != boxes.end())
                    include(key, around->second);
            const auto own = boxes.find(key);
            if (own == boxes.end()) continue;
            std::copy_n(own->second.low.begin(), 3, entity.box.begin());
            std::copy_n(own->second.high.begin(), 3, entity.box.begin() + 3);
        }
    }
};

}  // namespace

std::vector<MshCells> msh_cells(const Mesh& mesh) {
    const FileTags& file = mesh.file;
    std::vector<MshCells> all;
    std::array<bool, 4> is_named_by_entity{};
    for (const PhysicalGroup& group : file.groups) is_named_by_entity[group.dim] |= group.is_entity;
    const auto append = [&](const CellType& cell, std::span<const int> nodes, std::span<const long long> id,
                            std::span<const int> physical, std::span<const int> entity) {
        if (id.empty()) return;
        const int degree = cell.dim == 0 ? 1 : mesh.degree;
        all.push_back(
            {cell.dim, cell.msh_types[degree - 1], cell.node_count(degree), nodes, id,
             is_named_by_entity[cell.dim] ? std::span<const int>() : physical, entity});
    };
    for (const KeptCells& kept : mesh.kept)
        append(mesh.cell_of(kept), kept.nodes, kept.id, kept.physical, kept.entity);
    for (const auto& [cell, first, count, start] : faces_in_file(mesh))
        append(*cell, std::span(mesh.faces).subspan(start, offset(count, cell->node_count(mesh.degree))),
               std::span(file.face_id).subspan(first, count), std::span(file.face_physical).subspan(first, count),
               std::span(file.face_entity).subspan(first, count));
    for (const auto& [cell, first, count, start] : mesh.element_groups())
        append(*cell, std::span(mesh.elements).subspan(start, offset(count, cell->node_count(mesh.degree))),
               std::span(file.element_id).subspan(first, count), std::span(file.element_physical).subspan(first, count),
               std::span(file.element_entity).subspan(first, count));
    return all;
}

MshCopies msh_copies(const Mesh& mesh, const std::vector<MshCells>& all) {
    MshCopies copies;
    if (mesh.file.entities.empty()) return copies;
    std::vector<long long> ids;
    std::set<std::array<int, 3>> known;  // dimension, entity and group of cells that are there by themselves
    for (const MshCells& cells : all) {
        ids.insert(ids.end(), cells.id.begin(), cells.id.end());
        for (int c = 0; c < cells.count(); ++c) known.insert({cells.dim, cells.entity[c], cells.physical_of(c)});
    }
    UnusedIds<long long> unused(std::move(ids));
    for (const MshCells& cells : all) {
        KeptCells& copy = copies.arrays.emplace_back();
        for (int c = 0; c < cells.count(); ++c) {
            const FileEntity* const own = find_entity(mesh.file.entities, cells.dim, cells.entity[c]);
            if (!own || own->physical.empty() || own->physical[0] != cells.physical_of(c)) continue;
            for (const int tag : std::span(own->physical).subspan(1)) {
                if (known.contains({cells.dim, cells.entity[c], tag})) continue;
                const std::span<const int> of_cell = cells.nodes_of(c);
                copy.nodes.insert(copy.nodes.end(), of_cell.begin(), of_cell.end());
                append_tags({{}, {-1}, {unused.next()}, {tag}, {cells.entity[c]}}, 0, copy);
            }
        }
        if (copy.count() > 0)
            copies.cells.push_back(
                {cells.dim, cells.type, cells.width, copy.nodes, copy.id, copy.physical, copy.entity});
    }
    return copies;
}

std::array<double, 3> msh_position(const Mesh& mesh, const std::vector<double>& x, int node) {
    std::array<double, 3> position = {0, 0, mesh.file.z};
    std::copy_n(point(x, node, mesh.dim), mesh.dim, position.begin());
    return position;
}

MshBlocks msh_blocks(const Mesh& mesh, const std::vector<double>& x) { return BlockBuilder{mesh, x}.build(); }

}  // namespace almesh
