#include <filesystem>

#include "fuzz/harness.hpp"
#include "fuzz/independent_check.hpp"
#include "fuzz/small_mesh.hpp"

namespace almesh::fuzz {

void fuzz_improve(std::string_view bytes) {
    Choices choose(bytes);
    const Mesh mesh = small_mesh(choose);
    const std::string path = work_folder().write("improve.mesh", damaged(text_of_mesh(mesh), choose));
    const std::string output = work_folder().path("improved"), final_mesh = output + "/final.msh";
    constexpr const char* settings[] = {"degree=0", "boundary all=fixed", "degree=2", "surface=straighten"};
    std::filesystem::remove_all(output);
    const test::Outcome outcome = outcome_of({"improve", path, "output=" + output, choose.of(settings), "threads=1",
                                              "max_seconds=0.1", "vtk=none", "final=msh"});
    if (outcome.code != 0) return;
    const std::string fault = fault_of(Elements(read_mesh(final_mesh)), false);
    demand(fault.empty(), "improved, but ", fault, "\n", outcome.out);
}

}  // namespace almesh::fuzz
