// What MSH files are written from: the cells and nodes of a mesh as MSH 4 has them, by elementary entities, which carry
// the physical tags; and the numbers.
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Cells of one dimension, whose arrays live elsewhere.
struct MshCells {
    int dim, type, width;        // width: nodes of one cell
    std::span<const int> nodes;  // count x width
    std::span<const long long> id;
    std::span<const int> physical, entity;  // physical: empty where entities are the names

    int physical_of(int c) const { return physical.empty() ? 0 : physical[c]; }
    int count() const { return static_cast<int>(id.size()); }
    std::span<const int> nodes_of(int c) const { return nodes.subspan(offset(c, width), width); }
};

// Cells of entities with several physical groups, which MSH 2.2 has once for each of them: those that are not among
// msh_cells(). The cells refer to the arrays here.
struct MshCopies {
    std::deque<KeptCells> arrays;
    std::vector<MshCells> cells;
};
MshCopies msh_copies(const Mesh& mesh, const std::vector<MshCells>& all);

// All cells of a mesh by ascending dimension: kept ones, boundary faces, elements. No part is empty.
std::vector<MshCells> msh_cells(const Mesh& mesh);

// Where a node is; in 2D in the plane of the file.
std::array<double, 3> msh_position(const Mesh& mesh, const std::vector<double>& x, int node);

struct MshElementBlock {
    EntityKey entity;
    MshCells of;
    std::vector<int> cells;
};

struct MshNodeBlock {
    EntityKey entity;
    std::vector<int> nodes;  // ascending
};

struct MshBlocks {
    std::vector<FileEntity> entities;       // ascending by key, with the boxes of the positions given
    std::vector<MshNodeBlock> nodes;        // each node is in one of them
    std::vector<MshElementBlock> elements;  // one entity and one physical group each
};

// Entities of the file stay; an entity of several physical tags, possible in MSH 2.2, becomes several entities. A node
// goes to the first block, by ascending (dimension, entity, physical tag), that has it.
MshBlocks msh_blocks(const Mesh& mesh, const std::vector<double>& x);

// Writes the numbers of an MSH file as text or as bytes, least significant first.
struct MshNumbers {
    FileFormat format;
    long long shift;  // of ids, which are positive in MSH

    void integer(std::string& text, long long value) const {
        if (format.binary) append_bytes(text, static_cast<std::int32_t>(value), std::endian::little);
        else append_text(text, value);
    }
    void size(std::string& text, long long value) const {
        if (format.binary) append_bytes(text, static_cast<std::int64_t>(value), std::endian::little);
        else append_text(text, value);
    }
    void id(std::string& text, long long value) const {
        if (format.msh_version == 41) size(text, value + shift);
        else integer(text, value + shift);
    }
    void real(std::string& text, double value) const {
        if (format.binary) append_bytes(text, value, std::endian::little);
        else append_text(text, value);
    }

    // After the last number of a record.
    void end_record(std::string& text) const {
        if (!format.binary) text.back() = '\n';
    }

    std::string end_section(const std::string& name) const { return (format.binary ? "\n$End" : "$End") + name + "\n"; }

private:
    template <class Number>
    static void append_text(std::string& text, Number value) {
        append(text, value);
        text += ' ';
    }
};

}  // namespace almesh
