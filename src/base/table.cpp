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

}  // namespace

std::string to_text(double value, int digits) { return formatted(value, std::chars_format::general, digits); }
std::string fixed(double value, int decimals) { return formatted(value, std::chars_format::fixed, decimals); }
std::string scientific(double value, int decimals) { return formatted(value, std::chars_format::scientific, decimals); }

std::string csv_row(const Cells& cells) {
    std::string row;
    for (const Cell& cell : cells) {
        std::string text = on_one_line(cell.text);
        std::replace(text.begin(), text.end(), '"', '\'');
        const bool bare = text.find(',') == std::string::npos && trim(text) == text;
        row += (bare && !cell.is_sentence ? text : with_quotes(text)) + ',';
    }
    row.back() = '\n';
    return row;
}

std::string TextTable::heading() const {
    Cells cells;
    for (const TextColumn& column : columns) cells.emplace_back(column.heading);
    return line(cells);
}

std::string TextTable::line(const Cells& cells, const std::string& note) const {
    std::string line;
    for (std::size_t k = 0; k < cells.size(); ++k)
        line += (k == 0 ? "" : "  ") + padded(cells[k].text, columns[k].width);
    return line + note + "\n";
}

std::string TextTable::text(const std::vector<Cells>& rows) const {
    TextTable fitted = *this;
    int& width = fitted.columns[0].width;
    for (const Cells& row : rows) width = std::min(width, -static_cast<int>(row[0].text.size()));
    std::string text = fitted.heading();
    for (const Cells& row : rows) text += fitted.line(row);
    return text;
}

std::string padded(std::string text, int width) {
    const auto least = static_cast<std::size_t>(std::abs(width));
    if (text.size() < least) text.insert(width < 0 ? text.size() : 0, least - text.size(), ' ');
    return text;
}

}  // namespace almesh
