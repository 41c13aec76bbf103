// Reads what io/matrix_market.hpp writes: the system of a Newton step, A d = b, for lesson 10.
#pragma once
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "io/text_scanner.hpp"
#include "linalg/block_csr.hpp"

namespace almesh::lessons {

// Reads the first line, lines of comments, and the numbers of rows and columns.
inline int read_rows(TextScanner& in, const std::string& kind) {
    in.next_line();
    if (in.rest_of_line() != "%%MatrixMarket matrix " + kind) in.fail("expected `%%MatrixMarket matrix ", kind, "`");
    while (in.next_line() && *in.at == '%') in.rest_of_line();
    const int rows = in.small_integer("the number of rows", 1);
    in.small_integer("the number of columns", 1);
    return rows;
}

// A symmetric matrix by its lower triangle. d consecutive rows become one block row.
inline BlockCsr read_matrix(const std::string& path, int d = 1) {
    struct Entry {
        int row, col;
        double value;
    };
    const std::string text = read_text_file(path);
    TextScanner in(text, path);
    const int rows = read_rows(in, "coordinate real symmetric");
    if (rows % d) throw UsageError("block=", d, " does not divide the ", rows, " rows of ", path);
    std::vector<Entry> entries(in.integer("the number of entries", 0, in.end - in.at));
    std::vector<int> pairs;
    for (Entry& e : entries) {
        in.next_line();
        e.row = in.small_integer("a row", 1, rows) - 1;
        e.col = in.small_integer("a column of the lower triangle", 1, e.row + 1) - 1;
        e.value = in.real("a value");
        if (e.row / d > e.col / d) pairs.insert(pairs.end(), {e.row / d, e.col / d});
    }
    BlockCsr A = matrix_of_cells(rows / d, d, pairs, 2);
    for (const Entry& e : entries) {
        const int i = e.row / d, j = e.col / d, r = e.row % d, c = e.col % d;
        A.block(A.find(i, j))[r * d + c] = e.value;
        A.block(A.find(j, i))[c * d + r] = e.value;
    }
    return A;
}

// A column of so many numbers.
inline std::vector<double> read_vector(const std::string& path, int rows) {
    const std::string text = read_text_file(path);
    TextScanner in(text, path);
    if (read_rows(in, "array real general") != rows) in.fail("expected ", rows, " rows, as the matrix has");
    std::vector<double> b(rows);
    for (double& value : b) {
        in.next_line();
        value = in.real("a value");
    }
    return b;
}

}  // namespace almesh::lessons
