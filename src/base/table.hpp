// What is printed: numbers with some digits, and tables, with aligned columns for people and as CSV for programs. Here
// alone texts are quoted for CSV.
#pragma once
#include <cstdio>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/text.hpp"

namespace almesh {

std::string to_text(double value, int digits);       // %.<digits>g
std::string fixed(double value, int decimals);       // %.<decimals>f
std::string scientific(double value, int decimals);  // %.<decimals>e

template <class... Parts>
void print(std::FILE* out, const Parts&... parts) {
    std::fputs(concat(parts...).c_str(), out);
}

// A number, which in CSV reads back to the same bits, or a text.
struct Cell {
    std::string text;
    bool is_sentence = false;  // in CSV it stands in double quotes whatever it holds

    template <class Number>
        requires std::is_arithmetic_v<Number>
    Cell(Number number) : text(concat(number)) {}
    Cell(const char* of) : text(of) {}
    Cell(std::string of, bool as_sentence = false) : text(std::move(of)), is_sentence(as_sentence) {}
};
using Cells = std::vector<Cell>;

inline Cell sentence(const std::string& text) { return {text, true}; }

// The row of a CSV table, with its line end. Texts are on one line, with single quotes for double ones; those that hold
// a comma or begin or end with a blank stand in double quotes.
std::string csv_row(const Cells& cells);

// width: of the cells, at least that of the heading; < 0: they are aligned left.
struct TextColumn {
    std::string heading;
    int width = 0;
};

// A table with two blanks between its columns.
struct TextTable {
    std::vector<TextColumn> columns;

    std::string heading() const;
    // Of a table that grows while it is read; the last cells may be missing. note: what follows the cells.
    std::string line(const Cells& cells, const std::string& note = "") const;
    // Heading and rows; the first column is as wide as its longest cell.
    std::string text(const std::vector<Cells>& rows) const;
};

std::string padded(std::string text, int width);  // with blanks, before it or, where width < 0, after it

}  // namespace almesh
