// A part of a test in a process of its own, which may be killed.
#pragma once
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace almesh::test {

// Its exit code, or minus the signal that ended it. The OpenMP library of clang++ leaves a file of a killed process,
// and ends every later one that happens to get the same number.
template <class Body, class Meanwhile>
int in_child(const Body& body, const Meanwhile& meanwhile) {
    const pid_t child = fork();
    if (child == 0) _exit(body());
    meanwhile(child);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    if (!WIFSIGNALED(status)) return WEXITSTATUS(status);
    std::remove(("/dev/shm/__KMP_REGISTERED_LIB_" + std::to_string(child) + "_" + std::to_string(getuid())).c_str());
    return -WTERMSIG(status);
}

}  // namespace almesh::test
