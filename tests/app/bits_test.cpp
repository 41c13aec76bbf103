// Every deck gives the same mesh and the same history, to the last bit, with any number of threads. From the
// repository's top folder, where `make long-tests` runs; with other numbers: make reproduce THREADS=1,2,8.
#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Limit {
    std::string deck, setting;
};

// What is left out of decks that take hundreds of Newton steps: the steps left run through every kernel.
const std::vector<Limit> limits = {{"aircraft-squared", "max_newton_iterations=15"}};

struct Result {
    int code;
    std::string mesh;
    std::vector<std::vector<std::string>> history;

    bool operator==(const Result&) const = default;
};

Result run(const std::string& deck, int threads) {
    const TemporaryFolder folder;
    const std::string out = folder.path("out");
    std::vector<std::string> arguments = {"inputs/" + deck + ".deck", "output=" + out, "vtk=none",
                                          "threads=" + std::to_string(threads)};
    for (const Limit& limit : limits)
        if (limit.deck == deck) arguments.push_back(limit.setting);
    const Outcome outcome = almesh_bounded(arguments);
    CAPTURE(outcome.error);
    CHECK(outcome.error.empty());
    return {outcome.code, text_of(out + "/final.msh"), history_without_times(out)};
}

std::vector<std::string> all_decks() {
    std::vector<std::string> decks;
    for (const auto& entry : std::filesystem::directory_iterator("inputs"))
        if (entry.path().extension() == ".deck") decks.push_back(entry.path().stem().string());
    std::sort(decks.begin(), decks.end());
    return decks;
}

}  // namespace

TEST_CASE("every deck gives the same bits with 1 and 3 threads" * doctest::test_suite("long")) {
    if (!std::filesystem::is_directory("inputs")) {
        MESSAGE("no folder inputs here: run the tests from the repository's top folder");
        return;
    }
    const int threads_before = max_threads();
    const std::vector<std::string> decks = all_decks();
    CHECK(decks.size() >= 14);
    for (const Limit& limit : limits) CHECK(std::find(decks.begin(), decks.end(), limit.deck) != decks.end());
    for (const std::string& deck : decks) {
        CAPTURE(deck);
        const Result expected = run(deck, 1);
        CHECK(expected.mesh.size() > 1000);
        CHECK(expected.history.size() >= 3);  // heading, initial mesh, at least one step
        CHECK((run(deck, 3) == expected));
    }
    set_threads(threads_before);
}
