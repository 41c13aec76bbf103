// Every seed through its harness: inputs that once broke a promise, and some for every way through the program.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "fuzz/harness.hpp"

using namespace almesh;

TEST_CASE("fuzzing's seeds keep every promise") {
    for (const fuzz::Harness& harness : fuzz::harnesses) {
        const std::filesystem::path seeds = std::filesystem::path("tests/fuzz/seeds") / harness.name;
        std::vector<std::string> paths;
        for (const auto& entry : std::filesystem::directory_iterator(seeds)) paths.push_back(entry.path().string());
        std::sort(paths.begin(), paths.end());
        CHECK(paths.size() >= 5);
        harness.run({});
        for (const std::string& path : paths) {
            CAPTURE(path);
            CHECK_NOTHROW(harness.run(test::text_of(path)));
        }
    }
}
