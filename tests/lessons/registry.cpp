// Compiled for each lesson, with its HEADER and the NAMES that its check file lists, and linked with the answers into a
// shared object: the table in which the judge (child.cpp) finds them.
#include "lessons/registry.hpp"

#include <cstdlib>

#include HEADER
#include "lessons/each.hpp"

namespace almesh::lessons {
namespace {

template <auto member>
struct Member;

// A member function as one that takes the object first.
template <class Class, class Result, class... Arguments, Result (Class::*member)(Arguments...) const>
struct Member<member> {
    static Result call(const Class& object, Arguments... arguments) { return (object.*member)(arguments...); }
};

template <auto answer>
void* address() {
    if constexpr (requires { &Member<answer>::call; }) return reinterpret_cast<void*>(&Member<answer>::call);
    else return reinterpret_cast<void*>(answer);
}

}  // namespace
}  // namespace almesh::lessons

#define ENTRY(answer) {#answer, almesh::lessons::address<&almesh::lessons::answer>()},

extern "C" {

[[gnu::visibility("default")]] extern const almesh::lessons::AnswerEntry almesh_answers[] = {
    ALMESH_FOR_EACH(ENTRY, NAMES){nullptr, nullptr}};

// Set by the judge. Called in place of a function that does not compile, with its number.
[[gnu::visibility("default")]] void (*almesh_is_absent)(int) = nullptr;

[[noreturn]] void almesh_absent(int which) {
    if (almesh_is_absent) almesh_is_absent(which);
    std::abort();
}

// In place of one that is not there.
[[noreturn]] void almesh_missing() { almesh_absent(-1); }

}
