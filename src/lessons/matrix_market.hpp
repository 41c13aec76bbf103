// Symmetric sparse matrices and right-hand sides in the Matrix Market exchange format (Boisvert, Pozo & Remington, The
// Matrix Market Exchange Formats: Initial Design, NISTIR 5935, 1996).
//
//   %%MatrixMarket matrix coordinate real symmetric
//   3 3 4          rows, columns, entries
//   1 1 2.5        row and column from 1, value; the lower triangle
#pragma once
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "io/text_scanner.hpp"
#include "linalg/block_csr.hpp"

namespace almesh::lessons {

// The lower triangle of the symmetric A, zeros of its pattern included, each number with 17 digits.
inline std::string matrix_text(const BlockCsr& A) {
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

// A column.
inline std::string vector_text(const std::vector<double>& b) {
    std::string text = concat("%%MatrixMarket matrix array real general\n", b.size(), " 1\n");
    for (double value : b) {
        append(text, value, 17);
        text += '\n';
    }
    return text;
}

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
