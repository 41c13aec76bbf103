// The tags of the file in one pass, with the arrays of numbers that they announce; then points, cells and the groups.
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "base/bytes.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "io/foreign_formats.hpp"
#include "io/inflate.hpp"
#include "io/named_groups.hpp"
#include "io/patch.hpp"
#include "io/vtk.hpp"

namespace almesh {
namespace {

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

struct VtuTag {
    std::string_view name;  // "/Points" where it closes one
    std::map<std::string_view, std::string_view> attributes{};

    std::string_view operator[](std::string_view key) const {
        const auto at = attributes.find(key);
        return at == attributes.end() ? std::string_view() : at->second;
    }
};

struct VtuArray {
    VtuTag tag;
    std::string_view section;  // Points, Cells, CellData, ...
    std::string_view content;  // between its tags: text, or base64
};

// How the bytes of a block are in the file: base64, with the header of a block apart or not; compressed, in blocks.
struct VtuBlock {
    std::string_view place;
    bool is_base64 = false, is_header_apart = false;
    std::size_t block_size = 0;  // 0: not compressed
    std::string data{};
};

struct VtuReader {
    std::string_view file;
    const std::string& path;
    RawMesh mesh{};
    std::vector<VtuArray> arrays{};
    std::string_view appended{};  // from the first byte that offsets count
    bool is_appended_base64 = false, is_compressed = false;
    std::endian order = std::endian::little;
    std::size_t header_bytes = 4;  // of a number in the header of a block
    double version = 0;

    template <class... Parts>
    [[noreturn]] void fail(std::string_view at, const Parts&... message) const {
        throw InputError(path, ":", 1 + std::count(file.data(), at.data(), '\n'), ": ", message...);
    }

    RawMesh read() {
        find_arrays();
        points();
        VtkCells cells;
        cells.connectivity = whole_numbers(array("Cells", "connectivity"));
        cells.offsets = whole_numbers(array("Cells", "offsets"));
        cells.offsets.insert(cells.offsets.begin(), 0);
        cells.types = whole_numbers(array("Cells", "types"));
        cells.are_of_vtk_8 = version < 2.1;
        if (cells.types.empty() || cells.types.size() + 1 != cells.offsets.size())
            fail(array("Cells", "types").tag.name, "there are ", cells.types.size(), " types and ",
                 cells.offsets.size() - 1, " offsets of cells");
        append_vtk_cells(cells, path, mesh);
        name_groups(cells.types.size());
        return std::move(mesh);
    }

    // Up to the data that are appended.
    void find_arrays() {
        std::string_view section;
        int pieces = 0;
        bool is_empty = true;  // the piece
        for (std::size_t at = file.find('<'); at != file.npos; at = file.find('<', at)) {
            const std::string_view begin = file.substr(at);
            if (begin.starts_with("<!--")) {
                at = std::min(file.find("-->", at), file.size());
                continue;
            }
            const VtuTag tag = take_tag(at);
            if (tag.name == "VTKFile") begin_file(tag, begin);
            else if (tag.name == "Piece" && !(is_empty = tag["NumberOfPoints"] == "0") && ++pieces > 1)
                fail(begin, "a second Piece: only one is read; ParaView's filter Clean to Grid merges them");
            else if (tag.name == "DataArray" && !is_empty)
                arrays.push_back({tag, section, trim(file.substr(at, file.find('<', at) - at))});
            else if (tag.name == "AppendedData") {
                is_appended_base64 = tag["encoding"] == "base64";
                appended = file.substr(std::min(file.find('_', at), file.size() - 1) + 1);
                return;
            } else if (tag.name == "Points" || tag.name == "Cells" || tag.name.ends_with("Data")) section = tag.name;
        }
    }

    void begin_file(const VtuTag& tag, std::string_view at) {
        if (tag["type"] != "UnstructuredGrid")
            fail(at, "only type=\"UnstructuredGrid\" is read, got ", in_backquotes(tag["type"]));
        if (tag["byte_order"] == "BigEndian") order = std::endian::big;
        if (tag["header_type"] == "UInt64") header_bytes = 8;
        version = parse_double(tag["version"]).value_or(0);
        is_compressed = !tag["compressor"].empty();
        if (is_compressed && tag["compressor"] != "vtkZLibDataCompressor")
            fail(at, "data compressed by ", tag["compressor"], ": only vtkZLibDataCompressor is read; ParaView and "
                 "meshio write it");
    }

    // The tag at `at`, which goes past it.
    VtuTag take_tag(std::size_t& at) const {
        const std::string_view begin = file.substr(at++);
        VtuTag tag{file.substr(at, file.find_first_of(" \t\r\n/>", at + 1) - at)};
        for (at += tag.name.size();;) {
            at = file.find_first_not_of(" \t\r\n/?", at);
            if (at == file.npos) fail(begin, "the file is cut off in a tag");
            if (file[at] == '>') return ++at, tag;
            const std::size_t equals = file.find('=', at), quote = file.find_first_of("\"'", equals);
            const std::size_t close = quote == file.npos ? quote : file.find(file[quote], quote + 1);
            if (close == file.npos) fail(begin, "expected NAME=\"VALUE\" in a tag");
            tag.attributes[trim(file.substr(at, equals - at))] = file.substr(quote + 1, close - quote - 1);
            at = close + 1;
        }
    }

    const VtuArray& array(std::string_view section, std::string_view name) const {
        for (const VtuArray& one : arrays)
            if (one.section == section && (name.empty() || one.tag["Name"] == name)) return one;
        throw InputError(path, ": there is no array ", name, " of ", section);
    }

    // The next `count` bytes of a block.
    std::string take(std::string_view& from, std::size_t count, bool base64) const {
        const std::string_view begin = from;
        if (count > from.size()) fail(begin, "the data of an array are cut off");
        const std::size_t size = base64 ? std::min((count + 2) / 3 * 4, from.size()) : count;
        from.remove_prefix(size);
        if (!base64) return std::string(begin.substr(0, size));
        std::string bytes;
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < size && begin[k] != '='; ++k) {
            const std::size_t digit = base64_digits.find(begin[k]);
            if (digit == base64_digits.npos) fail(begin, "the data of an array are no base64");
            group = group << 6 | static_cast<std::uint32_t>(digit);
            if (k % 4 > 0) bytes += static_cast<char>(group >> (6 - 2 * (k % 4)));
        }
        if (bytes.size() < count) fail(begin, "the data of an array are cut off");
        bytes.resize(count);
        return bytes;
    }

    // From the first byte of what is appended, at most its length.
    std::size_t offset(const VtuArray& of) const {
        const auto length = static_cast<double>(appended.size());
        return static_cast<std::size_t>(std::clamp(parse_double(of.tag["offset"]).value_or(length), 0.0, length));
    }

    VtuBlock block(const VtuArray& of) const {
        const bool is_appended = of.tag["format"] == "appended";
        VtuBlock block{is_appended ? appended.substr(offset(of)) : of.content, !is_appended || is_appended_base64};
        if (block.place.empty()) fail(of.tag.name, "the data of the array are not in the file");
        std::string_view from = block.place, whole = from;
        const auto number = [&](const std::string& header, std::size_t k) -> std::size_t {
            return header_bytes == 8 ? from_bytes<std::uint64_t>(&header[8 * k], order)
                                     : from_bytes<std::uint32_t>(&header[4 * k], order);
        };
        const std::size_t count = number(take(from, header_bytes, block.is_base64), 0);
        if (count > whole.size()) fail(whole, "the data of an array are cut off");
        if (!is_compressed) {
            block.is_header_apart = block.is_base64 && whole[(4 * header_bytes + 2) / 3] == '=';  // it is padded
            if (block.is_header_apart) block.data = take(from, count, true);
            else block.data = take(from = whole, header_bytes + count, block.is_base64).substr(header_bytes);
        } else if (count > 0) {
            const std::string header = take(from = whole, (3 + count) * header_bytes, block.is_base64);
            std::size_t total = 0;
            for (std::size_t k = 0; k < count; ++k) total += std::min(number(header, 3 + k), from.size());
            const std::string_view begin = from;
            const std::string stream = take(from, total, block.is_base64);
            block.block_size = number(header, 1);
            for (std::size_t k = 0, at = 0; k < count; at += number(header, 3 + k++)) {
                const std::size_t last = number(header, 2);
                const auto part = inflate(std::string_view(stream).substr(at, number(header, 3 + k)),
                                          k + 1 == count && last > 0 ? last : block.block_size);
                if (!part) fail(begin, "the compressed data of an array are damaged");
                block.data += *part;
            }
        }
        block.place.remove_suffix(from.size());
        return block;
    }

    // As the block is, but that what was compressed is stored.
    std::string encoded(const VtuBlock& block, const std::string& data) const {
        std::string header, body = data;
        const auto add = [&](std::size_t number) {
            if (header_bytes == 8) append_bytes(header, static_cast<std::uint64_t>(number), order);
            else append_bytes(header, static_cast<std::uint32_t>(number), order);
        };
        const std::size_t size = block.block_size;
        if (size == 0) add(data.size());
        else {
            body.clear();
            for (const std::size_t number : {(data.size() + size - 1) / size, size, data.size() % size}) add(number);
            for (std::size_t at = 0; at < data.size(); at += size) {
                const std::string part = stored(std::string_view(data).substr(at, size));
                add(part.size());
                body += part;
            }
        }
        if (!block.is_base64) return header + body;
        return size > 0 || block.is_header_apart ? base64(header) + base64(body) : base64(header + body);
    }

    static std::string base64(std::string_view bytes) {
        std::string text;
        for (std::size_t at = 0; at < bytes.size(); at += 3) {
            std::uint32_t group = 0;
            for (std::size_t k = 0; k < 3; ++k)
                group = group << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                text += at + k <= bytes.size() ? base64_digits[group >> (18 - 6 * k) & 63] : '=';
        }
        return text;
    }

    // places: of numbers in text, in the file.
    std::vector<double> values(const VtuArray& of, std::vector<std::size_t>* places = nullptr) const {
        std::vector<double> numbers;
        if (of.tag["format"] == "ascii") {
            const std::string_view text = of.content;
            for (std::size_t at = 0, end = 0; (at = text.find_first_not_of(" \t\r\n", end)) != text.npos;) {
                end = std::min(text.find_first_of(" \t\r\n", at), text.size());
                const auto value = parse_double(text.substr(at, end - at));
                if (!value)
                    fail(text.substr(at), "expected a number, got ", in_backquotes(text.substr(at, end - at)));
                numbers.push_back(*value);
                if (places) places->push_back(text.data() + at - file.data());
            }
            return numbers;
        }
        const std::string data = block(of).data;
        const std::string_view type = of.tag["type"];
        const auto take_all = [&]<class Stored>(Stored) {
            for (std::size_t at = 0; at + sizeof(Stored) <= data.size(); at += sizeof(Stored))
                numbers.push_back(static_cast<double>(from_bytes<Stored>(&data[at], order)));
        };
        if (type == "Int8") take_all(std::int8_t());
        else if (type == "UInt8") take_all(std::uint8_t());
        else if (type == "Int16") take_all(std::int16_t());
        else if (type == "UInt16") take_all(std::uint16_t());
        else if (type == "Int32") take_all(std::int32_t());
        else if (type == "UInt32") take_all(std::uint32_t());
        else if (type == "Int64" || type == "UInt64") take_all(std::int64_t());
        else if (type == "Float32") take_all(float());
        else if (type == "Float64") take_all(double());
        else fail(of.tag.name, "numbers of type ", type, " are not read");
        return numbers;
    }

    std::vector<long long> whole_numbers(const VtuArray& of) const {
        const std::vector<double> numbers = values(of);
        for (const double number : numbers)
            if (!(std::abs(number) < 1e15 && number == std::floor(number)))
                fail(of.tag.name, "expected whole numbers, got ", number);
        return {numbers.begin(), numbers.end()};
    }

    void points() {
        const VtuArray& of = array("Points", "");
        CoordinateFields& fields = mesh.coordinates;
        const std::vector<double> x = values(of, &fields.first);
        if (x.empty() || x.size() % 3 != 0 || of.tag["NumberOfComponents"] != "3")
            fail(of.tag.name, "expected three coordinates of each point");
        for (std::size_t i = 0; i < x.size() / 3; ++i) {
            mesh.nodes.push_back({static_cast<long long>(i) + 1, {x[3 * i], x[3 * i + 1], x[3 * i + 2]}, 0});
            for (const double a : mesh.nodes.back().x)
                if (!std::isfinite(a)) fail(of.tag.name, "point ", i, " has a coordinate that is not finite");
        }
        if (of.tag["format"] == "ascii" || !of.tag["type"].starts_with("Float")) return;
        const bool is_float = of.tag["type"] == "Float32";
        fields.form = is_float ? CoordinateFields::Form::float32 : CoordinateFields::Form::float64;
        fields.order = order;
        fields.rewritten = rewritten;
        for (std::size_t k = 0; k < x.size(); ++k) fields.first.push_back(k * (is_float ? 4 : 8));
    }

    // The file with the points in a block of their own coding; the offsets of blocks after it follow.
    static std::string rewritten(std::string_view file, CoordinateFields fields, const std::vector<double>& x) {
        const std::string path = "mesh";
        VtuReader reader{file, path};
        reader.find_arrays();
        const VtuBlock block = reader.block(reader.array("Points", ""));
        fields.rewritten = nullptr;
        const std::string data = patched(block.data, fields, x);
        if (data == block.data) return std::string(file);
        const std::string code = reader.encoded(block, data);
        const long long longer = static_cast<long long>(code.size()) - static_cast<long long>(block.place.size());
        std::map<const char*, std::pair<std::string_view, std::string>> parts;  // by place
        parts[block.place.data()] = {block.place, code};
        for (const VtuArray& one : reader.arrays)
            if (const std::string_view text = one.tag["offset"]; one.tag["format"] == "appended")
                if (const std::size_t offset = reader.offset(one); reader.appended.data() + offset > block.place.data())
                    parts[text.data()] = {text, std::to_string(static_cast<long long>(offset) + longer)};
        std::string result;
        const char* at = file.data();
        for (const auto& [begin, part] : parts) {
            result.append(at, begin).append(part.second);
            at = begin + part.first.size();
        }
        return result.append(at, file.data() + file.size());
    }

    void name_groups(std::size_t cells) {
        constexpr std::size_t most = 256;  // of more values it is a number of each cell
        NamedGroups groups(mesh);
        for (const VtuArray& of : arrays) {
            const std::string_view components = of.tag["NumberOfComponents"], name = of.tag["Name"];
            if (of.section.ends_with("Data")) mesh.sections.push_back(concat(of.section, " ", name));
            if (of.section != "CellData" || of.tag["type"].find("Int") == of.section.npos || name == "vtkGhostType" ||
                (!components.empty() && components != "1"))
                continue;
            const std::vector<long long> value = whole_numbers(of);
            if (value.size() != cells) fail(of.tag.name, "not as many numbers as cells");
            if (std::set<long long>(value.begin(), value.end()).size() > most) continue;
            for (std::size_t c = 0; c < cells; ++c) groups.add(concat(name, " ", value[c]), static_cast<int>(c));
            mesh.sections.pop_back();  // its numbers are in the names of groups
        }
        groups.finish();
    }
};

}  // namespace

bool looks_like_vtu(std::string_view text) { return text.substr(0, 2000).find("<VTKFile") != text.npos; }

RawMesh parse_vtu(std::string_view text, const std::string& path) {
    VtuReader reader{text, path};
    reader.mesh.path = path;
    return reader.read();
}

}  // namespace almesh
