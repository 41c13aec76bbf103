#include "fuzz/harness.hpp"
#include "fuzz/independent_check.hpp"
#include "fuzz/small_mesh.hpp"

namespace almesh::fuzz {

void fuzz_quality(std::string_view bytes) {
    Choices choose(bytes);
    const Mesh mesh = small_mesh(choose);
    const std::string path = work_folder().write("quality.mesh", damaged(text_of_mesh(mesh), choose));
    const test::Outcome outcome = outcome_of({"quality", path});
    demand(outcome.code == 0 || outcome.code == 2 || outcome.code == 4, "exit code ", outcome.code, " of quality");
    if (outcome.code != 0) return;
    const std::string fault = fault_of(Elements(read_mesh(path)), true);
    demand(fault.empty(), "certified, but ", fault, "\n", outcome.out);
}

}  // namespace almesh::fuzz
