#include "linalg/krylov/reordered.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"
#include "support/matrices.hpp"

using namespace almesh;

TEST_CASE("P A P' is the matrix in the other order: it multiplies reordered vectors as A does") {
    for (int d = 1; d <= 3; ++d) {
        const BlockCsr A = random_spd(120, d, grid(12, 10));
        Reordered reordered(A, reverse_cuthill_mckee(graph_of(A)));
        const std::vector<int>& order = reordered.order();
        REQUIRE(is_permutation(order));
        reordered.set(A);
        const BlockCsr& B = reordered.matrix();
        for (int i = 0; i < B.n; ++i)
            for (int k = B.row[i]; k < B.row[i + 1]; ++k) {
                if (k > B.row[i]) CHECK(B.col[k - 1] < B.col[k]);
                const int source = A.find(order[i], order[B.col[k]]);
                REQUIRE(source >= 0);
                CHECK(std::equal(B.block(k), B.block(k) + d * d, A.block(source)));
            }
        const std::vector<double> x = random_vector(A.size());
        std::vector<double> Ax(A.size()), Px(A.size()), BPx(A.size()), back(A.size());
        multiply(A, x.data(), Ax.data());
        reordered.gather(x.data(), Px.data());
        multiply(B, Px.data(), BPx.data());
        reordered.scatter(BPx.data(), back.data());
        CHECK(max_difference(back, Ax) < 1e-13);
        reordered.scatter(Px.data(), back.data());
        CHECK(back == x);
    }
}

TEST_CASE("set() takes new values on the same pattern") {
    BlockCsr A = random_spd(20, 2, path(20));
    Reordered reordered(A, reverse_cuthill_mckee(graph_of(A)));
    reordered.set(A);
    CHECK(norm_inf(reordered.matrix()) == doctest::Approx(norm_inf(A)));
    for (double& v : A.value) v *= 2;
    reordered.set(A);
    CHECK(norm_inf(reordered.matrix()) == doctest::Approx(norm_inf(A)));
}
