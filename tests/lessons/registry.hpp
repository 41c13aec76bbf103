// What the judge finds in the shared object of a lesson's answers: the names of the functions and where they are.
#pragma once

namespace almesh::lessons {

struct AnswerEntry {
    const char* name;  // null after the last
    void* address;
};

}  // namespace almesh::lessons
