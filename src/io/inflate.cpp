#include "io/inflate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace almesh {
namespace {

struct Damaged {};

// A prefix code: symbols of each length in bits, ascending (RFC 1951, 3.2.2).
struct Code {
    std::array<int, 16> count{};
    std::vector<int> symbol;

    explicit Code(const std::vector<int>& lengths) : symbol(lengths.size()) {
        for (const int length : lengths) ++count[length];
        count[0] = 0;
        std::array<int, 17> begin{};
        for (int length = 1; length < 16; ++length) begin[length + 1] = begin[length] + count[length];
        for (std::size_t s = 0; s < lengths.size(); ++s)
            if (lengths[s] > 0) symbol[begin[lengths[s]]++] = static_cast<int>(s);
    }
};

struct Inflater {
    std::string_view in;
    std::size_t size;  // of the data
    std::string out{};
    std::size_t at = 0;  // byte
    std::uint32_t buffer = 0;
    int buffered = 0;  // bits

    int bits(int count) {
        for (; buffered < count; buffered += 8) {
            if (at == in.size()) throw Damaged();
            buffer |= static_cast<std::uint32_t>(static_cast<unsigned char>(in[at++])) << buffered;
        }
        const std::uint32_t value = buffer & ((1u << count) - 1);
        buffer >>= count;
        buffered -= count;
        return static_cast<int>(value);
    }

    int symbol(const Code& code) {
        for (int length = 1, value = 0, first = 0, begin = 0; length < 16; ++length) {
            value |= bits(1);
            const int count = code.count[length];
            if (value - first < count) return code.symbol[begin + value - first];
            begin += count;
            first = (first + count) << 1;
            value <<= 1;
        }
        throw Damaged();
    }

    void copy_stored() {
        buffer = 0, buffered = 0;
        if (in.size() - at < 4) throw Damaged();
        const auto length = from_bytes<std::uint16_t>(&in[at], std::endian::little);
        if (from_bytes<std::uint16_t>(&in[at + 2], std::endian::little) != static_cast<std::uint16_t>(~length) ||
            in.size() - at - 4 < length || size - out.size() < length)
            throw Damaged();
        out += in.substr(at + 4, length);
        at += 4 + length;
    }

    // Literals, and repetitions of what is `distance` bytes before.
    void copy_coded(const Code& literals, const Code& distances) {
        constexpr int lengths[] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                   31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
        for (int code = symbol(literals); code != 256; code = symbol(literals)) {
            if (code < 256) {
                if (out.size() == size) throw Damaged();
                out += static_cast<char>(code);
                continue;
            }
            if (code > 285) throw Damaged();
            const int length = lengths[code - 257] + bits(code < 265 || code == 285 ? 0 : (code - 261) / 4);
            const int far = symbol(distances), more = far < 4 ? 0 : far / 2 - 1;
            if (far > 29) throw Damaged();
            const std::size_t distance = (far < 4 ? far : (2 + far % 2) << more) + bits(more) + 1;
            if (distance > out.size() || size - out.size() < static_cast<std::size_t>(length)) throw Damaged();
            for (int k = 0; k < length; ++k) out += out[out.size() - distance];
        }
    }

    void copy_with_own_codes() {
        const int literals = bits(5) + 257, distances = bits(5) + 1, count = bits(4) + 4;
        constexpr int order[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
        std::vector<int> of_lengths(19), lengths;
        for (int k = 0; k < count; ++k) of_lengths[order[k]] = bits(3);
        const Code code(of_lengths);
        while (static_cast<int>(lengths.size()) < literals + distances) {
            const int length = symbol(code);
            if (length == 16 && lengths.empty()) throw Damaged();
            if (length < 16) lengths.push_back(length);
            else if (length == 16) lengths.insert(lengths.end(), bits(2) + 3, int(lengths.back()));
            else lengths.insert(lengths.end(), length == 17 ? bits(3) + 3 : bits(7) + 11, 0);
        }
        lengths.resize(literals + distances);
        const auto middle = lengths.begin() + literals;
        copy_coded(Code({lengths.begin(), middle}), Code({middle, lengths.end()}));
    }

    void run() {
        if (bits(8) % 16 != 8 || bits(8) & 32) throw Damaged();
        for (bool is_last = false; !is_last;) {
            is_last = bits(1);
            const int kind = bits(2);
            if (kind == 0) copy_stored();
            else if (kind == 2) copy_with_own_codes();
            else if (kind == 1) {
                std::vector<int> lengths(288, 8);
                std::fill(lengths.begin() + 144, lengths.begin() + 256, 9);
                std::fill(lengths.begin() + 256, lengths.begin() + 280, 7);
                copy_coded(Code(lengths), Code(std::vector<int>(30, 5)));
            } else throw Damaged();
        }
    }
};

std::uint32_t adler32(std::string_view data) {
    std::uint32_t a = 1, b = 0;
    for (const char c : data) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    return b << 16 | a;
}

}  // namespace

std::optional<std::string> inflate(std::string_view stream, std::size_t size) {
    Inflater inflater{stream, size};
    try {
        inflater.run();
    } catch (const Damaged&) {
        return std::nullopt;
    }
    const bool is_whole = stream.size() - inflater.at >= 4 && inflater.out.size() == size &&
                          from_bytes<std::uint32_t>(&stream[inflater.at], std::endian::big) == adler32(inflater.out);
    return is_whole ? std::optional(std::move(inflater.out)) : std::nullopt;
}

std::string stored(std::string_view data) {
    std::string stream = "\x78\x01";
    constexpr std::size_t most = 65535;
    for (std::size_t at = 0; at == 0 || at < data.size(); at += most) {
        const std::string_view part = data.substr(at, most);
        stream += static_cast<char>(data.size() - at <= most);
        append_bytes(stream, static_cast<std::uint16_t>(part.size()), std::endian::little);
        append_bytes(stream, static_cast<std::uint16_t>(~part.size()), std::endian::little);
        stream += part;
    }
    append_bytes(stream, adler32(data), std::endian::big);
    return stream;
}

}  // namespace almesh
