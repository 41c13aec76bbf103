// A part of a test in a process of its own, which may be killed.
#pragma once
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace almesh::test {

// Its exit code, or minus the signal that ended it.
template <class Body, class Meanwhile>
int in_child(const Body& body, const Meanwhile& meanwhile) {
    const pid_t child = fork();
    if (child == 0) _exit(body());
    meanwhile(child);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace almesh::test
