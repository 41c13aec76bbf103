#include "base/physical_memory.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <vector>

using namespace almesh;

TEST_CASE("the peak is at least what is in memory, and at most the machine's") {
    constexpr std::size_t size = 80'000'000;
    const std::vector<char> touched(size, 1);
    CHECK(touched[size / 2] == 1);
    CHECK(peak_memory() >= static_cast<double>(size));
    CHECK(peak_memory() <= physical_memory());
}

TEST_CASE("the peak is the program's own, not that of a large one that has started it") {
    constexpr std::size_t size = 600'000'000;
    constexpr int not_started = 127;
    if (std::getenv("ALMESH_STARTED_BY_TEST")) {
        CHECK(peak_memory() < 0.5 * static_cast<double>(size));
        return;
    }
    const std::vector<char> touched(size, 1);
    REQUIRE(touched[size / 2] == 1);
    const pid_t child = fork();
    if (child == 0) {
        setenv("ALMESH_STARTED_BY_TEST", "1", 1);
        execl("/proc/self/exe", "almesh-tests", "-tc=the peak is the program's own*", nullptr);
        _exit(not_started);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    if (WEXITSTATUS(status) != not_started) CHECK(WEXITSTATUS(status) == 0);  // where there is a /proc
}
