#include "base/text.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "base/decimal.hpp"
#include "base/table.hpp"

namespace almesh {

std::string_view without_mark(std::string_view text) { return text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0); }

std::string_view trim(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> pieces;
    for (;;) {
        const auto end = text.find(separator);
        pieces.push_back(trim(text.substr(0, end)));
        if (end == std::string_view::npos) return pieces;
        text.remove_prefix(end + 1);
    }
}

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> result;
    while (!(text = trim(text)).empty()) {
        const auto end = std::min(text.find_first_of(" \t"), text.size());
        result.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return result;
}

namespace {

// read: as std::from_chars().
template <class Number, class Read>
std::optional<Number> parse_number(std::string_view text, const Read& read) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = read(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

std::string lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
    const auto value = parse_number<double>(text, read_double);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> parse_int(std::string_view text, int lowest, int highest) {
    const auto read = [](const char* begin, const char* end, int& to) { return std::from_chars(begin, end, to); };
    const auto value = parse_number<int>(text, read);
    return value && *value >= lowest && *value <= highest ? value : std::nullopt;
}

std::string to_text(double value) {
    char digits[32];  // the longest double needs 24 characters
    return {digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general).ptr};
}

std::string hash_of(std::string_view text) {
    std::uint64_t hash = 14695981039346656037u;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    std::string digits(16, '0');
    for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, hash /= 16)
        *digit = "0123456789abcdef"[hash % 16];
    return digits;
}

std::string rounded_down(double value, int digits) {
    const std::string text = to_text(value, digits);
    if (!std::isfinite(value) || std::strtod(text.c_str(), nullptr) <= value) return text;
    const double last_digit = std::pow(10, std::floor(std::log10(std::abs(value))) - digits + 1);
    return to_text(value - last_digit, digits);
}

std::string counted(std::size_t count, const char* noun) { return concat(count, " ", noun, count == 1 ? "" : "s"); }

std::string position_text(const double* x, int dim) {
    std::string text;
    for (int a = 0; a < dim; ++a) text += (a ? ", " : "(") + to_text(x[a], 6);
    return text + ")";
}

// d(i, j): distance of the first i characters of a and the first j of b.
int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> distances((a.size() + 1) * (b.size() + 1));
    const auto d = [&](std::size_t i, std::size_t j) -> int& { return distances[i * (b.size() + 1) + j]; };
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            d(i, j) = static_cast<int>(std::max(i, j));
            if (i == 0 || j == 0) continue;
            d(i, j) = std::min({d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d(i, j) = std::min(d(i, j), d(i - 2, j - 2) + 1);
        }
    return distances.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string lower = lower_case(std::string(word.substr(0, 100)));  // bounds the cost for long texts
    const auto is_nearer = [&](const std::string& a, const std::string& b) {
        return edit_distance(lower, lower_case(a)) < edit_distance(lower, lower_case(b));
    };
    const auto best = std::min_element(candidates.begin(), candidates.end(), is_nearer);
    return best == candidates.end() ? "" : *best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    return ": did you mean " + in_backquotes(nearest(word, candidates)) + "?";
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
    std::vector<std::string> lines;
    for (const std::string_view word : words(text)) {
        if (lines.empty() || lines.back().size() + 1 + word.size() > width) lines.emplace_back(word);
        else (lines.back() += ' ') += word;
    }
    return lines;
}

std::string table_row(const std::vector<std::string>& cells, const std::vector<std::size_t>& width) {
    std::string row;
    std::size_t column = 0;
    for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
        row += cells[i];
        column += width[i];
        row.resize(std::max(row.size() + 1, column), ' ');
    }
    if (row.size() > column) {
        row.resize(row.find_last_not_of(' ') + 1);
        row.append(1, '\n').append(column, ' ');
    }
    const auto lines = wrap(cells.back(), width.back());
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (k > 0) row.append(1, '\n').append(column, ' ');
        row += lines[k];
    }
    return row + "\n";
}

std::string in_backquotes(std::string_view text) {
    constexpr std::size_t most = 80;
    return concat("`", text.substr(0, std::min(most, text.find('\0'))), text.size() > most ? "...`" : "`");
}

std::string on_one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

std::string with_quotes(std::string_view text) { return std::string("\"").append(text).append("\""); }

std::string quoted_where_needed(const std::string& text, const char* special) {
    const bool bare = !text.empty() && trim(text) == text && text.find_first_of(special) == std::string::npos;
    if (bare) return text;
    std::string doubled;
    for (const char c : text) doubled.append(c == '"' ? 2 : 1, c);
    return with_quotes(doubled);
}

std::size_t closing_quote(std::string_view text) {
    auto close = text.find('"', 1);
    while (close != std::string_view::npos && close + 1 < text.size() && text[close + 1] == '"')
        close = text.find('"', close + 2);
    return close;
}

std::optional<std::string> without_quotes(std::string_view text) {
    const bool in_quotes = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    if (in_quotes) text = text.substr(1, text.size() - 2);
    std::string inside;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '"' && (!in_quotes || i + 1 == text.size() || text[++i] != '"')) return std::nullopt;
        inside += text[i];
    }
    return inside;
}

}  // namespace almesh
