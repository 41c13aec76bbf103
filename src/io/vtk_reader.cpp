// The grid of a legacy VTK file: points, cells and their types. What stands behind them, the data, is left out.
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/bytes.hpp"
#include "io/text_scanner.hpp"
#include "io/vtk.hpp"

namespace almesh {
namespace {

struct VtkReader {
    TextScanner in;
    VtkCells cells{};
    bool binary = false, are_by_offsets = false;

    RawMesh read() {
        in.next_line();
        const std::string_view version = in.rest_of_line();  // # vtk DataFile Version 3.0
        are_by_offsets = version.ends_with(" 5.0") || version.ends_with(" 5.1");
        cells.are_of_vtk_8 = !version.ends_with(" 5.1");
        line();             // the title
        const std::string encoding = line();
        binary = encoding == "BINARY";
        if (!binary && encoding != "ASCII") in.fail("expected ASCII or BINARY, got ", in_backquotes(encoding));
        const std::string dataset = line();
        if (dataset != "DATASET UNSTRUCTURED_GRID")
            in.fail("only DATASET UNSTRUCTURED_GRID is read, got ", in_backquotes(dataset));
        RawMesh mesh;
        while (in.next_line()) {
            const std::string keyword = word();
            if (keyword == "FIELD") skip_fields();
            else if (keyword == "METADATA") skip_metadata();
            else if (keyword == "POINTS") points(mesh);
            else if (keyword == "CELLS") are_by_offsets ? cells_by_offsets() : cells_with_counts();
            else if (keyword == "CELL_TYPES") types(mesh);
            else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
                mesh.sections.push_back(keyword);
                break;
            } else in.fail("expected POINTS, CELLS, CELL_TYPES or FIELD, got ", in_backquotes(keyword));
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
        if (binary) return is_float ? next_in_binary<float>() : next_in_binary<double>();
        if (!in.next_line()) in.fail("the file is cut off");
        return in.real("a coordinate");
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
        if (binary)
            mesh.coordinates.form = type == "float" ? CoordinateFields::Form::float32 : CoordinateFields::Form::float64;
        mesh.coordinates.order = std::endian::big;
        for (long long i = 0; i < count; ++i) {
            RawNode node{i + 1, {}, binary ? 0 : in.line};
            for (double& x : node.x) {
                if (!binary && !in.next_line()) in.fail("the file is cut off");
                mesh.coordinates.first.push_back(in.at - in.start);
                x = real(type == "float");
                if (!std::isfinite(x)) in.fail("point ", i, " has a coordinate that is not finite");
            }
            mesh.nodes.push_back(node);
        }
    }

    // Of each cell its number of nodes, then these.
    void cells_with_counts() {
        const long long count = in.integer("the number of cells", 1, INT_MAX);
        const long long size = in.integer("the size of the list of cells", 1, LLONG_MAX);
        if (!binary && size > in.end - in.at) in.fail("the file is cut off");
        begin_values();
        cells.offsets = {0};
        for (long long k = 0, next = 0; k < size; ++k) {
            const int number = integer("the number of a point");
            if (k != next) {
                cells.connectivity.push_back(number);
                continue;
            }
            if (number < 1) in.fail("a cell of ", number, " nodes");
            next += number + 1LL;
            cells.offsets.push_back(cells.offsets.back() + number);
        }
        if (cells.offsets.back() > static_cast<long long>(cells.connectivity.size())) cells.offsets.pop_back();
        if (static_cast<long long>(cells.offsets.size()) <= count)
            in.fail("the list of cells ends before cell ", cells.offsets.size() - 1);
    }

    // As of version 5: the sizes of two arrays, offsets and connectivity.
    void cells_by_offsets() {
        const long long offsets = in.integer("the number of offsets", 1, INT_MAX);
        const long long size = in.integer("the size of the list of cells", 1, LLONG_MAX);
        cells.offsets = array("OFFSETS", offsets);
        cells.connectivity = array("CONNECTIVITY", size);
    }

    std::vector<long long> array(const char* name, long long count) {
        in.rest_of_line();
        if (!in.next_line() || word() != name) in.fail("expected ", name);
        const std::string type = word();
        if (type != "vtktypeint64" && type != "vtktypeint32") in.fail(name, " of type ", in_backquotes(type));
        if (count > in.end - in.at) in.fail("the file is cut off");
        begin_values();
        std::vector<long long> numbers;
        for (long long k = 0; k < count; ++k)
            numbers.push_back(binary && type == "vtktypeint64" ? next_in_binary<std::int64_t>() : integer("a number"));
        return numbers;
    }

    void types(RawMesh& mesh) {
        const auto count = static_cast<long long>(cells.offsets.size()) - 1;
        if (in.integer("the number of types", 0, INT_MAX) != count) in.fail("not as many types as cells");
        begin_values();
        for (long long c = 0; c < count; ++c) cells.types.push_back(integer("the type of a cell"));
        append_vtk_cells(cells, in.path, mesh);
    }

    // Up to an empty line, as VTK does.
    void skip_metadata() {
        in.rest_of_line();
        while (in.at != in.end && !line().empty()) {}
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
