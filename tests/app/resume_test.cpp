// Runs that were killed, interrupted or had no room to write, and go on with `resume = 1`.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "base/stopwatch.hpp"
#include "support/child.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// What must be the same, however often the run was interrupted.
struct Results {
    std::string final_mesh;
    std::vector<std::vector<std::string>> history;
    std::vector<std::pair<std::string, std::string>> summary;

    explicit Results(const std::string& folder)
        : final_mesh(text_of(folder + "/final.msh")), history(history_without_times(folder)) {
        for (const auto& line : summary_lines(folder))
            if (!line.first.starts_with("time") && !line.first.starts_with("peak")) summary.push_back(line);
    }
    bool operator==(const Results&) const = default;
};

std::vector<std::string> saving(std::vector<std::string> settings, bool resume) {
    settings.push_back("checkpoint=1e-9");
    if (resume) settings.push_back("resume=1");
    return settings;
}

}  // namespace

TEST_CASE("a run killed at 100 random moments and resumed ends with the same bits") {
    const RingDeck ring;
    const std::vector<std::vector<std::string>> all_settings = {
        {"algorithm=adaptive", "refine=1", "degree=2"}, {"algorithm=paper", "iterates=2"}, {"objective=minimax"}};
    std::mt19937 random(20261123);
    int kills = 0;
    for (const auto& settings : all_settings) {
        const Stopwatch watch;
        REQUIRE(ring.run(saving(settings, false)).code == 0);
        std::uniform_real_distribution<double> moment(0, watch.seconds());
        const Results whole(ring.output);
        const std::string iterate = text_of(ring.output + "/iterate-0002.vtk");
        for (const int enough = kills + 34; kills < enough;) {
            int code = -SIGKILL;
            for (bool resume = false; code == -SIGKILL; resume = true) {
                const auto run = [&] { return ring.run(saving(settings, resume)).code; };
                code = in_child(run, [&](pid_t child) {
                    if (kills >= enough) return;
                    std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
                    kill(child, SIGKILL);
                });
                kills += code == -SIGKILL;
            }
            CHECK(code == 0);
            CHECK(Results(ring.output) == whole);
            CHECK(text_of(ring.output + "/iterate-0002.vtk") == iterate);
            CHECK(!std::filesystem::exists(ring.output + "/checkpoint"));
        }
    }
    CHECK(kills >= 100);
}

namespace {

// A run that a SIGTERM has ended in good order, after some of its steps.
void interrupt(const RingDeck& ring) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        const auto run = [&] { return ring.run({"checkpoint=1e-9"}).code; };
        const int code = in_child(run, [&](pid_t child) {
            const std::string state = ring.output + "/checkpoint/0001.state";
            for (int k = 0; k < 10000 && !std::filesystem::exists(state); ++k)
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            kill(child, SIGTERM);
        });
        if (code == 3) return;
    }
    FAIL("the run is over before the signal comes");
}

const std::string slow_run = "threads = 1\nrefine = 2\ndegree = 3\nstart = identity\n";

}  // namespace

TEST_CASE("a run that a signal ended says how to go on, and does") {
    const RingDeck ring(ring_mesh(12, 3, 6), slow_run);
    REQUIRE(ring.run().code == 0);
    const Results whole(ring.output);
    interrupt(ring);
    CHECK(summary_of(ring.output).at("status") == "interrupted");
    Outcome outcome = ring.run({"resume=1"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "resumes from "));
    CHECK(has(outcome.out, " in " + ring.output + "/checkpoint\n"));
    CHECK(Results(ring.output) == whole);

    outcome = ring.run({"resume=1"});  // of a run that has come to its end
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "note: no saved state in " + ring.output + "/checkpoint: the run starts from the begin"));
    CHECK(Results(ring.output) == whole);
    CHECK(!has(ring.run({"max_seconds=1e-9"}).out, "resume=1"));  // where nothing has been done yet
}

TEST_CASE("what cannot be resumed is refused and stays; a run that is not to be resumed removes it") {
    const RingDeck ring(ring_mesh(12, 3, 6), slow_run);
    const std::string state = ring.output + "/checkpoint/0001.state";
    interrupt(ring);
    const Results before(ring.output);
    const Outcome other = ring.run({"resume=1", "omega_star=1e-7"});
    CHECK(other.code == 1);
    CHECK(has(other.error, "cannot resume: " + ring.output + "/checkpoint has the state of another run or program"));
    const Outcome without = ring.run({"resume=1", "checkpoint=0"});
    CHECK(without.code == 1);
    CHECK(has(without.error, "command line: checkpoint = 0 does not go with resume = 1"));
    CHECK(Results(ring.output) == before);
    CHECK(std::filesystem::exists(state));
    CHECK(ring.run({"resume=1", "checkpoint=5", "max_seconds=1000", "threads=2"}).code == 0);

    interrupt(ring);
    CHECK(ring.run({"checkpoint=0"}).code == 0);
    CHECK(!std::filesystem::exists(state));
}

TEST_CASE("where a disk is full nothing that was there is lost, and the run goes on when there is room again") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    REQUIRE(ring.run().code == 0);
    const Results whole(ring.output);
    const std::string other = ring.folder.path("other");
    const auto size_of = [&](const char* name) { return text_of(ring.output + "/" + name).size(); };
    std::vector<std::size_t> rooms = {0, 100, size_of("deck.txt") + 1, size_of("history.csv") / 2};
    for (const char* name : {"final.msh", "final.vtk", "initial.vtk", "boundary.vtk"})
        rooms.push_back(size_of(name) - 1);
    for (const std::size_t room : rooms) {
        CAPTURE(room);
        std::filesystem::remove_all(other);
        const auto run = [&] {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit limit = {room, room};
            setrlimit(RLIMIT_FSIZE, &limit);
            return ring.run({"output=" + other, "checkpoint=1e-9"}).code;
        };
        CHECK(in_child(run, [](pid_t) {}) == 2);
        CHECK(text_of(other + "/final.msh").size() % whole.final_mesh.size() == 0);  // whole or not there
        CHECK(ring.run({"output=" + other, "checkpoint=1e-9", "resume=1"}).code == 0);
        CHECK(Results(other) == whole);
    }
}
