// What the readers of formats share: a scanner, and an index of records by their ids.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/decimal.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {

// Scanner of a text with one record per line, in one pass and without allocation: blank lines are skipped, and a number
// is never taken from the next line, so that a missing one is reported in the line where it is missing.
// `at` points into line `line` (from 1) or to its line end. All failures are InputError "path:line: message"; in a
// binary file, where there are no lines to count, "path: $Nodes, byte 812: message".
struct TextScanner {
    const char *at, *end, *start;
    const std::string& path;  // for messages; must outlive the scanner
    int line = 1;
    bool binary = false;
    std::string part;  // of a binary file in which `at` is

    TextScanner(std::string_view text, const std::string& path_)
        : at(without_mark(text).data()), end(text.data() + text.size()), start(text.data()), path(path_) {}

    template <class... Parts>
    [[noreturn]] void fail_at(int where, const Parts&... message) const {
        throw InputError(path, ":", where, ": ", message...);
    }
    template <class... Parts>
    [[noreturn]] void fail(const Parts&... message) const {
        if (!binary) fail_at(line, message...);
        throw InputError(path, ": ", part, ", byte ", at - start, ": ", message...);
    }

    // To the next character that is not blank; false where the text ends.
    bool next_line() {
        for (skip_blanks(); at != end && *at == '\n'; skip_blanks()) {
            ++at;
            ++line;
        }
        return at != end;
    }

    // Trimmed; at the line end afterwards.
    std::string_view rest_of_line() {
        const char* const begin = at;
        at = std::find(at, end, '\n');
        return trim(std::string_view(begin, static_cast<std::size_t>(at - begin)));
    }

    // The rest of the line as a name, which decks and terminals must be able to show: without control characters.
    std::string_view rest_as_name() {
        const std::string_view name = rest_of_line();
        const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; };
        if (std::any_of(name.begin(), name.end(), is_control)) fail("a name with control characters");
        return name;
    }

    // The word here, for messages.
    std::string word() const {
        if (at == end || *at == '\n') return "the end of the line";
        const char* stop = at;
        while (!is_word_end(stop) && stop - at < 40) ++stop;
        return in_backquotes(std::string_view(at, static_cast<std::size_t>(stop - at)));
    }

    // Whether only blanks are left in this line; passes over them.
    bool at_line_end() {
        skip_blanks();
        return at == end || *at == '\n';
    }

    // Of the next number in this line.
    std::size_t next_byte() {
        if (!binary) skip_blanks();
        return static_cast<std::size_t>(at - start);
    }

    // Fails where anything else is.
    void end_of_line() {
        if (!at_line_end()) fail("expected the end of the line, got ", word());
    }

    // The number here, in [lowest, highest]; fails where there is none. `what` names it in the message.
    long long integer(const char* what, long long lowest, long long highest) {
        skip_blanks();
        long long value = 0;
        const auto [stop, error] = std::from_chars(at, end, value);
        check_number(what, stop, error);
        if (error != std::errc() || value < lowest || value > highest) fail(what, " ", word(), " is out of range");
        at = stop;
        return value;
    }

    int small_integer(const char* what, int lowest = -std::numeric_limits<int>::max(),
                      int highest = std::numeric_limits<int>::max()) {
        return static_cast<int>(integer(what, lowest, highest));
    }

    // A finite number.
    double real(const char* what) {
        skip_blanks();
        const char* const begin = at != end && *at == '+' ? at + 1 : at;
        double value = 0;
        const auto [stop, error] = read_double(begin, end, value);
        check_number(what, stop, error);
        if (!std::isfinite(value)) fail(what, " ", word(), " is not a finite number");
        at = stop;
        return value;
    }

protected:
    void skip_blanks() {
        while (at != end && is_blank(*at)) ++at;
    }

private:
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    bool is_word_end(const char* p) const { return p == end || is_blank(*p) || *p == '\n'; }
    void check_number(const char* what, const char* stop, std::errc error) const {
        if (error == std::errc::invalid_argument || !is_word_end(stop)) fail("expected ", what, ", got ", word());
    }
};

// Index of an item by its id in a file: a table for ids up to a few times the number of items, a hash table for others.
class IdIndex {
public:
    // items: about how many there will be; 16 bytes each are allocated.
    explicit IdIndex(std::size_t items = 0) : table_(4 * items, -1) {}

    // The index that has the id already, or -1 and the id has this index from now on.
    int insert(long long id, int index) {
        int& place = in_table(id) ? table_[id] : sparse_.try_emplace(id, -1).first->second;
        if (place >= 0) return place;
        place = index;
        return -1;
    }

    int find(long long id) const {  // -1: not there
        if (in_table(id)) return table_[id];
        const auto it = sparse_.find(id);
        return it == sparse_.end() ? -1 : it->second;
    }

private:
    std::vector<int> table_;  // by id
    std::unordered_map<long long, int> sparse_;

    bool in_table(long long id) const { return id >= 0 && static_cast<unsigned long long>(id) < table_.size(); }
};

}  // namespace almesh
