#include "base/table.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace almesh {
namespace {

std::string formatted(double value, std::chars_format format, int digits) {
    char buffer[400];  // fixed, the largest double has 309 digits before its point
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value, format, digits).ptr);
}

// Bytes of the character of UTF-8 that the text begins with, 0 where it begins with none (Unicode, Table 3-7).
std::size_t bytes_of_character(std::string_view text) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
    const unsigned first = byte(0), least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
    const unsigned most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;  // of the second one
    if (first < 0x80) return 1;
    if (first < 0xC2 || first > 0xF4 || byte(1) < least || byte(1) > most) return 0;
    const std::size_t bytes = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    for (std::size_t k = 2; k < bytes; ++k)
        if (byte(k) >> 6 != 2) return 0;
    return bytes;
}

std::string json_text(const Field& cell) {
    std::string_view text = cell.text;
    if (!cell.is_word && !text.ends_with('f') && !text.ends_with('n')) return text == "none" ? "null" : cell.text;
    std::string escaped;
    while (!text.empty()) {
        const std::size_t bytes = bytes_of_character(text);
        const unsigned char c = text[0];
        if (bytes == 0) escaped += "\uFFFD";
        else if (c < 0x20) escaped.append(c < 0x10 ? "\\u000" : "\\u001").append(1, "0123456789abcdef"[c % 16]);
        else escaped.append(c == '"' || c == '\\' ? "\\" : "").append(text.substr(0, bytes));
        text.remove_prefix(std::max<std::size_t>(bytes, 1));
    }
    return concat("\"", escaped, "\"");
}

}  // namespace

std::string to_text(double value, int digits) { return formatted(value, std::chars_format::general, digits); }
std::string fixed(double value, int decimals) { return formatted(value, std::chars_format::fixed, decimals); }
std::string scientific(double value, int decimals) { return formatted(value, std::chars_format::scientific, decimals); }

std::string csv_row(const Fields& cells) {
    std::string row;
    for (const Field& cell : cells) {
        std::string text = on_one_line(cell.text);
        std::replace(text.begin(), text.end(), '"', '\'');
        const bool bare = text.find(',') == std::string::npos && trim(text) == text;
        row += (bare && !cell.is_sentence ? text : with_quotes(text)) + ',';
    }
    row.back() = '\n';
    return row;
}

std::string csv_heading(const Fields& cells) {
    const std::vector<std::string> names = names_of(cells);
    return csv_row({names.begin(), names.end()});
}

Field json(const Fields& cells) {
    const bool is_object = !cells.empty() && !cells[0].name.empty();
    std::string text;
    for (const Field& cell : cells)
        if (!is_object || !cell.text.empty())
            text += (text.empty() ? "" : ", ") + (is_object ? json_text(cell.name) + ": " : "") + json_text(cell);
    return {{"", "", "JSON"}, is_object ? "{" + text + "}" : "[" + text + "]"};
}

void Output::tell(const char* event, Fields cells) const {
    if (!objects) return;
    cells.insert(cells.begin(), Field("event", event));
    print(objects, json(cells).text, "\n");
    std::fflush(objects);
}

std::string TextTable::heading() const {
    Fields cells;
    for (const TextColumn& column : columns) cells.emplace_back(column.heading);
    return line(cells);
}

std::string TextTable::line(const Fields& cells, const std::string& note) const {
    std::string line;
    for (std::size_t k = 0; k < cells.size(); ++k)
        line += (k == 0 ? "" : "  ") + padded(cells[k].text, columns[k].width);
    return line + note + "\n";
}

std::string TextTable::text(const std::vector<Fields>& rows) const {
    TextTable fitted = *this;
    int& width = fitted.columns[0].width;
    for (const Fields& row : rows) width = std::min(width, -static_cast<int>(row[0].text.size()));
    std::string text = fitted.heading();
    for (const Fields& row : rows) text += fitted.line(row);
    return text;
}

std::string padded(std::string text, int width) {
    const auto least = static_cast<std::size_t>(std::abs(width));
    if (text.size() < least) text.insert(width < 0 ? text.size() : 0, least - text.size(), ' ');
    return text;
}

}  // namespace almesh
