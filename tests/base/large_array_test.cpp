#include "base/large_array.hpp"

#include <doctest/doctest.h>

#include <cstdint>

using namespace almesh;

TEST_CASE("large arrays can be written to the end, and begin where registers and pages do") {
    const std::size_t page = (std::size_t{1} << 21) / sizeof(double);
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, page - 1, page, page + 1, 5 * page}) {
        LargeArray array = large_array(size);
        for (std::size_t i = 0; i < size; ++i) array[i] = static_cast<double>(i);
        bool kept = true;
        for (std::size_t i = 0; i < size; ++i) kept = kept && array[i] == static_cast<double>(i);
        CHECK(kept);
        CHECK(reinterpret_cast<std::uintptr_t>(array.get()) % (size < page ? 64 : page * sizeof(double)) == 0);
    }
}
