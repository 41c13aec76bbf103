#include "report/results_folder.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <memory>

#include "base/version.hpp"
#include "deck/deck.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_CASE("a run begins with the results of the last one gone, and leaves what is not its own") {
    const RingDeck ring;
    REQUIRE(ring.run({"iterates=1", "final=both", "proof=yes", "expect status = converged"}).code == 0);
    CHECK(text_of(ring.output + "/final.proof").starts_with("almesh proof 1\n"));
    std::ofstream(ring.output + "/frame-0001.proof.msh") << "of a frame in another format";
    std::ofstream(ring.output + "/final.msh.part4711") << "torn";
    std::ofstream(ring.output + "/notes.txt") << "mine";
    std::ofstream(ring.output + "/old-final.msh") << "mine";
    std::ofstream(ring.output + "/iterate-a.txt") << "mine";
    {
        const ResultsFolder folder(read_deck(ring.deck));
        CHECK(files_in(ring.output) == std::vector<std::string>{"almesh.lock", "deck.txt", "iterate-a.txt",
                                                                "notes.txt", "old-final.msh"});
    }
    CHECK(files_in(ring.output) ==
          std::vector<std::string>{"deck.txt", "iterate-a.txt", "notes.txt", "old-final.msh"});
}

TEST_CASE("what is wrong with a deck loses no earlier results") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const auto before = files_in(ring.output);
    CHECK(ring.run({"boundary inner=translate 90 0"}).code == 2);
    CHECK(ring.run({"mesh=missing.msh"}).code == 2);
    CHECK(ring.run({"degree=9"}).code == 1);
    CHECK(files_in(ring.output) == before);
}

TEST_CASE("two runs do not share a folder; the lock of one that was killed is none") {
    const RingDeck ring;
    const Deck deck = read_deck(ring.deck);
    {
        const ResultsFolder mine(deck);
        const Outcome other = ring.run();
        CHECK(other.code == 2);
        CHECK(has(other.error,
                  "another run writes to " + ring.output + " (process " + std::to_string(getpid()) + " on "));
        CHECK(has(other.error, "output = FOLDER"));
        CHECK(ring.run({"output=" + ring.folder.path("other")}).code == 0);
    }
    const pid_t child = fork();
    if (child == 0) {
        const ResultsFolder theirs(deck);
        std::raise(SIGKILL);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(files_in(ring.output) == std::vector<std::string>{"almesh.lock"});
    CHECK(ring.run().code == 0);
    CHECK(!std::filesystem::exists(ring.output + "/almesh.lock"));
}

TEST_CASE("a run does not replace its own input") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const std::string final_mesh = ring.output + "/final.msh", text = text_of(final_mesh);
    const auto refused = [&](const Outcome& outcome) {
        CHECK(outcome.code == 1);
        CHECK(has(outcome.error, final_mesh + " is among the results in the folder " + ring.output));
        CHECK(text_of(final_mesh) == text);
    };
    refused(ring.run({"mesh=" + final_mesh}));
    refused(ring.run({"boundary inner=mesh " + final_mesh}));
    CHECK(ring.run({"mesh=" + final_mesh, "output=" + ring.folder.path("next")}).code == 0);

    REQUIRE(almesh_with({ring.output + "/deck.txt"}).code == 0);  // repeats the run in its place
    CHECK(text_of(final_mesh) == text);
}

TEST_CASE("a run whose motions take another file of the same name has another id") {
    const RingDeck ring;
    std::vector<std::string> ids;
    for (const char* by : {"0.1", "0.1", "0.2"}) {
        std::string rows;
        for (int i = 1; i <= 12; ++i) rows += concat(i, " ", by, " 0\n");
        REQUIRE(ring.run({"boundary inner=file " + ring.folder.write("wall.csv", rows) + " displacement"}).code == 0);
        ids.push_back(summary_of(ring.output).at("run"));
    }
    CHECK(ids[1] == ids[0]);
    CHECK(ids[2] != ids[0]);
}

TEST_CASE("all files of a run but the patched mesh carry its id, that of the same run again, and of no other") {
    const RingDeck ring;
    const auto id_of = [&ring] { return summary_of(ring.output).at("run"); };
    REQUIRE(ring.run({"final=both", "iterates=1", "expect status = converged"}).code == 0);
    const std::string id = id_of();
    CHECK(id.size() == 16);
    for (const std::string& name : files_in(ring.output)) {
        if (name == "iterates.vtk.series" || name == "final.msh") continue;
        CAPTURE(name);
        CHECK(has(text_of(ring.output + "/" + name), id));
    }
    REQUIRE(ring.run({"final=both", "iterates=1", "expect status = converged", "threads=2",
                      "output=" + ring.folder.path("other")}).code == 0);
    CHECK(summary_of(ring.folder.path("other")).at("run") == id);
    CHECK(text_of(ring.folder.path("other") + "/final.msh") == text_of(ring.output + "/final.msh"));
    REQUIRE(ring.run().code == 0);
    CHECK(id_of() != id);
    REQUIRE(ring.run({"degree=2"}).code == 0);
    CHECK(almesh_with({"info", ring.output + "/final.msh"}).code == 0);
    CHECK(has(text_of(ring.output + "/final.msh"), "$Comments\n" + version() + ", run " + id_of() + "\n$EndComments\n"));
}
