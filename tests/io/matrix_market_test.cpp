#include "io/matrix_market.hpp"

#include <doctest/doctest.h>

#include "base/error.hpp"
#include "support/matrices.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
const std::string general = "%%MatrixMarket matrix coordinate real general\n";
const std::string array = "%%MatrixMarket matrix array real general\n";

BlockCsr matrix_of(const std::string& text, int d = 1) {
    const TemporaryFolder folder;
    return read_matrix_market(folder.write("A.mtx", text), d);
}

// What the reader says after "folder/A.mtx:".
std::string refusal(const std::string& text, int vector_rows = 0) {
    const TemporaryFolder folder;
    const std::string path = folder.write("A.mtx", text);
    try {
        if (vector_rows) read_matrix_market_vector(path, vector_rows);
        else read_matrix_market(path);
    } catch (const InputError& error) {
        const std::string what = error.what();
        REQUIRE(what.starts_with(path + ":"));
        return what.substr(path.size() + 1);
    }
    return "read";
}

}  // namespace

TEST_CASE("a symmetric matrix is read with both triangles and its whole diagonal") {
    const BlockCsr A = matrix_of("%%matrixmarket MATRIX coordinate Real symmetric\r\n% note\n\n3 3 3\n"
                                 "1 1 2\r\n3 1 -0.5\n\n% note\n2 2 +1e-3\n");
    CHECK(A.n == 3);
    CHECK(A.row == std::vector<int>{0, 2, 3, 5});
    CHECK(A.col == std::vector<int>{0, 2, 1, 0, 2});
    CHECK(A.value == LargeVector<double>{2, -0.5, 1e-3, -0.5, 0});
}

TEST_CASE("a general matrix with symmetric values is the same matrix") {
    const BlockCsr A = matrix_of(symmetric + "3 3 4\n1 1 2\n2 2 3\n3 3 4\n3 1 -1\n");
    const BlockCsr B = matrix_of(general + "3 3 6\n1 3 -1\n3 3 4\n2 2 3\n3 1 -1\n1 1 2\n1 2 0\n");
    CHECK(A.col == B.col);
    CHECK(A.value == B.value);
}

TEST_CASE("rows are grouped into blocks") {
    const BlockCsr A = matrix_of(symmetric + "4 4 5\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n4 1 9\n", 2);
    CHECK(A.n == 2);
    CHECK(A.d == 2);
    CHECK(A.value == LargeVector<double>{1, 0, 0, 2, 0, 9, 0, 0, 0, 0, 9, 0, 3, 0, 0, 4});
    CHECK_THROWS_AS(matrix_of(symmetric + "4 4 4\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n", 3), UsageError);
}

TEST_CASE("what is written reads back to the same bits") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(12, d, grid(3, 4));
        const BlockCsr B = matrix_of(matrix_market_text(A), d);
        CHECK(A.row == B.row);
        CHECK(A.col == B.col);
        CHECK(A.value == B.value);
    }
    BlockCsr A = matrix_of_cells(2, 1, {0, 1}, 2);
    A.value = {0.1, 0, 0, 2};
    CHECK(matrix_market_text(A) == symmetric + "2 2 3\n1 1 0.10000000000000001\n2 1 0\n2 2 2\n");
}

TEST_CASE("what is no symmetric matrix is refused with its line") {
    for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
             {"1 1 1\n", "1: not a Matrix Market file: it has to begin with %%MatrixMarket"},
             {"%%MatrixMarket matrix coordinate complex symmetric\n1 1 1\n1 1 1 0\n",
              "1: expected `%%MatrixMarket matrix coordinate real symmetric|general`"},
             {"%%MatrixMarket matrix coordinate pattern symmetric\n",
              "1: expected `%%MatrixMarket matrix coordinate real symmetric|general`"},
             {array + "1 1\n1\n", "1: expected `%%MatrixMarket matrix coordinate real symmetric|general`"},
             {symmetric, "2: the line with the numbers of rows and columns is missing"},
             {symmetric + "0 0 0\n", "2: the number of rows `0` is out of range"},
             {symmetric + "2 3 1\n1 1 1\n", "2: the matrix is not square"},
             {symmetric + "1 1 -1\n", "2: the number of entries `-1` is out of range"},
             {symmetric + "1 1 1 1\n1 1 1\n", "2: expected the end of the line, got `1`"},
             {symmetric + "2 2 2\n1 1 1\n", "4: the file ends after 1 of 2 entries"},
             {symmetric + "1 1 1\n1 1 1\n1 1 1\n", "4: expected the end of the file after 1 entries"},
             {symmetric + "2 2 1\n3 1 1\n", "3: a row `3` is out of range"},
             {symmetric + "2 2 1\n1 0 1\n", "3: a column `0` is out of range"},
             {symmetric + "1 1 1\n1 1\n", "3: expected a value, got the end of the line"},
             {symmetric + "1 1 1\n1 1 nan\n", "3: a value `nan` is not a finite number"},
             {symmetric + "1 1 1\n1 1 1e400\n", "3: a value `1e400` is not a finite number"},
             {symmetric + "1 1 1\n1 1 1 0\n", "3: expected the end of the line, got `0`"},
             {symmetric + "2 2 3\n1 1 1\n2 2 1\n1 2 1\n",
              "5: entry (1, 2) is above the diagonal; a symmetric matrix is given by its lower triangle"},
             {symmetric + "2 2 3\n2 2 1\n1 1 1\n2 2 1\n", "5: entry (2, 2) was given in line 3 already"},
             {general + "2 2 4\n1 1 1\n1 2 3\n2 1 4\n2 2 1\n",
              "4: the matrix is not symmetric: entries (1, 2) and (2, 1) differ"},
             {general + "2 2 3\n1 1 1\n2 1 4\n2 2 1\n",
              "4: the matrix is not symmetric: entries (2, 1) and (1, 2) differ"}})
        CHECK(refusal(text) == message);
}

TEST_CASE("counts that lie allocate nothing") {
    CHECK(refusal(symmetric + "3 3 1000000000\n1 1 1\n") == "4: the file ends after 1 of 1000000000 entries");
    CHECK(refusal(symmetric + "2000000000 2000000000 1\n1 1 1\n") ==
          "2: the matrix is singular: 1 entries leave some of the 2000000000 rows empty");
    CHECK(refusal(symmetric + "99999999999 99999999999 1\n") == "2: the number of rows `99999999999` is out of range");
    CHECK(refusal(array + "2000000000 1\n1\n", 2) == "2: the right-hand side has 2000000000 rows, the matrix 2");
}

TEST_CASE("right-hand sides") {
    const TemporaryFolder folder;
    CHECK(read_matrix_market_vector(folder.write("b.mtx", array + "% note\n2 1\n-1\n 2.5e3\n"), 2) ==
          std::vector<double>{-1, 2500});
    CHECK(refusal(symmetric + "2 1\n1\n2\n", 2) == "1: expected `%%MatrixMarket matrix array real general`");
    CHECK(refusal(array + "2 2\n1\n2\n3\n4\n", 2) == "2: expected one column");
    CHECK(refusal(array + "2 1\n1\n", 2) == "4: the file ends after 1 of 2 entries");
    CHECK(refusal(array + "2 1\n1\ninf\n", 2) == "4: a value `inf` is not a finite number");
    CHECK(refusal(array + "2 1\n1\n2\n3\n", 2) == "5: expected the end of the file after 2 entries");
}
