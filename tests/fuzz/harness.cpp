#include "fuzz/harness.hpp"

namespace almesh::fuzz {

test::Outcome outcome_of(const std::vector<std::string>& arguments) {
    const test::Outcome outcome = test::almesh_with(arguments);
    demand(outcome.code >= 0 && outcome.code <= 5, "exit code ", outcome.code);
    const bool refused = outcome.code == 1 || outcome.code == 2;
    demand(refused != outcome.error.empty(), "exit code ", outcome.code, " with the message `", outcome.error, "`");
    demand(!refused || outcome.error.starts_with("almesh: "), outcome.error);
    demand(!test::has(outcome.error, "unexpected error"), outcome.error);
    demand(outcome.error.find(out_of_memory) == std::string::npos, "no input is that large");
    return outcome;
}

const test::TemporaryFolder& work_folder() {
    static const test::TemporaryFolder folder;
    return folder;
}

}  // namespace almesh::fuzz
