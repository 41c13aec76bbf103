// A file is a header, the field data, the points, the cells with their types, and the point and cell data, in this
// order. Large parts are formatted in parallel, a block of rows at a time.
#include "io/vtk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/bytes.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "io/foreign_cells.hpp"

namespace almesh {
namespace {

// Names and strings: blanks, control characters, quotes and % as %XX.
std::string encoded(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c > ' ' && c <= '~' && c != '%' && c != '"') {
            result += c;
            continue;
        }
        const auto byte = static_cast<unsigned char>(c);
        for (const char part : {'%', "0123456789ABCDEF"[byte / 16], "0123456789ABCDEF"[byte % 16]}) result += part;
    }
    return result;
}

// Appends a number to the file's text in its format. Digits of a double: 0 for all that it takes to read the same bits.
struct VtkNumbers {
    bool binary;

    void integer(std::string& text, int value, char separator) const {
        if (binary) return append_bytes(text, static_cast<std::int32_t>(value), std::endian::big);
        append(text, static_cast<long long>(value));
        text += separator;
    }
    void real(std::string& text, double value, int digits, char separator) const {
        constexpr double large = 1e300;
        if (!std::isfinite(value)) value = value < 0 ? -large : large;
        if (binary) return append_bytes(text, value, std::endian::big);
        if (digits) append(text, value, digits);
        else append(text, value);
        text += separator;
    }
    // After an array; in binary files the only line end.
    void end(const TextSink& sink) const {
        if (binary) sink("\n");
    }
};

// A string of a binary file is not encoded, but begins with its length: the bits 11 and 6 bits, or 10 and 14 bits
// (vtkDataWriter).
void append_string(std::string& text, const std::string& value, bool binary) {
    constexpr std::size_t longest = 16383;
    const std::string shown = binary ? value.substr(0, longest) : encoded(value);
    if (binary && shown.size() >= 64) text += static_cast<char>(0x80 | (shown.size() >> 8));
    if (binary) text += static_cast<char>(shown.size() < 64 ? 0xc0 | shown.size() : shown.size() & 0xff);
    text += shown + "\n";
}

// Rows of `components` values: one number or, filled up with zeros, three.
void append_values(const TextSink& sink, const std::vector<double>& value, int components, int digits,
                   const VtkNumbers& numbers) {
    const int shown = components == 1 ? 1 : 3;
    append_rows(sink, static_cast<int>(value.size()) / components, [&](std::string& part, int i) {
        for (int k = 0; k < shown; ++k)
            numbers.real(part, k < components ? value[offset(i, components, k)] : 0.0, digits,
                         k + 1 < shown ? ' ' : '\n');
    });
    numbers.end(sink);
}

void append_arrays(const TextSink& sink, const std::string& kind, std::size_t count,
                   const std::vector<VtkArray>& arrays, const VtkNumbers& numbers) {
    if (!arrays.empty()) sink(concat(kind, count, "\n"));
    for (const VtkArray& array : arrays) {
        if (array.components == 1) sink("SCALARS " + encoded(array.name) + " double 1\nLOOKUP_TABLE default\n");
        else sink("VECTORS " + encoded(array.name) + " double\n");
        append_values(sink, array.value, array.components, 9, numbers);
    }
}

// What VTK has for a cell: its type, and which nodes, in its order. It has no Lagrange pyramids: those of degree 2 are
// written without the node in the middle of the base, others by their vertices.
struct VtkKind {
    int type;
    std::vector<int> nodes;
};

VtkKind vtk_kind(const CellType& cell, int degree) {
    if (cell.is_collapsed && degree > 2) degree = 1;
    VtkKind kind = {cell.vtk_types[std::min(degree, 3) - 1], vtk_node_order(cell, degree)};
    if (cell.is_collapsed && degree == 2) kind.nodes.pop_back();
    return kind;
}

// Groups of the cells of a grid.
std::vector<ElementGroup> groups_of(const VtkGrid& grid) {
    if (!grid.groups.empty()) return grid.groups;
    const CellType& cell = simplex(grid.cell_dim);
    return {{&cell, 0, static_cast<int>(grid.cells.size()) / cell.node_count(grid.degree), 0}};
}

void append_cells(const TextSink& sink, const VtkGrid& grid, const std::vector<ElementGroup>& groups,
                  const VtkNumbers& numbers) {
    const int all = groups.back().first + groups.back().count;
    std::vector<VtkKind> kinds;
    std::size_t size = all, k = 0;
    for (const ElementGroup& group : groups) {
        kinds.push_back(vtk_kind(*group.cell, grid.degree));
        size += group.count * kinds.back().nodes.size();
    }
    sink(concat("CELLS ", all, " ", size, "\n"));
    for (const ElementGroup& group : groups) {
        const std::vector<int>& order = kinds[k++].nodes;
        const int nodes = static_cast<int>(order.size()), stride = group.cell->node_count(grid.degree);
        const int* const cells = grid.cells.data() + group.start;
        append_rows(sink, group.count, [&](std::string& part, int c) {
            numbers.integer(part, nodes, ' ');
            for (int i = 0; i < nodes; ++i)
                numbers.integer(part, cells[offset(c, stride, order[i])], i + 1 < nodes ? ' ' : '\n');
        });
    }
    numbers.end(sink);
    sink(concat("CELL_TYPES ", all, "\n"));
    k = 0;
    for (const ElementGroup& group : groups) {
        const int type = kinds[k++].type;
        append_rows(sink, group.count, [&](std::string& part, int) { numbers.integer(part, type, '\n'); });
    }
    numbers.end(sink);
}

void write_grid(const TextSink& sink, const VtkGrid& grid, const VtkNumbers& numbers) {
    const std::string title = grid.title.substr(0, std::min<std::size_t>(grid.title.find('\n'), 255));
    std::string head = "# vtk DataFile Version 3.0\n" + title;
    head += numbers.binary ? "\nBINARY\n" : "\nASCII\n";
    head += "DATASET UNSTRUCTURED_GRID\n";
    if (!grid.provenance.empty()) head += concat("FIELD FieldData ", grid.provenance.size(), "\n");
    for (const auto& [name, value] : grid.provenance) {
        head += encoded(name) + " 1 1 string\n";
        append_string(head, value, numbers.binary);
    }
    const int nodes = static_cast<int>(grid.positions.size()) / grid.dim;
    sink(concat(head, "POINTS ", nodes, " double\n"));
    append_values(sink, grid.positions, grid.dim, 0, numbers);
    const std::vector<ElementGroup> groups = groups_of(grid);
    append_cells(sink, grid, groups, numbers);
    append_arrays(sink, "POINT_DATA ", nodes, grid.point_data, numbers);
    append_arrays(sink, "CELL_DATA ", groups.back().first + groups.back().count, grid.cell_data, numbers);
}

}  // namespace

std::string vtk_loss(const std::vector<ElementGroup>& groups, int degree) {
    const auto pyramids = std::find_if(groups.begin(), groups.end(),
                                       [](const ElementGroup& group) { return group.cell->is_collapsed; });
    if (degree < 3 || pyramids == groups.end()) return "";
    return concat("VTK has no pyramids of degree ", degree, ": in VTK files ", counted(pyramids->count, "pyramid"),
                  pyramids->count == 1 ? " is linear" : " are linear");
}

std::string vtk_text(const VtkGrid& grid, VtkFormat format) {
    std::string text;
    write_grid([&](std::string_view piece) { text += piece; }, grid, {format == VtkFormat::binary});
    return text;
}

void write_vtk(const std::string& path, const VtkGrid& grid, VtkFormat format) {
    write_file(path, [&](const TextSink& sink) { write_grid(sink, grid, {format == VtkFormat::binary}); });
}

}  // namespace almesh
