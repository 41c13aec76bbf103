// All entries are read and sorted before the matrix is made, so that repeated, missing and unsymmetric ones are found
// and named with their lines.
#include "io/matrix_market.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <tuple>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

struct Entry {
    int row, col;  // from 0
    int line;      // of the file
    double value;
};

bool before(const Entry& a, const Entry& b) { return std::tie(a.row, a.col, a.line) < std::tie(b.row, b.col, b.line); }

std::string place(long long row, long long col) { return concat("(", row + 1, ", ", col + 1, ")"); }

bool next_record(TextScanner& in) {
    while (in.next_line()) {
        if (*in.at != '%') return true;
        in.rest_of_line();
    }
    return false;
}

// Reads the first line, upper or lower case; returns its last word, the symmetry.
std::string banner(TextScanner& in, const std::string& format, const std::vector<std::string>& symmetries) {
    std::string text(in.rest_of_line());
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    const std::vector<std::string_view> word = words(text);
    if (word.empty() || word[0] != "%%matrixmarket")
        in.fail("not a Matrix Market file: it has to begin with %%MatrixMarket");
    std::string wanted = "%%MatrixMarket matrix " + format + " real " + symmetries[0];
    for (std::size_t i = 1; i < symmetries.size(); ++i) wanted += "|" + symmetries[i];
    if (word.size() != 5 || word[1] != "matrix" || word[2] != format || (word[3] != "real" && word[3] != "integer") ||
        std::find(symmetries.begin(), symmetries.end(), word[4]) == symmetries.end())
        in.fail("expected `", wanted, "`");
    return std::string(word[4]);
}

// Reads the line with the numbers of rows and columns.
std::array<int, 2> read_size(TextScanner& in) {
    if (!next_record(in)) in.fail("the line with the numbers of rows and columns is missing");
    const int rows = in.small_integer("the number of rows", 1);
    return {rows, in.small_integer("the number of columns", 1)};
}

// Reads `count` records, each by read(k), and the end of the file.
template <class Read>
void read_records(TextScanner& in, long long count, const Read& read) {
    for (long long k = 0; k < count; ++k) {
        if (!next_record(in)) in.fail("the file ends after ", k, " of ", count, " entries");
        read(k);
        in.end_of_line();
    }
    if (next_record(in)) in.fail("expected the end of the file after ", count, " entries");
}

// Sorted by row and column. Refuses repeats, and what contradicts the symmetry.
std::vector<Entry> read_entries(TextScanner& in, int rows, long long count, bool lower_triangle) {
    std::vector<Entry> entries;
    // The count may be wrong: an entry has at least five characters.
    entries.reserve(static_cast<std::size_t>(std::min<long long>(count, (in.end - in.at) / 5)));
    read_records(in, count, [&](long long) {
        const int row = in.small_integer("a row", 1, rows) - 1, col = in.small_integer("a column", 1, rows) - 1;
        entries.push_back({row, col, in.line, in.real("a value")});
    });
    std::sort(entries.begin(), entries.end(), before);
    for (std::size_t k = 1; k < entries.size(); ++k)
        if (entries[k].row == entries[k - 1].row && entries[k].col == entries[k - 1].col)
            in.fail_at(entries[k].line, "entry ", place(entries[k].row, entries[k].col), " was given in line ",
                       entries[k - 1].line, " already");
    for (const Entry& e : entries) {
        if (lower_triangle && e.col > e.row)
            in.fail_at(e.line, "entry ", place(e.row, e.col),
                       " is above the diagonal; a symmetric matrix is given by its lower triangle");
        if (lower_triangle) continue;
        const auto twin = std::lower_bound(entries.begin(), entries.end(), Entry{e.col, e.row, 0, 0}, before);
        const bool found = twin != entries.end() && twin->row == e.col && twin->col == e.row;
        if (e.value != (found ? twin->value : 0))
            in.fail_at(e.line, "the matrix is not symmetric: entries ", place(e.row, e.col), " and ",
                       place(e.col, e.row), " differ");
    }
    return entries;
}

BlockCsr matrix_of_lower_triangle(int rows, int d, const std::vector<Entry>& entries) {
    std::vector<int> pairs;
    for (const Entry& e : entries)
        if (e.row / d > e.col / d) pairs.insert(pairs.end(), {e.row / d, e.col / d});
    BlockCsr A = matrix_of_cells(rows / d, d, pairs, 2);
    for (const Entry& e : entries) {
        if (e.col > e.row) continue;  // a general matrix: equal to the entry below
        const int i = e.row / d, j = e.col / d, r = e.row % d, c = e.col % d;
        A.block(A.find(i, j))[r * d + c] = e.value;
        A.block(A.find(j, i))[c * d + r] = e.value;
    }
    return A;
}

}  // namespace

BlockCsr read_matrix_market(const std::string& path, int d) {
    const std::string text = read_text_file(path);
    TextScanner in(text, path);
    const bool symmetric = banner(in, "coordinate", {"symmetric", "general"}) == "symmetric";
    const auto [rows, columns] = read_size(in);
    const int size_line = in.line;
    if (columns != rows) in.fail("the matrix is not square");
    const long long count = in.integer("the number of entries", 0, (INT_MAX - rows) / 2);
    in.end_of_line();
    if (rows % d) throw UsageError("block=", d, " does not divide the ", rows, " rows of ", path);

    const std::vector<Entry> entries = read_entries(in, rows, count, symmetric);
    if (rows > 2 * count)  // bounds what is allocated for the rows by the length of the file
        in.fail_at(size_line, "the matrix is singular: ", count, " entries leave some of the ", rows, " rows empty");
    return matrix_of_lower_triangle(rows, d, entries);
}

std::vector<double> read_matrix_market_vector(const std::string& path, int rows) {
    const std::string text = read_text_file(path);
    TextScanner in(text, path);
    banner(in, "array", {"general"});
    const auto [found, columns] = read_size(in);
    if (found != rows) in.fail("the right-hand side has ", found, " rows, the matrix ", rows);
    if (columns != 1) in.fail("expected one column");
    in.end_of_line();
    std::vector<double> b(rows);
    read_records(in, rows, [&](long long i) { b[i] = in.real("a value"); });
    return b;
}

std::string matrix_market_text(const BlockCsr& A) {
    std::string entries;
    long long count = 0;
    for (int i = 0; i < A.n; ++i)
        for (int r = 0; r < A.d; ++r)
            for (int k = A.row[i]; k < A.row[i + 1] && A.col[k] <= i; ++k)
                for (int c = 0, columns = A.col[k] < i ? A.d : r + 1; c < columns; ++c, ++count) {
                    append(entries, static_cast<long long>(i) * A.d + r + 1);
                    append(entries += ' ', static_cast<long long>(A.col[k]) * A.d + c + 1);
                    append(entries += ' ', A.block(k)[r * A.d + c], 17);
                    entries += '\n';
                }
    return concat("%%MatrixMarket matrix coordinate real symmetric\n", A.size(), " ", A.size(), " ", count, "\n") +
           entries;
}

std::string matrix_market_text(const std::vector<double>& b) {
    std::string text = concat("%%MatrixMarket matrix array real general\n", b.size(), " 1\n");
    for (double value : b) {
        append(text, value, 17);
        text += '\n';
    }
    return text;
}

}  // namespace almesh
