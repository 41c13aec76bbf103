// The numbers of an MSH file, from text or from bytes through one interface. Sections begin and end with a line of text
// in either; the physical names, and the counts of MSH 2.2, are text in binary files, too.
//
// In binary files tags are int, counts and the ids of MSH 4.1 size_t (4.0: unsigned long), the ids of older versions
// int.
#pragma once
#include <climits>
#include <cmath>
#include <cstdint>

#include "base/bytes.hpp"
#include "io/text_scanner.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// All failures are InputError, see TextScanner. `integer`, `size`, `id` and `real` read the next number of the record;
// in text it has to stand in the same line.
struct MshScanner : TextScanner {
    int version = 0;  // 22, 40 or 41; 0: not known yet
    std::endian order = std::endian::native;
    int size_bytes = 8;  // of a size_t: 4 or 8

    using TextScanner::TextScanner;

    TextScanner& text() { return *this; }

    // From the end of a line of text to the numbers behind it.
    void begin_numbers() {
        if (!binary) {
            next_line();
            return;
        }
        if (at == end) fail("the file is cut off");
        ++at;
    }

    // A tag, a type or one of the other small numbers.
    int integer(const char* what, int lowest = -INT_MAX, int highest = INT_MAX) {
        if (!binary) return small_integer(what, lowest, highest);
        return static_cast<int>(taken<std::int32_t>(what, lowest, highest));
    }

    long long size(const char* what, long long lowest, long long highest) {
        if (!binary) return TextScanner::integer(what, lowest, highest);
        if (size_bytes == 4) return taken<std::uint32_t>(what, lowest, highest);
        return taken<std::int64_t>(what, lowest, highest);  // negative where it is beyond that
    }

    long long id(const char* what) { return binary && version < 41 ? integer(what, 1) : size(what, 1, LLONG_MAX); }

    // Finite.
    double real(const char* what) {
        if (!binary) return TextScanner::real(what);
        const auto value = take<double>(what);
        if (!std::isfinite(value)) fail_before(sizeof value, what, " ", value, " is not a finite number");
        return value;
    }

    // Passes over numbers that are not needed, the last ones of the record.
    void skip_reals(int count) {
        if (!binary) rest_of_line();
        for (int k = 0; binary && k < count; ++k) take<double>("a parameter");
    }

    void end_of_record() {
        if (!binary) end_of_line();
    }

    // Bytes that a number of this file takes, for bounds on counts; of text, the least.
    int id_bytes() const { return !binary ? 2 : version < 41 ? 4 : size_bytes; }
    int real_bytes() const { return binary ? 8 : 2; }

    // Of a binary file: to the line that is `wanted`, before another section or the end of the file; where there is
    // none, to that end.
    void find_line(std::string_view wanted) {
        const std::string_view rest(at, static_cast<std::size_t>(end - at));
        const auto ends_section = [&](std::size_t behind) {
            const std::size_t next = rest.find_first_not_of(" \t\r\n", behind);
            if (next == rest.npos) return true;
            return rest[next] == '$' && rest.substr(behind, next - behind).find('\n') != rest.npos;
        };
        std::size_t found = rest.find(wanted);
        while (found != rest.npos && !ends_section(found + wanted.size())) found = rest.find(wanted, found + 1);
        at = found == rest.npos ? end : at + found;
    }

private:
    template <class... Parts>
    [[noreturn]] void fail_before(std::size_t bytes, const Parts&... message) {
        at -= bytes;
        fail(message...);
    }

    template <class Number>
    Number take(const char* what) {
        if (static_cast<std::size_t>(end - at) < sizeof(Number)) fail("the file is cut off: expected ", what);
        const auto value = from_bytes<Number>(at, order);
        at += sizeof value;
        return value;
    }

    template <class Number>
    long long taken(const char* what, long long lowest, long long highest) {
        const long long value = take<Number>(what);
        if (value < lowest || value > highest) fail_before(sizeof(Number), what, " ", value, " is out of range");
        return value;
    }
};

// The section $Periodic at `from`, which is text in MSH 2.2, once all nodes are known. What cannot be read of it is no
// reason to refuse the mesh, but a note.
void read_periodic(MshScanner& from, const IdIndex& node_index, RawMesh& mesh);

}  // namespace almesh
