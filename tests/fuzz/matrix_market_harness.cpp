#include "fuzz/choices.hpp"
#include "fuzz/harness.hpp"
#include "io/matrix_market.hpp"

namespace almesh::fuzz {
namespace {

void check_read_back(const std::string& path, int block) {
    std::optional<BlockCsr> A;
    try {
        A = read_matrix_market(path, block);
    } catch (const Error& error) {
        demand(error.what()[0] != '\0', "a matrix is refused without a word");
        return;
    }
    const BlockCsr again = read_matrix_market(work_folder().write("again.mtx", matrix_market_text(*A)), block);
    demand(again.n == A->n && again.value == A->value, "written again it is another matrix");
}

}  // namespace

void fuzz_matrix_market(std::string_view bytes) {
    Choices choose(bytes.substr(0, 1));
    constexpr const char* solvers[] = {"solver=cholesky", "solver=cg", "solver=gmres"};
    constexpr const char* orderings[] = {"", "ordering=rcm", "ordering=natural", "ordering=minimum_degree"};
    const int choice = choose.byte(), block = 1 + choice % 3;
    std::string text(bytes.substr(std::min<std::size_t>(1, bytes.size())));
    // After a zero byte, the right-hand side.
    const auto zero = text.find('\0');
    const std::string path = work_folder().write("A.mtx", text.substr(0, zero));
    check_read_back(path, block);
    std::vector<std::string> arguments = {"linsolve", path, solvers[choice / 3 % 3], concat("block=", block),
                                          "threads=1"};
    if (zero != text.npos) arguments.push_back(work_folder().write("b.mtx", text.substr(zero + 1)));
    if (const std::string ordering = orderings[choice / 9 % 4]; !ordering.empty()) arguments.push_back(ordering);
    if (choice / 36 % 2) arguments.push_back("preconditioner=ssor");
    const test::Outcome outcome = outcome_of(arguments);
    demand(outcome.code <= 3, "exit code ", outcome.code, " of linsolve");
    demand((outcome.code == 3) == test::has(outcome.out, "not solved: "), "exit code ", outcome.code, " and\n",
           outcome.out);
}

}  // namespace almesh::fuzz
