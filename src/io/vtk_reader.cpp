// The grid of a legacy VTK file: points, cells and their types. What stands behind them, the data, is left out.
#include <climits>
#include <cstdint>
#include <cstring>
#include <map>
#include <tuple>

#include "base/bytes.hpp"
#include "io/foreign_cells.hpp"
#include "io/text_scanner.hpp"
#include "io/vtk.hpp"

namespace almesh {
namespace {

struct VtkCell {
    const CellType* cell = nullptr;
    int degree = 0;
    bool is_lagrange = false;
};

// Of a type with this number of nodes; nullptr: of another kind.
VtkCell cell_of(int type, int nodes) {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree; ++degree)
            if (const bool is_lagrange = type > 0 && cell.vtk_types[2] == type;
                (is_lagrange || (degree < 3 && cell.vtk_types[degree - 1] == type)) && cell.node_count(degree) == nodes)
                return {&cell, degree, is_lagrange};
    for (const SerendipityCell& kind : serendipity_cells())
        if (kind.vtk_type == type && kind.nodes() == nodes) return {kind.cell, 2};
    return {};
}

struct VtkReader {
    TextScanner in;
    bool binary = false;

    RawMesh read() {
        in.next_line();
        in.rest_of_line();  // # vtk DataFile Version 3.0
        line();             // the title
        const std::string encoding = line();
        binary = encoding == "BINARY";
        if (!binary && encoding != "ASCII") in.fail("expected ASCII or BINARY, got ", in_backquotes(encoding));
        const std::string dataset = line();
        if (dataset != "DATASET UNSTRUCTURED_GRID")
            in.fail("only DATASET UNSTRUCTURED_GRID is read, got ", in_backquotes(dataset));
        RawMesh mesh;
        std::vector<int> numbers;  // of each cell its number of nodes, then these
        long long cells = 0;
        while (in.next_line()) {
            const std::string keyword = word();
            if (keyword == "FIELD") skip_fields();
            else if (keyword == "POINTS") points(mesh);
            else if (keyword == "CELLS") numbers = cell_numbers(cells);
            else if (keyword == "CELL_TYPES") types(numbers, cells, mesh);
            else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") break;
            else in.fail("expected POINTS, CELLS, CELL_TYPES or FIELD, got ", in_backquotes(keyword));
        }
        if (mesh.nodes.empty() || mesh.elements.empty()) in.fail("there are no POINTS, or no CELLS with CELL_TYPES");
        return mesh;
    }

    std::string line() {
        if (in.at != in.end) ++in.at, ++in.line;
        return std::string(in.rest_of_line());
    }

    std::string word() {
        in.at_line_end();
        const char* const begin = in.at;
        while (in.at != in.end && !std::isspace(static_cast<unsigned char>(*in.at))) ++in.at;
        return {begin, std::min(in.at, begin + 40)};
    }

    void begin_values() {
        in.rest_of_line();
        if (binary && in.at != in.end) ++in.at;
    }

    template <class Number>
    Number next_in_binary() {
        if (in.end - in.at < static_cast<std::ptrdiff_t>(sizeof(Number))) in.fail("the file is cut off");
        const auto value = from_bytes<Number>(in.at, std::endian::big);
        in.at += sizeof(Number);
        return value;
    }

    double real(bool is_float) {
        return !binary ? in.real("a coordinate") : is_float ? next_in_binary<float>() : next_in_binary<double>();
    }

    int integer(const char* what) {
        if (binary) return next_in_binary<std::int32_t>();
        if (!in.next_line()) in.fail("the file is cut off");
        return in.small_integer(what);
    }

    // Strings that say where the file comes from.
    void skip_fields() {
        word();
        const long long fields = in.integer("the number of fields", 0, INT_MAX);
        for (long long k = 0; k < fields; ++k) {
            if (!in.next_line()) in.fail("the file is cut off");
            word();
            const long long count = in.integer("the components", 0, INT_MAX) * in.integer("the tuples", 0, INT_MAX);
            if (const std::string type = word(); type != "string") in.fail("a field of type ", type, " is not read");
            in.rest_of_line();
            for (long long i = 0; i < count; ++i) {
                if (in.at == in.end) in.fail("the file is cut off");
                if (!binary) {
                    line();
                    continue;
                }
                ++in.at;
                const int first = next_in_binary<std::uint8_t>();
                const int size = first >= 0xc0 ? first & 0x3f : (first & 0x3f) << 8 | next_in_binary<std::uint8_t>();
                if (in.end - in.at < size) in.fail("the file is cut off");
                in.at += size;
            }
        }
    }

    void points(RawMesh& mesh) {
        if (!mesh.nodes.empty()) in.fail("a second list of POINTS");
        const long long count = in.integer("the number of points", 1, INT_MAX);
        const std::string type = word();
        if (type != "double" && type != "float") in.fail("points of type ", type, ": only double and float are read");
        begin_values();
        using Form = CoordinateFields::Form;
        mesh.coordinates = {!binary ? Form::text : type == "float" ? Form::float32 : Form::float64, std::endian::big};
        for (long long i = 0; i < count; ++i) {
            RawNode node{i + 1, {}, binary ? 0 : in.line};
            for (double& x : node.x) {
                if (!binary && !in.next_line()) in.fail("the file is cut off");
                mesh.coordinates.first.push_back(in.at - in.start);
                x = real(type == "float");
            }
            mesh.nodes.push_back(node);
        }
    }

    std::vector<int> cell_numbers(long long& cells) {
        cells = in.integer("the number of cells", 1, INT_MAX);
        const long long size = in.integer("the size of the list of cells", 1, LLONG_MAX);
        if (!binary && size > in.end - in.at) in.fail("the file is cut off");
        begin_values();
        if (!binary && in.next_line() && *in.at == 'O') in.fail("cells by OFFSETS: save it as version 4.2 or below");
        std::vector<int> numbers;
        for (long long k = 0; k < size; ++k) numbers.push_back(integer("the number of a point"));
        return numbers;
    }

    void types(const std::vector<int>& numbers, long long cells, RawMesh& mesh) {
        if (in.integer("the number of types", 0, INT_MAX) != cells) in.fail("not as many types as cells");
        begin_values();
        std::map<std::tuple<const CellType*, int, bool>, std::vector<int>> orders;
        std::size_t at = 0;
        for (long long c = 0; c < cells; ++c) {
            const int type = integer("the type of a cell");
            const int nodes = at < numbers.size() ? numbers[at] : -1;
            if (nodes < 1 || numbers.size() - at < static_cast<std::size_t>(nodes) + 1)
                in.fail("the list of cells ends before cell ", c);
            const auto [cell, degree, is_lagrange] = cell_of(type, nodes);
            if (!cell)
                in.fail("cell ", c, " of type ", type, " with ", nodes, " nodes: only ", readable_cells(), " with all "
                        "nodes of their degree are read");
            std::vector<int>& order = orders[{cell, degree, is_lagrange}];
            if (order.empty()) order = vtk_node_order(*cell, degree, is_lagrange);
            mesh.elements.push_back(
                {c + 1, mesh.element_nodes.size(), binary ? 0 : in.line, cell->dim, degree, 0, 0, cell});
            mesh.element_nodes.resize(mesh.element_nodes.size() + order.size(), -1);
            for (int k = 0; k < nodes; ++k) {
                const int node = numbers[at + 1 + k];
                if (node < 0 || node >= static_cast<int>(mesh.nodes.size()))
                    in.fail("cell ", c, " has the point ", node, ", of ", mesh.nodes.size());
                mesh.element_nodes[mesh.elements.back().first + order[k]] = node;
            }
            at += nodes + 1;
        }
    }
};

}  // namespace

bool looks_like_vtk(std::string_view text) { return text.starts_with("# vtk DataFile Version"); }

RawMesh parse_vtk(std::string_view text, const std::string& path) {
    VtkReader reader{TextScanner(text, path)};
    RawMesh mesh = reader.read();
    mesh.path = path;
    return mesh;
}

}  // namespace almesh
