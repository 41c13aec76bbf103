#include "io/matrix_market.hpp"

#include <doctest/doctest.h>

#include "lessons/matrix_market.hpp"
#include "support/matrices.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("the lower triangle of a matrix is written, and a column, and lesson 10 reads both to the last bit") {
    const TemporaryFolder folder;
    for (const int d : {1, 2, 3}) {
        const BlockCsr A = random_spd(6, d, grid(2, 3));
        const BlockCsr B = lessons::read_matrix(folder.write("A.mtx", matrix_market_text(A)), d);
        CHECK(B.n == A.n);
        CHECK(B.col == A.col);
        CHECK(B.value == A.value);
    }
    const std::vector<double> b = {-1, 2.5e3, 0.1};
    CHECK(lessons::read_vector(folder.write("b.mtx", matrix_market_text(b)), 3) == b);
}
