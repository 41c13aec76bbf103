#include "app/commands.hpp"

#include <doctest/doctest.h>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "io/matrix_market.hpp"
#include "support/matrices.hpp"
#include "support/program.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string header = "%%MatrixMarket matrix coordinate real symmetric\n";

// The number after `name` at the start of a line.
double printed(const std::string& text, const std::string& name) {
    for (const std::string& line : pieces(text, '\n'))
        if (line.starts_with(name + " ")) return std::stod(line.substr(name.size()));
    FAIL("no line of " << name);
    return 0;
}

}  // namespace

TEST_CASE("linsolve: both solvers solve a positive definite matrix, whatever the blocks") {
    const TemporaryFolder folder;
    const BlockCsr A = random_spd(48, 2, grid(6, 8));
    const std::string path = folder.write("A.mtx", matrix_market_text(A));
    for (const char* block : {"block=1", "block=2", "block=3"}) {
        const Outcome direct = almesh_with({"linsolve", path, block});
        CHECK(direct.code == 0);
        CHECK(has(direct.out, "A.mtx: 96 unknowns in " + std::to_string(96 / (block[6] - '0')) + " nodes"));
        CHECK(printed(direct.out, "nnz(A)") == A.value.size());
        CHECK(printed(direct.out, "nnz(L)") >= 96);
        for (const char* part : {"\nordering        nested_dissection\n", "\nfill ", "\nflops ", "\nmemory ",
                                 "\nanalysis ", "\nfactorisation ", " GF/s\n", "\nsolve ", " GB/s\n"})
            CHECK(has(direct.out, part));
        CHECK(printed(direct.out, "scaled residual") < 1e-14);

        for (const char* solver : {"solver=cg", "solver=gmres"}) {
            const Outcome iterative = almesh_with({"linsolve", path, block, solver});
            CHECK(iterative.code == 0);
            CHECK(printed(iterative.out, "iterations") > 0);
            CHECK(printed(iterative.out, "scaled residual") < 1e-10);
        }
    }
}

TEST_CASE("linsolve: every ordering gives the solution, rcm and natural with more fill") {
    const TemporaryFolder folder;
    const std::string path = folder.write("A.mtx", matrix_market_text(random_spd(2500, 1, grid(50, 50))));
    const double least = printed(almesh_with({"linsolve", path}).out, "nnz(L)");
    for (const char* name : {"minimum_degree", "rcm", "natural"}) {
        const Outcome outcome = almesh_with({"linsolve", path, std::string("ordering=") + name});
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, std::string("ordering        ") + name + "\n"));
        CHECK(printed(outcome.out, "nnz(L)") > (name == std::string("minimum_degree") ? 0.9 : 1.3) * least);
        CHECK(printed(outcome.out, "scaled residual") < 1e-14);
    }
    for (const char* name : {"rcm", "natural"})
        CHECK(almesh_with({"linsolve", path, "solver=gmres", std::string("ordering=") + name}).code == 0);
}

TEST_CASE("linsolve: minimum degree of a large matrix is refused") {
    const TemporaryFolder folder;
    std::string text = header + "40001 40001 40001\n";
    for (int i = 1; i <= 40001; ++i) text += std::to_string(i) + " " + std::to_string(i) + " 1\n";
    const std::string path = folder.write("A.mtx", text);
    const Outcome outcome = almesh_with({"linsolve", path, "ordering=minimum_degree"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "takes at most 40000 nodes, the matrix has 40001; use nested_dissection"));
}

TEST_CASE("linsolve: a factor that cannot fit is refused with its size, and what to do is said") {
    const TemporaryFolder folder;
    std::string text = header + "600000 600000 1199999\n";  // an arrow the wrong way round: L is full
    for (int i = 1; i <= 600000; ++i) text += std::to_string(i) + " 1 1\n";
    for (int i = 2; i <= 600000; ++i) text += std::to_string(i) + " " + std::to_string(i) + " 1e6\n";
    const Outcome outcome = almesh_with({"linsolve", folder.write("A.mtx", text), "ordering=natural"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "not solved: the factorisation takes "));
    CHECK(has(outcome.out, " GB, more than the machine's memory; use ordering=nested_dissection\n"));
}

TEST_CASE("linsolve: the right-hand side of a file") {
    const TemporaryFolder folder;
    const Outcome outcome =
        almesh_with({"linsolve", folder.write("A.mtx", header + "3 3 5\n1 1 2\n2 1 -1\n2 2 2\n3 2 -1\n3 3 2\n"),
                     folder.write("b.mtx", "%%MatrixMarket matrix array real general\n3 1\n1\n0\n1\n"),
                     "solver=gmres"});
    CHECK(outcome.code == 0);
    CHECK(printed(outcome.out, "nnz(A)") == 7);
    // ILU(0) of a tridiagonal matrix is exact, but for single precision.
    CHECK(printed(outcome.out, "iterations") <= 2);
}

TEST_CASE("linsolve: threads are those asked for") {
    const TemporaryFolder folder;
    const std::string path = folder.write("A.mtx", matrix_market_text(random_spd(20, 1, grid(4, 5))));
    const int before = max_threads();
    const Outcome outcome = almesh_with({"linsolve", path, "threads=2"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "threads " + std::to_string(max_threads()) + "\n"));
#ifdef _OPENMP
    CHECK(max_threads() == 2);
#endif
    set_threads(before);
}

TEST_CASE("linsolve: where ILU(0) breaks down it is of a heavier diagonal, and says so; in 2D SSOR steps in") {
    const TemporaryFolder folder;
    // Four nodes in a ring, springs of alternating sign: positive definite, but not without its fill. With two numbers
    // a node the same twice.
    const auto ring = [&](int d) {
        const double spring[4][4] = {{1.6, 1, 0, -1}, {1, 1.6, 1, 0}, {0, 1, 1.6, 1}, {-1, 0, 1, 1.6}};
        std::string entries;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j <= i; ++j)
                for (int a = 0; a < d && spring[i][j] != 0; ++a)
                    entries += concat(i * d + a + 1, " ", j * d + a + 1, " ", spring[i][j], "\n");
        const std::string size = std::to_string(4 * d);
        return folder.write("A" + size + ".mtx",
                            header + size + " " + size + " " + std::to_string(8 * d) + "\n" + entries);
    };
    const Outcome outcome = almesh_with({"linsolve", ring(1), "solver=cg"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "\nshift           0.1: ILU(0) of the matrix with a heavier diagonal\n"));
    CHECK_FALSE(has(almesh_with({"linsolve", ring(1)}).out, "shift"));
    CHECK(almesh_with({"linsolve", ring(3), "solver=cg", "block=3"}).code == 0);
    const Outcome flat = almesh_with({"linsolve", ring(2), "solver=cg", "block=2"});
    CHECK(flat.code == 0);
    CHECK(has(flat.out, "\nSSOR, coarse    "));
    CHECK(almesh_with({"linsolve", ring(2), "solver=cg", "block=2", "preconditioner=ssor"}).code == 0);
    const Outcome refused = almesh_with({"linsolve", ring(2), "solver=cg", "block=2", "preconditioner=ilu0"});
    CHECK(refused.code == 3);
    CHECK(has(refused.out, "not solved: ILU(0) met a pivot that is not positive in rows "));
}

TEST_CASE("linsolve: an indefinite matrix ends with code 3 and names its row") {
    const TemporaryFolder folder;
    const std::string path = folder.write("A.mtx", header + "4 4 4\n1 1 1\n2 2 1\n3 3 -1\n4 4 1\n");
    const Outcome single = almesh_with({"linsolve", path});
    CHECK(single.code == 3);
    CHECK(has(single.out, "not solved: the matrix is not positive definite, the pivot of row 3 is not positive\n"));
    CHECK(has(single.out, "\nscaled residual "));
    CHECK(has(almesh_with({"linsolve", path, "block=2"}).out, "the pivot of rows 3 to 4 is not positive\n"));
    for (const char* solver : {"solver=cg", "solver=gmres"}) {
        const Outcome iterative = almesh_with({"linsolve", path, solver});
        CHECK(iterative.code == 3);
        CHECK(has(iterative.out, "not solved: ILU(0) met a pivot that is not positive in row 3\n"));
    }
}

TEST_CASE("linsolve: what conjugate gradients and GMRES cannot solve ends with code 3") {
    const TemporaryFolder folder;
    // A Laplacian made indefinite by a shift below what ILU(0) notices, but the coarse space unless a node is fixed.
    for (double fixed : {0.0, 10.0}) {
        BlockCsr A = random_spd(400, 1, grid(20, 20));
        for (int i = 0; i < A.n; ++i)
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                A.value[k] = A.col[k] == i ? A.row[i + 1] - A.row[i] - 1 - 5e-3 + (i == 0 ? fixed : 0) : -1;
        const Outcome indefinite = almesh_with({"linsolve", folder.write("A.mtx", matrix_market_text(A)), "solver=cg"});
        CHECK(indefinite.code == 3);
        CHECK(has(indefinite.out, "not solved: the matrix is not positive definite"));
        CHECK(has(indefinite.out, "|b - Ax|/|b| = ") == (fixed > 0));
        CHECK(has(indefinite.out, "\nscaled residual "));
    }

    const std::string small = folder.write("S.mtx", header + "1 1 1\n1 1 1e-200\n");
    const std::string b = folder.write("b.mtx", "%%MatrixMarket matrix array real general\n1 1\n1e200\n");
    for (const char* solver : {"solver=cg", "solver=gmres"}) {
        const Outcome outcome = almesh_with({"linsolve", small, b, solver});
        CHECK(outcome.code == 3);
        CHECK(has(outcome.out, "not solved: breakdown"));
    }
}

TEST_CASE("linsolve: overflow is no solution") {
    const TemporaryFolder folder;
    const Outcome sums =
        almesh_with({"linsolve", folder.write("A.mtx", header + "2 2 3\n1 1 1.5e308\n2 1 1.5e308\n2 2 1.5e308\n")});
    CHECK(sums.code == 2);
    CHECK(has(sums.error, "A.mtx: A x overflows"));
    const Outcome solution =
        almesh_with({"linsolve", folder.write("B.mtx", header + "1 1 1\n1 1 1e-200\n"),
                     folder.write("b.mtx", "%%MatrixMarket matrix array real general\n1 1\n1e200\n")});
    CHECK(solution.code == 3);
    CHECK(has(solution.out, "not solved: the residual is too large"));
}

TEST_CASE("linsolve: wrong command lines and files") {
    const TemporaryFolder folder;
    const std::string path = folder.write("A.mtx", header + "1 1 1\n1 1 1\n");
    for (const auto& [arguments, code, message] : std::vector<std::tuple<std::vector<std::string>, int, std::string>>{
             {{}, 1, "almesh linsolve A.mtx"},
             {{"a", "b", "c"}, 1, "at most one right-hand side"},
             {{path, "solver=lu"}, 1, "solver takes cholesky, cg or gmres, not `lu`"},
             {{path, "ordering=amd"}, 1, "ordering takes nested_dissection, minimum_degree, rcm or natural, not `amd`"},
             {{path, "solver=gmres", "ordering=minimum_degree"}, 1, "ILU(0) of solver=gmres takes rcm or natural"},
             {{path, "threads=0"}, 1, "threads takes an integer in 1..1024, not `0`"},
             {{path, "block=4"}, 1, "block takes an integer in 1..3, not `4`"},
             {{path, "block=2"}, 1, "block=2 does not divide the 1 rows of "},
             {{path, "blok=2"}, 1, "linsolve has no key `blok`"},
             {{"no/such.mtx"}, 2, "no/such.mtx"},
             {{path, path}, 2, "A.mtx:1: expected `%%MatrixMarket matrix array real general`"}}) {
        std::vector<std::string> all{"linsolve"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome outcome = almesh_with(all);
        CHECK(outcome.code == code);
        CHECK(has(outcome.error, message));
    }
}

TEST_CASE("the system of a Newton step is written and solved again") {
    const RingDeck ring;
    REQUIRE(ring.run({"write_system=2"}).code == 0);
    const Outcome outcome = almesh_with({"linsolve", ring.output + "/A.mtx", ring.output + "/b.mtx", "block=2"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, std::to_string(2 * mesh_of(ring.output + "/final.msh").nodes()) + " unknowns"));
    REQUIRE(ring.run({"write_system=0", "output=" + ring.folder.path("other")}).code == 0);
    CHECK(!std::filesystem::exists(ring.folder.path("other") + "/A.mtx"));
}
