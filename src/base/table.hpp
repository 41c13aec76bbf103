// What is printed: numbers with some digits, and tables, with aligned columns for people, and as CSV and JSON for
// programs. Here alone texts are quoted for these.
#pragma once
#include <cstdio>
#include <memory>
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

// A number, which in CSV and JSON reads back to the same bits, or a text.
struct Field {
    std::string text, name = {};  // name: of its column, where that matters
    bool is_word = true;          // neither a number nor a list or object of JSON
    bool is_sentence = false;     // in CSV it stands in double quotes whatever it holds

    template <class Number>
        requires std::is_arithmetic_v<Number>
    Field(Number number) : text(concat(number)), is_word(false) {}
    Field(const char* of) : text(of) {}
    Field(std::string of) : text(std::move(of)) {}
    Field(std::string of_column, Field of) : Field(std::move(of)) { name = std::move(of_column); }
    Field(const Named& column, std::string of) : text(std::move(of)), name(column.name), is_word(!*column.unit) {}
};
using Fields = std::vector<Field>;

inline Field sentence(Field text) { return text.is_sentence = true, text; }

// The row of a CSV table, with its line end. Texts are on one line, with single quotes for double ones; those that hold
// a comma or begin or end with a blank stand in double quotes.
std::string csv_row(const Fields& cells);
std::string csv_heading(const Fields& cells);

// JSON (RFC 8259). Bytes of words that are no UTF-8 become U+FFFD. Numbers have the digits of CSV; inf and nan, which
// JSON lacks, are words, and "none" in the place of a number is null. Fields with names are an object, from which empty
// ones are left out; others are a list.
Field json(const Fields& cells);

// What a command says: text for people and, where they ask for it, objects for programs, one on each line.
struct Output {
    std::FILE* text;
    std::FILE* objects = nullptr;                            // or nobody asks for them
    std::shared_ptr<Fields> end = std::make_shared<Fields>();  // what the last object has

    Output(std::FILE* for_people, std::FILE* for_programs = nullptr) : text(for_people), objects(for_programs) {}
    operator std::FILE*() const { return text; }

    void tell(const char* event, Fields cells) const;  // a line, at once: {"event": event, ...}
    void add(const Fields& cells) const { end->insert(end->end(), cells.begin(), cells.end()); }
};

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
    std::string line(const Fields& cells, const std::string& note = "") const;
    // Heading and rows; the first column is as wide as its longest cell.
    std::string text(const std::vector<Fields>& rows) const;
};

std::string padded(std::string text, int width);  // with blanks, before it or, where width < 0, after it

}  // namespace almesh
