#include "base/large_array.hpp"

#include <doctest/doctest.h>

#include <cstdint>

#include "base/lanes.hpp"
#include "base/parallel.hpp"

using namespace almesh;

TEST_CASE("large arrays can be written to the end, and begin where registers and pages do") {
    const std::size_t page = (std::size_t{1} << 21) / sizeof(double);
    for (const std::size_t size : {std::size_t{1}, page - 1, page, page + 1, 5 * page}) {
        LargeVector<double> array(size);
        for (std::size_t i = 0; i < size; ++i) array[i] = static_cast<double>(i);
        bool kept = true;
        for (std::size_t i = 0; i < size; ++i) kept = kept && array[i] == static_cast<double>(i);
        CHECK(kept);
        CHECK(reinterpret_cast<std::uintptr_t>(array.data()) % (size < page ? 64 : page * sizeof(double)) == 0);
    }
}

TEST_CASE("large arrays may be empty, hold registers, and be made inside a parallel region") {
    CHECK(LargeVector<double>().empty());
    CHECK(LargeVector<double>(0).empty());
    LargeVector<Lanes> registers(100000);
    registers.back() = in_all_lanes(2);
    CHECK(sum_of_lanes(registers.back()) == 2 * lanes);
    std::size_t size[2] = {};
    parallel_invoke([&] { size[0] = LargeVector<int>(1 << 21).size(); },
                    [&] { size[1] = LargeVector<int>(1 << 22).size(); });
    CHECK(size[0] == 1 << 21);
    CHECK(size[1] == 1 << 22);
}

TEST_CASE("large arrays keep the values they are given when they are copied and grow") {
    LargeVector<float> array(3, 0.5f);
    const LargeVector<float> copy = array;
    array.resize(std::size_t{1} << 20);
    CHECK(array[2] == 0.5f);
    CHECK(copy == LargeVector<float>{0.5f, 0.5f, 0.5f});
    array.assign(2, 1.5f);
    CHECK(array == LargeVector<float>{1.5f, 1.5f});
}
