#include "fuzz/choices.hpp"
#include "fuzz/harness.hpp"
#include "io/matrix_market.hpp"

namespace almesh::fuzz {

void fuzz_matrix_market(std::string_view bytes) {
    const int block = 1 + Choices(bytes.substr(0, 1)).byte() % 3;
    const std::string path = work_folder().write("A.mtx", std::string(bytes.substr(std::min<std::size_t>(1, bytes.size()))));
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

}  // namespace almesh::fuzz
