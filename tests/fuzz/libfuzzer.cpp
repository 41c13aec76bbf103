// The harness that the environment names in HARNESS, for clang's libFuzzer: `make fuzz`.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/harness.hpp"

namespace {

const almesh::fuzz::Harness* harness = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const name = std::getenv("HARNESS");
    for (const almesh::fuzz::Harness& row : almesh::fuzz::harnesses)
        if (name && row.name == name) harness = &row;
    if (harness) return 0;
    std::fputs("HARNESS must be one of", stderr);
    for (const almesh::fuzz::Harness& row : almesh::fuzz::harnesses) std::fprintf(stderr, " %s", row.name.data());
    std::fputs("\n", stderr);
    std::exit(1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    harness->run({reinterpret_cast<const char*>(data), size});
    return 0;
}
