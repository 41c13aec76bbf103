// All entries are read and sorted before the matrix is made, so that repeated, missing and unsymmetric ones are found
// and named with their lines.
#include "io/matrix_market.hpp"

#include <algorithm>
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

std::string place(int row, int col) {
    std::string text(1, '(');
    append(text, static_cast<long long>(row) + 1);
    append(text += ", ", static_cast<long long>(col) + 1);
    return text += ')';
}

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
        in.fail("expected `" + wanted + "`");
    return std::string(word[4]);
}

void size_record(TextScanner& in) {
    if (!next_record(in)) in.fail("the line with the numbers of rows and columns is missing");
}

void begin_entry(TextScanner& in, long long done, long long count) {
    if (!next_record(in))
        in.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(count) + " entries");
}

void end_of_entries(TextScanner& in, long long count) {
    if (next_record(in)) in.fail("expected the end of the file after " + std::to_string(count) + " entries");
}

// Sorted by row and column, without repeats.
std::vector<Entry> read_entries(TextScanner& in, int rows, long long count) {
    std::vector<Entry> entries;
    // The count may be wrong: an entry has at least five characters.
    entries.reserve(static_cast<std::size_t>(std::min<long long>(count, (in.end - in.at) / 5)));
    for (long long k = 0; k < count; ++k) {
        begin_entry(in, k, count);
        const int row = static_cast<int>(in.integer("a row", 1, rows)) - 1;
        const int col = static_cast<int>(in.integer("a column", 1, rows)) - 1;
        entries.push_back({row, col, in.line, in.real("a value")});
        in.end_of_line();
    }
    end_of_entries(in, count);
    std::sort(entries.begin(), entries.end(), before);
    for (std::size_t k = 1; k < entries.size(); ++k)
        if (entries[k].row == entries[k - 1].row && entries[k].col == entries[k - 1].col)
            in.fail(entries[k].line, "entry " + place(entries[k].row, entries[k].col) + " was given in line " +
                                         std::to_string(entries[k - 1].line) + " already");
    return entries;
}

void refuse_upper_triangle(const TextScanner& in, const std::vector<Entry>& entries) {
    for (const Entry& e : entries)
        if (e.col > e.row)
            in.fail(e.line, "entry " + place(e.row, e.col) +
                                " is above the diagonal; a symmetric matrix is given by its lower triangle");
}

void refuse_unsymmetric(const TextScanner& in, const std::vector<Entry>& entries) {
    for (const Entry& e : entries) {
        const auto twin = std::lower_bound(entries.begin(), entries.end(), Entry{e.col, e.row, 0, 0}, before);
        const bool found = twin != entries.end() && twin->row == e.col && twin->col == e.row;
        if (e.value != (found ? twin->value : 0))
            in.fail(e.line, "the matrix is not symmetric: entries " + place(e.row, e.col) + " and " +
                                place(e.col, e.row) + " differ");
    }
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
    size_record(in);
    const int size_line = in.line;
    const int rows = in.small_integer("the number of rows", 1);
    if (in.small_integer("the number of columns", 1) != rows) in.fail("the matrix is not square");
    const long long count = in.integer("the number of entries", 0, (INT_MAX - rows) / 2);
    in.end_of_line();
    if (rows % d)
        throw UsageError("block=" + std::to_string(d) + " does not divide the " + std::to_string(rows) + " rows of " +
                         path);

    const std::vector<Entry> entries = read_entries(in, rows, count);
    if (symmetric) refuse_upper_triangle(in, entries);
    else refuse_unsymmetric(in, entries);
    if (rows > 2 * count)  // bounds what is allocated for the rows by the length of the file
        in.fail(size_line, "the matrix is singular: " + std::to_string(count) + " entries leave some of the " +
                               std::to_string(rows) + " rows empty");
    return matrix_of_lower_triangle(rows, d, entries);
}

std::vector<double> read_matrix_market_vector(const std::string& path, int rows) {
    const std::string text = read_text_file(path);
    TextScanner in(text, path);
    banner(in, "array", {"general"});
    size_record(in);
    const int found = in.small_integer("the number of rows", 1);
    if (found != rows)
        in.fail("the right-hand side has " + std::to_string(found) + " rows, the matrix " + std::to_string(rows));
    if (in.small_integer("the number of columns", 1) != 1) in.fail("expected one column");
    in.end_of_line();

    std::vector<double> b(rows);
    for (int i = 0; i < rows; ++i) {
        begin_entry(in, i, rows);
        b[i] = in.real("a value");
        in.end_of_line();
    }
    end_of_entries(in, rows);
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
    const std::string size = std::to_string(A.size());
    return "%%MatrixMarket matrix coordinate real symmetric\n" + size + " " + size + " " + std::to_string(count) +
           "\n" + entries;
}

std::string matrix_market_text(const std::vector<double>& b) {
    std::string text = "%%MatrixMarket matrix array real general\n";
    text += std::to_string(b.size()) + " 1\n";
    for (double value : b) {
        append(text, value, 17);
        text += '\n';
    }
    return text;
}

}  // namespace almesh
