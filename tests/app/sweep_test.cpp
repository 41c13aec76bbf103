// Many runs of one deck.
#include "app/commands.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "support/child.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::vector<std::string> two_lines = {"sweep mu0=10, 100", "sweep degree=1:1:2"};

Outcome sweep_of(const RingDeck& ring, const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"sweep", ring.deck};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return almesh_with(all);
}

Outcome sweep_of(const RingDeck& ring, std::vector<std::string> arguments, const std::string& more) {
    arguments.push_back(more);
    return sweep_of(ring, arguments);
}

std::vector<std::vector<std::string>> table_of(const RingDeck& ring) {
    return csv_rows(text_of(ring.output + "/sweep.csv"));
}

std::filesystem::file_time_type time_of(const std::string& file) { return std::filesystem::last_write_time(file); }

}  // namespace

TEST_CASE("a sweep runs every combination of its values, with the bits of the run by hand") {
    const RingDeck ring;
    const Outcome outcome = sweep_of(ring, two_lines);
    CHECK(outcome.code == 0);
    CHECK(outcome.error == "");
    CHECK(has(outcome.out, "4 of 4"));
    CHECK(has(outcome.out, "4 runs: 4 of exit code 0"));
    const auto table = table_of(ring);
    REQUIRE(table.size() == 5);
    const std::vector<std::string> wanted[] = {{"1", "0", "10", "1", "converged"},
                                               {"2", "0", "10", "2", "converged"},
                                               {"3", "0", "100", "1", "converged"},
                                               {"4", "0", "100", "2", "converged"}};
    CHECK(std::vector(table[0].begin(), table[0].begin() + 5) ==
          std::vector<std::string>{"number", "exit_code", "mu0", "degree", "status"});
    for (int k = 0; k < 4; ++k) {
        CHECK(std::vector(table[k + 1].begin(), table[k + 1].begin() + 5) == wanted[k]);
        CHECK(table[k + 1].size() == table[0].size());
    }
    const std::string last = ring.output + "/mu0=100,degree=2/";
    const std::string by_sweep = text_of(last + "final.msh"), result = by_sweep + text_of(last + "history.csv");
    REQUIRE(ring.run({"mu0=100", "degree=2"}).code == 0);
    CHECK(text_of(ring.output + "/final.msh") == by_sweep);
    CHECK(has(text_of(last + "log.txt"), "certified valid and injective"));
}

TEST_CASE("runs that have ended are not done again; others of another deck, mesh or value are") {
    RingDeck ring;
    REQUIRE(sweep_of(ring, two_lines).code == 0);
    const std::string first = ring.output + "/mu0=10,degree=1/final.msh";
    const auto written = time_of(first);
    CHECK(has(sweep_of(ring, {"sweep mu0=10, 100, 1000", "sweep degree=1, 2"}).out, "4 of 6 runs done before"));
    CHECK(time_of(first) == written);
    CHECK(table_of(ring).size() == 7);
    CHECK(has(sweep_of(ring, two_lines, "threads=2").out, "4 of 4 runs done before"));
    CHECK(!has(sweep_of(ring, two_lines, "boundary inner=translate 1 0").out, "done before"));
    CHECK(time_of(first) != written);
    ring.folder.write("ring.msh", msh_of(ring_mesh(13, 3, 6)));
    CHECK(!has(sweep_of(ring, two_lines, "boundary inner=translate 1 0").out, "done before"));
}

TEST_CASE("a sweep whose deck names a node file notices that the file has changed") {
    const RingDeck ring;
    std::string rows;
    for (int node = 1; node <= 12; ++node) rows += std::to_string(node) + ",0.5,0\n";
    const std::string moved = "boundary inner=file " + ring.folder.write("inner.csv", rows) + " displacement";
    REQUIRE(sweep_of(ring, two_lines, moved).code == 0);
    CHECK(has(sweep_of(ring, two_lines, moved).out, "4 of 4 runs done before"));
    ring.folder.write("inner.csv", rows.replace(rows.find("0.5"), 3, "0.6"));
    CHECK(!has(sweep_of(ring, two_lines, moved).out, "done before"));
}

TEST_CASE("a run by hand in a folder of a sweep is not taken for the sweep's") {
    const RingDeck ring;
    REQUIRE(sweep_of(ring, two_lines).code == 0);
    const std::string folder = ring.output + "/mu0=10,degree=1";
    REQUIRE(ring.run({"output=" + folder, "boundary inner=translate 1 0"}).code == 0);
    CHECK(has(sweep_of(ring, two_lines).out, "3 of 4 runs done before"));
}

TEST_CASE("runs that fail are listed and counted, and the others are done") {
    const RingDeck ring;
    const Outcome outcome = sweep_of(ring, {"sweep max_newton_iterations=1, 40", "sweep mu0=10, 100"},
                                     "boundary inner=translate 4.9 0");
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "exit code 3: max_newton_iterations=1,mu0=10, "));
    CHECK(has(outcome.out, "2 of exit code 0, 2 of exit code 3"));
    CHECK(table_of(ring).size() == 5);
}

TEST_CASE("a run that is refused has a row with its reason") {
    const RingDeck ring;
    ring.folder.write("other.msh", msh_of(square_mesh(2)));
    const std::string meshes = "sweep mesh=" + ring.folder.path("ring.msh") + ", " + ring.folder.path("other.msh");
    const Outcome outcome = sweep_of(ring, {meshes});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.out, "1 of exit code 0, 1 of exit code 1"));
    const auto table = table_of(ring);
    REQUIRE(table.size() == 3);
    CHECK(table[2][1] == "1");
    CHECK(table[2][3] == "refused");
    CHECK(has(text_of(ring.output + "/sweep.csv"), "the mesh has no boundary 'inner'"));
}

TEST_CASE("settings of the command line come before a sweep, and a plain run leaves sweeps out") {
    const RingDeck ring(ring_mesh(12, 3, 6), "sweep mu0 = 10, 100\nsweep degree = 1, 2\n");
    CHECK(sweep_of(ring, {"mu0=10"}).code == 0);
    CHECK(std::filesystem::exists(ring.output + "/degree=2"));
    CHECK(!std::filesystem::exists(ring.output + "/mu0=10,degree=2"));
    const Outcome plain = ring.run();
    CHECK(plain.code == 0);
    CHECK(has(plain.out, "without the lines `sweep`"));
}

TEST_CASE("constants are swept, and products of them and keys are named by their values") {
    const RingDeck ring(ring_mesh(12, 3, 6), "let far = 1\nlet turn = \"10*far\"\nsweep far = 0.5, 2\n");
    const Outcome outcome = sweep_of(ring, {"boundary inner=rotate turn; translate far 0", "sweep degree=1, 2"});
    CHECK(outcome.code == 0);
    const Mesh near = mesh_of(ring.output + "/far=0.5,degree=1/final.msh");
    const Mesh away = mesh_of(ring.output + "/far=2,degree=1/final.msh");
    CHECK(near.x != away.x);
    CHECK(sweep_of(ring, {"let far=0.25", "sweep degree=1, 2"}).code == 0);
    CHECK(sweep_of(ring, {"let far = 0.25", "sweep far=0.5, 2", "sweep degree=1"}).code == 0);
    CHECK(std::filesystem::exists(ring.output + "/degree=2/final.msh"));
    CHECK(has(sweep_of(ring, {"sweep near=1, 2"}).error, "sweep near: there is no such key, nor a line `let near"));
}

TEST_CASE("what is wrong with a sweep is said before anything runs") {
    const RingDeck ring;
    const auto refusal = [&](const std::vector<std::string>& settings) {
        const Outcome outcome = sweep_of(ring, settings);
        CHECK(outcome.code == 1);
        CHECK(!std::filesystem::exists(ring.output));
        return outcome.error;
    };
    CHECK(has(refusal({}), "no line `sweep KEY = VALUES`"));
    CHECK(has(refusal({"sweep nu0=1,2"}), "no such key, nor a line `let nu0 = ...`: did you mean `mu0`?"));
    CHECK(has(refusal({"sweep degree=1,9"}), "degree = 9: expected integer in 0..7"));
    CHECK(has(refusal({"sweep degree=1,,2"}), "a value is missing"));
    CHECK(has(refusal({"sweep degree=1,2,1"}), "`1` is there twice"));
    CHECK(has(refusal({"sweep degree"}), "expected `sweep KEY = VALUE, VALUE, ...`"));
    CHECK(has(refusal({"sweep boundary inner=translate 1 0, translate 2 0"}), "sweep boundary inner: a sweep is over"));
    CHECK(has(refusal({"sweep volume inner=fixed, translate 2 0"}), "`let a = 30`, `boundary NAME = rotate a`"));
    CHECK(has(refusal({"sweep output=a, b"}), "sweep output: every run of a sweep has a folder of its own"));
    CHECK(has(refusal({"sweep degree=3:1:1"}), "sweep degree = 3:1:1 are -1 numbers"));
    CHECK(has(refusal({"sweep mu0=1:0.001:400", "sweep omega_star=1:0.001:400"}), "more than 100000 runs"));
    CHECK(has(refusal({"sweep degree=1,2", "sweep degree=1,2"}), "sweep degree is already set"));
    CHECK(has(refusal({"sweep degree=1,2", "--slrum"}), "did you mean `--slurm`?"));
    CHECK(has(refusal({"sweep degree=1,2", "--run", "0/2"}), "expected K/N"));
    CHECK(has(refusal({"sweep degree=1,2", "--slurm", "--collect"}), "one at a time"));
    CHECK(has(refusal({"sweep degree=1,2", "frames=-"}), "frames = - has no end that a sweep can wait for"));
    CHECK(has(almesh_with({"sweep"}).error, "sweep takes a deck"));
}

TEST_CASE("one sweep at a time writes to a folder") {
    const RingDeck ring;
    int code = -1;
    std::string error;
    const int ended = in_child(
        [&] { return sweep_of(ring, two_lines, "refine=4").code; },  // seconds
        [&](pid_t child) {
            for (int k = 0; k < 1000 && !std::filesystem::exists(ring.output + "/mu0=10,degree=1/deck.txt"); ++k)
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            const Outcome second = sweep_of(ring, two_lines);
            code = second.code;
            error = second.error;
            kill(child, SIGTERM);
        });
    CHECK(code == 2);
    CHECK(has(error, "another run writes to"));
    CHECK(ended == 3);
}

TEST_CASE("a sweep killed at any place is resumed with no run lost or done twice") {
    const RingDeck ring, undisturbed;
    REQUIRE(sweep_of(undisturbed, two_lines).code == 0);
    std::mt19937 random(5);
    std::map<std::string, std::filesystem::file_time_type> ended;
    for (int k = 0; k < 10; ++k) {
        in_child([&] { return sweep_of(ring, two_lines).code; },
                 [&](pid_t child) {
                     std::this_thread::sleep_for(std::chrono::milliseconds(random() % 40));
                     kill(child, SIGKILL);
                 });
        while (sweep_of(ring, two_lines, "--collect").code != 0 && sweep_of(ring, two_lines).code == 2)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));  // until the runs of the killed one have ended
        for (const auto& [name, time] : ended) CHECK(time_of(name) == time);
        for (const auto& folder : std::filesystem::directory_iterator(ring.output))
            if (const std::string row = folder.path().string() + "/sweep.row"; std::filesystem::exists(row))
                ended.emplace(row, time_of(row));
    }
    CHECK(sweep_of(ring, two_lines).code == 0);
    const auto table = table_of(ring), wanted = table_of(undisturbed);
    REQUIRE(table.size() == wanted.size());
    for (std::size_t k = 1; k < table.size(); ++k)
        CHECK(text_of(ring.output + "/mu0=" + table[k][2] + ",degree=" + table[k][3] + "/history.csv").size() > 100);
}

namespace {

// Of a living process, on Linux: its parent, else 0.
pid_t parent_of(const std::string& process) {
    std::ifstream file("/proc/" + process + "/stat");
    std::string number, name, state;
    pid_t parent = 0;
    return file >> number >> name >> state >> parent && state != "Z" ? parent : 0;
}

std::vector<std::string> children_of(pid_t parent) {
    std::vector<std::string> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error))
        if (const std::string name = entry.path().filename(); parent_of(name) == parent) found.push_back(name);
    return found;
}

}  // namespace

TEST_CASE("a sweep that is killed leaves no process behind") {
    if (!std::filesystem::exists("/proc/self/stat")) return;
    const RingDeck ring;
    for (const int signal : {SIGTERM, SIGKILL}) {
        std::vector<std::string> runs;
        in_child([&] { return sweep_of(ring, {"sweep mu0=10, 100", "refine=5"}).code; },  // minutes
                 [&](pid_t child) {
                     for (int k = 0; k < 1000 && runs.empty(); ++k) {
                         std::this_thread::sleep_for(std::chrono::milliseconds(5));
                         runs = children_of(child);
                     }
                     kill(child, signal);
                 });
        CHECK(!runs.empty());
        const auto is_alive = [](const std::string& run) { return parent_of(run) > 0; };
        for (int k = 0; k < 200 && std::any_of(runs.begin(), runs.end(), is_alive); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        CHECK(std::none_of(runs.begin(), runs.end(), is_alive));
    }
}

TEST_CASE("a job array runs what is missing, and its rows are collected") {
    const RingDeck ring;
    const Outcome script = sweep_of(ring, two_lines, "--slurm");
    CHECK(script.code == 0);
    CHECK(has(script.out, "sbatch " + ring.output + "/sweep.sh"));
    const std::string text = text_of(ring.output + "/sweep.sh");
    CHECK(has(text, "#SBATCH --array=1-4\n"));
    CHECK(has(text, "'sweep mu0=10, 100' 'sweep degree=1:1:2' --run \"$SLURM_ARRAY_TASK_ID/4\""));
    std::vector<std::string> task = two_lines;
    task.insert(task.end(), {"--run", "2/3"});
    CHECK(sweep_of(ring, task).code == 0);
    const Outcome incomplete = sweep_of(ring, two_lines, "--collect");
    CHECK(incomplete.code == 3);
    CHECK(has(incomplete.out, "no result: mu0=10,degree=1\n"));
    CHECK(has(incomplete.out, "1 of exit code 0, 3 without result"));
    task.back() = "1/1";
    const Outcome rest = sweep_of(ring, task);
    CHECK(has(rest.out, "1 of 4 runs done before"));
    CHECK(sweep_of(ring, two_lines, "--collect").code == 0);
    CHECK(table_of(ring).size() == 5);
}
