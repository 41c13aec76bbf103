// Text of decks and tables: trimming and splitting, strict number parsing, shortest round-trip number printing,
// spelling suggestions, quotes, and tables with named rows.
#pragma once
#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace almesh {

// Views returned here point into the argument.
std::string_view without_mark(std::string_view text);  // without the byte-order mark of UTF-8 that it may begin with
std::string_view trim(std::string_view text);  // without blanks, tabs and line ends at both ends
std::vector<std::string_view> split(std::string_view text, char separator);  // trimmed pieces, empty ones included
std::vector<std::string_view> words(std::string_view text);                  // separated by blanks or tabs, none empty

// The number that the whole text spells, or nothing: no blanks or other garbage, no nan, inf or overflow. A leading
// + is taken.
std::optional<double> parse_double(std::string_view text);
std::optional<int> parse_int(std::string_view text, int lowest = std::numeric_limits<int>::min(),
                             int highest = std::numeric_limits<int>::max());

// Shortest text that parse_double() turns into the same bits, as %g prints it: 0.0005, 1e-08, 841.
std::string to_text(double value);

// The parts one after the other: texts, integers in decimal, decimal numbers as to_text() shows them, and enumerators.
template <class... Parts>
std::string concat(const Parts&... parts) {
    std::string text;
    const auto append = [&text]<class Part>(const Part& part) {
        static_assert(!std::is_same_v<Part, char> && !std::is_same_v<Part, bool>, "neither a text nor a number");
        if constexpr (std::is_integral_v<Part>) text += std::to_string(part);
        else if constexpr (std::is_floating_point_v<Part>) text += to_text(part);
        else if constexpr (std::is_enum_v<Part>) text += to_string(part);
        else text += part;
    };
    (append(parts), ...);
    return text;
}

std::string rounded_down(double value, int digits);  // as %.<digits>g, but never more than the value: for bounds

std::string hash_of(std::string_view text);  // FNV-1a, 64 bits, as 16 hexadecimal digits

std::string counted(std::size_t count, const char* noun);  // "1 node", "2 nodes"

// The dim coordinates of a point, with six digits: "(1.5, -2e-07)".
std::string position_text(const double* x, int dim);

// Optimal string alignment: least number of insertions, deletions, replacements and swaps of two neighbours that turn
// one text into the other (Levenshtein's distance with swaps), by dynamic programming in O(|a| |b|).
int edit_distance(std::string_view a, std::string_view b);

// The candidate of least edit distance to `word`, ignoring case; the first of several, "" of none.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

// ": did you mean `degree`?", with the nearest candidate.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

// `text` broken at blanks into lines of at most `width` characters (longer words stand alone).
std::vector<std::string> wrap(std::string_view text, std::size_t width);

// One row of a table, with its line end: cell i padded to width[i] characters, the last one wrapped within width[i].
// Where a cell is wider than its column, the last one starts on a line of its own.
std::string table_row(const std::vector<std::string>& cells, const std::vector<std::size_t>& width);

std::string on_one_line(std::string text);         // a blank for each line end
std::string in_backquotes(std::string_view text);  // a word of the user, as messages show it: its first 80 characters
std::string with_quotes(std::string_view text);    // in double quotes; the text itself must not hold one

// The text, in double quotes where it is empty, has blanks at an end or holds one of the special characters (a double
// quote must be one of them); quotes in it are doubled.
std::string quoted_where_needed(const std::string& text, const char* special);

// Where the double quote that a text begins with is closed, past doubled ones; npos where it is not.
std::size_t closing_quote(std::string_view text);

// What stands inside the quotes, doubled ones as one, or the text itself where it is not quoted; nothing where another
// quote stands inside.
std::optional<std::string> without_quotes(std::string_view text);

// A row of the list of keys: what is written and what it means. unit: of a number, "count", "1", "length" (that of the
// mesh file), "length^n" (n: the dimension), "s", "MB".
struct Named {
    const char *name, *meaning, *unit = "";
};

// The row of a table, that is of a range of rows with a member `name`, or nullptr.
template <class Table>
auto* find_row(Table& table, std::string_view name) {
    const auto row = std::find_if(std::begin(table), std::end(table), [&](const auto& r) { return r.name == name; });
    return row == std::end(table) ? nullptr : &*row;
}

template <class Table>
std::vector<std::string> names_of(const Table& table) {
    std::vector<std::string> names;
    for (const auto& row : table) names.push_back(row.name);
    return names;
}

}  // namespace almesh
