// Motions in time: a mesh per frame.
#include "app/commands.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <random>
#include <thread>

#include "deck/deck.hpp"
#include "deck/frame_times.hpp"
#include "base/stopwatch.hpp"
#include "support/child.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Table = std::vector<std::map<std::string, std::string>>;

// frames.csv; the column of notes, which may have commas, is left out.
Table frames_of(const std::string& folder) {
    const auto rows = csv_rows(text_of(folder + "/frames.csv"));
    Table table;
    for (std::size_t k = 1; k < rows.size(); ++k)
        for (std::size_t c = 0; c + 1 < rows[0].size(); ++c) {
            if (c == 0) table.emplace_back();
            table.back()[rows[0][c]] = rows[k][c];
        }
    return table;
}

const std::map<std::string, std::string>& row_of(const Table& table, const std::string& frame) {
    const auto is_it = [&](const auto& row) { return row.at("frame") == frame; };
    const auto found = std::find_if(table.begin(), table.end(), is_it);
    REQUIRE(found != table.end());
    return *found;
}

std::string name_of(int frame) { return "frame-" + std::string(frame < 10 ? "000" : "00") + std::to_string(frame); }

Mesh frame(const RingDeck& ring, int number) { return mesh_of(ring.output + "/" + name_of(number) + ".msh"); }

// The largest distance of a node in two meshes of simplices, in parts of the shortest edge at it.
double drift(const Mesh& a, const Mesh& b) {
    const int n = a.dim;
    const auto distance = [n](const Mesh& p, int i, const Mesh& q, int j) {
        double squared = 0;
        for (int c = 0; c < n; ++c) squared += std::pow(p.x[n * i + c] - q.x[n * j + c], 2);
        return std::sqrt(squared);
    };
    std::vector<double> edge(a.nodes(), 1e300);
    for (int e = 0; e < a.element_count(); ++e)
        for (int k = 0; k <= n; ++k)
            for (int l = 0; l <= n; ++l)
                if (const int i = a.element(e)[k], j = a.element(e)[l]; i != j)
                    edge[i] = std::min(edge[i], distance(a, i, a, j));
    double largest = 0;
    for (int i = 0; i < a.nodes(); ++i) largest = std::max(largest, distance(a, i, b, i) / edge[i]);
    return largest;
}

const std::string pitch_and_plunge =
    "boundary inner=rotate \"25*sin(2*pi*t)\" about 0.5 0; translate 0 \"2.5*sin(2*pi*t + 1)\"";

std::vector<double> times(const std::string& frames) {
    return frame_times(parse_deck("mesh = m.msh\nframes = " + frames + "\n", "a.deck"));
}

std::string refusal(const std::string& frames) {
    try {
        times(frames);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a motion of several periods does not drift, and its frames are the runs of their times") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    constexpr int period = 8, periods = 5;
    REQUIRE(ring.run({pitch_and_plunge, "frames=0 : 0.125 : 5", "vtk=none"}).code == 0);
    const Table table = frames_of(ring.output);
    REQUIRE(table.size() == period * periods + 1);
    for (int k = period + 1; k <= period * periods; ++k) {
        const int first = k % period + period;  // of the first period that starts from a mesh before
        CHECK(drift(frame(ring, first + 1), frame(ring, k + 1)) < 1e-8);
        for (const char* quantity : {"max_distortion", "relative_quality", "certified_bound"})
            CHECK(*parse_double(table[k].at(quantity)) ==
                  doctest::Approx(*parse_double(table[first].at(quantity))).epsilon(1e-9));
        CHECK(table[k].at("certified") == "yes");
    }
    const auto steps = [&](int number) {
        int sum = 0;
        for (int k = 1; k <= period; ++k) sum += *parse_int(table[number * period + k].at("newton_steps"));
        return sum;
    };
    for (int number = 1; number < periods; ++number) CHECK(steps(number) <= steps(0));
    const std::string alone = ring.folder.path("alone");
    REQUIRE(ring.run({pitch_and_plunge, "frames=3.375", "output=" + alone}).code == 0);
    CHECK(drift(frame(ring, 28), mesh_of(alone + "/frame-0001.msh")) < 1e-8);
    const double pi = std::acos(-1.0), angle = 25 * std::sin(2 * pi * 3.375), y = 2.5 * std::sin(2 * pi * 3.375 + 1);
    REQUIRE(ring.run({concat("boundary inner=rotate ", angle, " about 0.5 0; translate 0 ", y)}).code == 0);
    CHECK(drift(mesh_of(ring.output + "/final.msh"), mesh_of(alone + "/frame-0001.msh")) < 1e-4);
}

TEST_CASE("a boundary that turns all the way round has the mesh with it, and is where it was after each turn") {
    const RingDeck ring;
    REQUIRE(ring.run({"boundary inner=rotate \"360*t\"", "frames=0 : 0.1 : 3"}).code == 0);
    for (int k = 1; k <= 21; ++k) CHECK(drift(frame(ring, k), frame(ring, k + 10)) < 1e-8);
    const Table table = frames_of(ring.output);
    CHECK(row_of(table, "11").at("max_distortion") == row_of(table, "1").at("max_distortion"));
    // From 180 to 216 degrees the other way round is the shorter one, and nothing lies between.
    for (const auto& row : table) {
        CAPTURE(row.at("frame"));
        const bool jumps = row.at("frame").ends_with("7");
        CHECK((row.at("path") == "not valid") == jumps);
    }
}

TEST_CASE("curved and sliding boundaries, and volumes in space, do not drift either") {
    const auto check_output = [](const std::string& folder, int first) {
        for (int k = first; k <= 4; ++k) {
            const Mesh a = mesh_of(folder + "/" + name_of(k) + ".msh");
            const Mesh b = mesh_of(folder + "/" + name_of(k + 4) + ".msh");
            for (std::size_t i = 0; i < a.x.size(); ++i) CHECK(std::abs(a.x[i] - b.x[i]) < 1e-9);
            CHECK(frames_of(folder)[k + 3].at("certified") == "yes");
        }
    };
    const auto check = [&](const RingDeck& ring, const std::vector<std::string>& settings, int first) {
        REQUIRE(ring.run(settings).code == 0);
        check_output(ring.output, first);
    };
    const std::string round = "boundary inner=translate \"sin(2*pi*t)\" 0; circle \"sin(2*pi*t)\" 0 1";
    check(RingDeck(), {"degree=3", round, "frames=0.1 : 0.25 : 1.9"}, 1);
    check(RingDeck(), {"boundary outer=slide", pitch_and_plunge, "frames=0.1 : 0.25 : 1.9"}, 2);
    const TemporaryFolder folder;
    folder.write("cube.msh", msh_of(cube_mesh(3)));
    const std::string deck = folder.write(
        "cube.deck", "mesh = cube.msh\noutput = " + folder.path("out") +
                         "\nboundary top = rotate \"20*sin(2*pi*t)\" axis 0 0 1 about 0.5 0.5 0; "
                         "translate 0 0 \"0.1*t\"\nboundary bottom = fixed\n"
                         "boundary sides = twist \"20*sin(2*pi*t)\" axis 0 0 1 about 0.5 0.5 0; "
                         "scale 1 1 \"1 + 0.1*t\"\nframes = 0.1, 0.4, 0.6, 0.9\n");
    REQUIRE(almesh_with({deck}).code == 0);
    const Table upward = frames_of(folder.path("out"));
    REQUIRE(almesh_with({deck, "frames=0.1, 0.6, 0.9"}).code == 0);  // by another way
    const Table table = frames_of(folder.path("out"));
    for (const char* quantity : {"max_distortion", "relative_quality"})
        for (const int k : {1, 2})
            CHECK(*parse_double(table[k].at(quantity)) ==
                  doctest::Approx(*parse_double(upward[k + 1].at(quantity))).epsilon(1e-10));
}

TEST_CASE("the way from frame to frame is valid everywhere, through frames at times between where it has to be") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    const std::string turns = "boundary inner=rotate \"85*t\"; rotate \"100*t\"; translate \"100*max(0, t - 2)\" 0";
    for (const char* const resume : {"resume=0", "resume=1"}) {
        CHECK(ring.run({turns, "frames=0, 0.5, 1.5, 4", resume}).code == 2);  // the last one folds
        const Table table = frames_of(ring.output);
        REQUIRE(table.size() == 6);
        CHECK(row_of(table, "2").at("path") == "valid");
        CHECK(row_of(table, "3-1").at("t") == "1");
        CHECK(row_of(table, "3-1").at("path") == "valid");
        CHECK(row_of(table, "3-2").at("t") == "1.25");
        CHECK(row_of(table, "3-2").at("path") == "valid");
        CHECK(row_of(table, "3").at("path") == "split 2");
        CHECK(has(text_of(ring.output + "/frames.vtk.series"),
                  "0.5},\n    {\"name\": \"frame-0003-1.vtk\", \"time\": 1},\n"
                  "    {\"name\": \"frame-0003-2.vtk\", \"time\": 1.25},\n    {\"name\": \"frame-0003.vtk"));
    }
    const Mesh before = frame(ring, 2), after = frame(ring, 3);
    const Mesh first = mesh_of(ring.output + "/frame-0003-1.msh"), second = mesh_of(ring.output + "/frame-0003-2.msh");
    const auto least_area = [&](const Mesh& from, const Mesh& to) {
        double least = 1e300;
        for (int s = 0; s <= 1000; ++s) {
            const auto at = [&](int i, int a) {
                return from.x[2 * i + a] + 0.001 * s * (to.x[2 * i + a] - from.x[2 * i + a]);
            };
            for (int e = 0; e < from.element_count(); ++e) {
                const int *const v = from.element(e), i = v[0], j = v[1], k = v[2];
                least = std::min(least, (at(j, 0) - at(i, 0)) * (at(k, 1) - at(i, 1)) -
                                            (at(j, 1) - at(i, 1)) * (at(k, 0) - at(i, 0)));
            }
        }
        return least;
    };
    CHECK(least_area(before, first) > 0);
    CHECK(least_area(first, second) > 0);
    CHECK(least_area(second, after) > 0);
    CHECK(least_area(before, after) < 0);
}

TEST_CASE("where a disk is full the frames before stay, and the run goes on when there is room again") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    const std::vector<std::string> settings = {pitch_and_plunge, "frames=0:0.05:1"};
    REQUIRE(ring.run(settings).code == 0);
    const auto bits = [&] {
        std::vector<std::string> all = {text_of(ring.output + "/frames.vtk.series")};
        for (int k = 1; k <= 21; ++k) all.push_back(text_of(ring.output + "/" + name_of(k) + ".msh"));
        for (const auto& row : frames_of(ring.output)) all.push_back(row.at("frame") + row.at("max_distortion"));
        return all;
    };
    const auto whole = bits();
    const auto size_of = [&](const char* name) { return text_of(ring.output + "/" + name).size(); };
    for (const std::size_t room : {size_of("frames.csv") / 2, size_of("frames.vtk.series") / 2}) {
        const auto run = [&](std::size_t limit_of_files) {
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit limit = {limit_of_files, limit_of_files};
            setrlimit(RLIMIT_FSIZE, &limit);
            return ring.run({pitch_and_plunge, "frames=0:0.05:1", "resume=1"}).code;
        };
        std::filesystem::remove_all(ring.output);
        CHECK(in_child([&] { return run(room); }, [](pid_t) {}) == 2);
        CHECK(ring.run({pitch_and_plunge, "frames=0:0.05:1", "resume=1"}).code == 0);
        CHECK(bits() == whole);
    }
}

TEST_CASE("a body in space that pitches and plunges does not drift either, and its frames do not become dearer") {
    const TemporaryFolder folder;
    const std::string out = folder.path("out");
    folder.write("shell.msh", text_of("inputs/meshes/sphere-shell.msh"));
    const std::string deck = folder.write(
        "shell.deck", "mesh = shell.msh\nvtk = none\noutput = " + out +
                          "\nboundary inner = rotate \"20*sin(2*pi*t)\" axis 0 1 0 about 0.3 0 0; "
                          "translate 0 0 \"0.6*sin(2*pi*t + 1)\"\nboundary outer = fixed\nframes = 0 : 0.125 : 4\n");
    const auto mesh = [&](int number) { return mesh_of(out + "/" + name_of(number) + ".msh"); };
    for (const char* const solver : {"cholesky", "cg"}) {
        REQUIRE(almesh_with({deck, concat("solver=", solver)}).code == 0);
        const Table table = frames_of(out);
        REQUIRE(table.size() == 33);
        int steps[4] = {};
        for (int k = 9; k < 33; ++k) {
            CHECK(drift(mesh(k % 8 + 9), mesh(k + 1)) < 1e-8);
            CHECK(table[k].at("path") == "valid");
            CHECK(table[k].at("started_from") != "anew");
            for (const char* quantity : {"max_distortion", "relative_quality"})
                CHECK(*parse_double(table[k].at(quantity)) ==
                      doctest::Approx(*parse_double(table[k % 8 + 8].at(quantity))).epsilon(1e-9));
            steps[(k - 1) / 8] += *parse_int(table[k].at("newton_steps"));
        }
        CHECK(steps[2] <= steps[1]);
        CHECK(steps[3] <= steps[1]);
    }
}

TEST_CASE("times: a range, a list, a file") {
    CHECK(times("0 : 0.01 : 0.35").size() == 36);
    CHECK(times("0 : 0.01 : 0.35").back() == 0.35);
    CHECK(times("-1:2:4") == std::vector<double>{-1, 1, 3});
    CHECK(times("0, 0.1, 0.5") == std::vector<double>{0, 0.1, 0.5});
    CHECK(times("7") == std::vector<double>{7});
    const TemporaryFolder folder;
    CHECK(times(folder.write("times.txt", "# t\n0\n0.5, 1\n\n2 3 # last\n")) == std::vector<double>{0, 0.5, 1, 2, 3});
    CHECK(has(refusal("0, 0.2, 0.1"), "a.deck:2: frames: the times run backwards, 0.1 is after 0.2"));
    CHECK(has(refusal("0, 0"), "the times run backwards"));
    CHECK(has(refusal("0, nan"), "`nan` is not a number"));
    CHECK(has(refusal("0 : inf : 1"), "`inf` is not a number"));
    CHECK(has(refusal("0 : -0.1 : 1"), "the step must be > 0"));
    CHECK(has(refusal("1 : 0.1 : 0"), "are -9 numbers"));
    CHECK(has(refusal("0 : 1e-9 : 1"), "expected 1 to 1000000"));
    CHECK(has(refusal("0 : 1"), "expected FROM : STEP : TO"));
    CHECK(has(refusal(folder.path("none.txt")), "a.deck:2: frames: cannot read"));
    CHECK(has(refusal(folder.write("times.txt", "0\n1\n0.5\n")), "times.txt:3: frames: the times run backwards"));
    CHECK(has(refusal(folder.write("times.txt", "# none\n")), "a.deck:2: frames: no times in "));
    CHECK(has(refusal(", ,"), "no times in , ,"));
}

TEST_CASE("a number of a step from a table of times and values") {
    const RingDeck ring;
    const std::string frames = "frames=0, 0.5, 1, 1.5";
    ring.folder.write("shift.csv", "time,shift  # of the wall\n0,0\n\n1, 2\n2 1\n");
    const std::string again = ring.folder.path("again");
    std::string text = text_of(ring.deck);
    text.replace(text.find("translate 2 0"), 13, "translate \"table(shift.csv)/4\" 0; rotate \"-t\"");
    ring.folder.write("ring.deck", text);
    REQUIRE(ring.run({frames}).code == 0);
    const auto meshes = [](const std::string& folder) {
        std::vector<std::vector<double>> all;
        for (int k = 1; k <= 4; ++k) all.push_back(mesh_of(folder + "/" + name_of(k) + ".msh").x);
        return all;
    };
    const auto of_the_table = meshes(ring.output);
    REQUIRE(almesh_with({ring.output + "/deck.txt", "output=" + again}).code == 0);  // finds the table as well
    CHECK(meshes(again) == of_the_table);
    REQUIRE(ring.run({frames, "boundary inner=translate \"min(2*t, 3 - t)/4\" 0; rotate \"-t\""}).code == 0);
    CHECK(meshes(ring.output) == of_the_table);
    const auto refusal_of = [&](const std::string& table, const std::string& times) {
        ring.folder.write("shift.csv", table);
        const Outcome outcome = ring.run({"frames=" + times});
        CHECK(outcome.code == 1);
        return outcome.error;
    };
    const std::string path = ring.folder.path("shift.csv");
    CHECK(has(refusal_of("0 0\n2 1\n", "1, 3"),
              "frame 2, t = 3: t = 3 is outside of the table " + path + ", from 0 to 2"));
    CHECK(has(refusal_of("0 0\n2 1\n1 1\n", "0"), path + ":3: the times run backwards, 1 is after 2"));
    CHECK(has(refusal_of("0 0\n1 nan\n", "0"), path + ":2: expected a row `t value` of two finite numbers"));
    CHECK(has(refusal_of("0 0 0\n", "0"), path + ":1: expected a row"));
    CHECK(has(refusal_of("t value\n", "0"), path + ": no rows"));
    ring.folder.write("shift.csv", "0 0\n2 1\n");
    CHECK(has(ring.run({frames, "boundary inner=expression \"x + table(none.csv\" \"y\""}).error, "expected `)`"));
    std::filesystem::remove(path);
    CHECK(has(ring.run({frames}).error, "cannot read " + path));
}

TEST_CASE("what is written: meshes in the formats of the deck, a series, a table") {
    const RingDeck ring;
    const std::string move = "boundary inner=expression \"x + t\" \"y - t*x/10\"";
    REQUIRE(ring.run({move, "frames=0, 0.5, 1", "final=both", "degree=2", "refine=1"}).code == 0);
    for (const char* name : {"frame-0003.msh", "frame-0003.su2", "frame-0003.vtk", "deck.txt", "summary.txt"})
        CHECK(std::filesystem::exists(ring.output + "/" + name));
    CHECK(!std::filesystem::exists(ring.output + "/frames.state"));
    CHECK(!std::filesystem::exists(ring.output + "/final.msh"));
    CHECK(text_of(ring.output + "/frames.vtk.series") ==
          "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n"
          "    {\"name\": \"frame-0001.vtk\", \"time\": 0},\n    {\"name\": \"frame-0002.vtk\", \"time\": 0.5},\n"
          "    {\"name\": \"frame-0003.vtk\", \"time\": 1}\n  ]\n}\n");
    const Table table = frames_of(ring.output);
    REQUIRE(table.size() == 3);
    CHECK(table[2].at("t") == "1");
    CHECK(table[1].at("started_from") == "ideal");
    CHECK(table[2].at("started_from") == "beyond");
    const Mesh first = frame(ring, 1), last = frame(ring, 3);
    for (int f = 0; f < first.face_count(); ++f) {
        if (first.boundaries[first.face_boundary[f]] != "inner") continue;
        const int i = first.face(f)[0];
        CHECK(last.x[2 * i] == doctest::Approx(first.x[2 * i] + 1).epsilon(1e-14));
        CHECK(last.x[2 * i + 1] == doctest::Approx(first.x[2 * i + 1] - first.x[2 * i] / 10).epsilon(1e-14));
    }
    CHECK(has(text_of(ring.output + "/deck.txt"), "\nframes = 0, 0.5, 1\n"));
    CHECK(has(text_of(ring.output + "/deck.txt"), "inner = expression \"x + t\" \"y - t*x/10\"\n"));

    REQUIRE(ring.run({move, "frames=0, 0.5"}).code == 0);  // what is left of the run before is not of this one
    CHECK(!std::filesystem::exists(ring.output + "/frame-0003.msh"));
}

TEST_CASE("nodes slide along a boundary in every frame") {
    const RingDeck ring;
    REQUIRE(ring.run({"boundary inner=translate \"t\" 0", "boundary outer=slide", "frames=0:0.5:2"}).code == 0);
    const Mesh mesh = frame(ring, 5);
    double slid = 0;
    const Mesh before = frame(ring, 1);
    for (int i = 0; i < mesh.nodes(); ++i)
        if (std::hypot(before.x[2 * i], before.x[2 * i + 1]) > 5.99)
            slid = std::max(slid, std::hypot(mesh.x[2 * i] - before.x[2 * i], mesh.x[2 * i + 1] - before.x[2 * i + 1]));
    CHECK(slid > 1e-3);
}

TEST_CASE("a node file per frame; one that is missing or has other rows is refused with its frame") {
    const RingDeck ring;
    const Mesh mesh = ring_mesh(12, 3, 6);
    const auto rows = [&](double shift, int nodes) {
        std::string text;
        for (int i = 0; i < nodes; ++i) text += concat(mesh.file.node_id[i], ",", shift, ",0\n");
        return text;
    };
    const std::string motion = "boundary inner=file " + ring.folder.path("wing-%02d.csv") + " displacement";
    for (int k = 1; k <= 3; ++k) ring.folder.write("wing-0" + std::to_string(k) + ".csv", rows(0.2 * k, 12));
    REQUIRE(ring.run({motion, "frames=0:1:2"}).code == 0);
    CHECK(frame(ring, 3).x[0] == mesh.x[0] + 0.2 * 3);

    Outcome outcome = ring.run({motion, "frames=0:1:3"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "boundary inner, frame 4, t = 3: no such file: "));
    CHECK(std::filesystem::exists(ring.output + "/frame-0003.msh"));  // nothing has been touched

    ring.folder.write("wing-02.csv", rows(0.4, 11));
    outcome = ring.run({motion, "frames=0:1:2"});
    CHECK(outcome.code == 2);
    const std::string in_second = "frame 2, t = 1: " + ring.folder.path("wing-02.csv") + ":";
    CHECK(has(outcome.error, in_second + " 1 node of boundary inner missing"));
    ring.folder.write("wing-02.csv", "1 nan 0\n");
    CHECK(has(ring.run({motion, "frames=0:1:2"}).error, in_second + "1: "));
    CHECK(std::filesystem::exists(ring.output + "/frame-0001.msh"));

    ring.folder.write("wing-02.csv", rows(0.4, 12));  // mended: the run goes on where it ended
    outcome = ring.run({motion, "frames=0:1:2", "resume=1"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "resumes after frame 1, t = 0"));
    CHECK(frames_of(ring.output).size() == 3);
}

TEST_CASE("a frame that fails ends the run with its code; keep_going goes on with the next") {
    const RingDeck ring;
    const std::string hits = "boundary inner=translate \"8*sin(pi*t/2)\" 0";
    Outcome outcome = ring.run({hits, "frames=0, 0.3, 1, 1.8"});
    CHECK(outcome.code == 2);
    CHECK(has(outcome.error, "frame 3, t = 1: the target makes the boundary itself invalid"));
    CHECK(std::filesystem::exists(ring.output + "/frame-0002.msh"));
    CHECK(!std::filesystem::exists(ring.output + "/frame-0003.msh"));
    REQUIRE(frames_of(ring.output).size() == 3);
    outcome = ring.run({hits, "frames=0, 0.6"});
    CHECK(has(outcome.error, "frame 2, t = 0.6: the target makes the boundary itself invalid"));
    CHECK(has(outcome.error, "in the target it crosses face "));
    REQUIRE(ring.run({hits, "frames=0, 0.3, 1, 1.8"}).code == 2);
    CHECK(frames_of(ring.output)[2].at("status") == "refused");
    CHECK(has(text_of(ring.output + "/frames.csv"), ",\"the target makes the boundary itself invalid"));

    outcome = ring.run({hits, "frames=0, 0.3, 1, 1.8", "keep_going=yes"});
    CHECK(outcome.code == 2);
    CHECK(std::filesystem::exists(ring.output + "/frame-0004.msh"));
    CHECK(has(text_of(ring.output + "/frames.vtk.series"),
              "frame-0002.vtk\", \"time\": 0.3},\n    {\"name\": \"frame-0004"));

    outcome = ring.run({pitch_and_plunge, "frames=0.1, 0.2, 0.3", "max_newton_iterations=1"});
    CHECK(outcome.code == 3);
    CHECK(frames_of(ring.output).size() == 1);
    CHECK(has(outcome.error, "frame 1, t = 0.1: max_newton_iterations\nthe frames before it are there; keep_going"));
    outcome = ring.run({pitch_and_plunge, "frames=0.1, 0.2, 0.3", "expect max_distortion <= 1.0001"});
    CHECK(outcome.code == 5);
    CHECK(frames_of(ring.output).size() == 3);
}

TEST_CASE("a node of two boundaries that part in a frame is refused with both names, the distance and t") {
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(4)));
    const std::string deck = folder.write(
        "square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                           "\nboundary left = translate \"-t*t\" 0\nboundary rest = translate \"-t\" 0\n"
                           "frames = 0, 1, 1.5\n");
    const Outcome outcome = almesh_with({deck});
    CHECK(outcome.code == 2);
    for (const char* part : {"frame 3, t = 1.5: node 1 lies on two boundaries whose motions disagree", "bottom takes",
                             "left to (-2.25, 0), 0.75 apart"})
        CHECK_MESSAGE(has(outcome.error, part), outcome.error);
    CHECK(frames_of(folder.path("out")).size() == 3);
    for (const auto& [rule, x] : {std::pair("first", -0.09), std::pair("mean", -0.195)}) {
        CHECK(almesh_with({deck, concat("shared_nodes=", rule), "frames=0.3"}).code == 0);
        CHECK(mesh_of(folder.path("out/frame-0001.msh")).x[0] == doctest::Approx(x).epsilon(1e-14));
    }
}

TEST_CASE("who reads the progress may go away") {
    const RingDeck ring;
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    close(ends[0]);
    std::FILE* const out = fdopen(ends[1], "w");
    setvbuf(out, nullptr, _IONBF, 0);
    CHECK(command_line({ring.deck, pitch_and_plunge, "frames=0, 0.1, 0.2"}, out, stderr) == 0);
    std::fclose(out);
    CHECK(frames_of(ring.output).size() == 3);
}

TEST_CASE("numbers that make no sense at some time, and keys that do not go with frames, are refused at once") {
    const RingDeck ring;
    const auto error_of = [&](const std::vector<std::string>& settings) {
        const Outcome outcome = ring.run(settings);
        CHECK(outcome.code == 1);
        CHECK(!std::filesystem::exists(ring.output));
        return outcome.error;
    };
    CHECK(has(error_of({"boundary inner=translate \"t\" 0"}), "boundary inner moves with the time t: give the times"));
    CHECK(has(error_of({"boundary inner=expression \"x+t\" \"y\""}), "moves with the time t"));
    CHECK(has(error_of({"boundary inner=translate \"1/(t-1)\" 0", "frames=0,1"}),
              "command line: boundary inner, frame 2, t = 1: `translate`: \"1/(t-1)\" is not finite"));
    CHECK(has(error_of({"boundary inner=scale \"1-t\"", "frames=0,1"}), "frame 2, t = 1: `scale`: every factor must"));
    CHECK(has(error_of({"boundary inner=translate \"x\" 0", "frames=0,1"}), "may name t and constants alone"));
    for (const char* other : {"split=auto", "surface=straighten", "iterates=1"})
        CHECK(has(error_of({other, "frames=0,1"}), "does not go with frames"));
    CHECK(has(error_of({"local_repair=1", "boundary inner=fixed", "frames=0,1"}), "frames does not go with local"));
}

namespace {

void check_killed(int times) {
    const RingDeck ring(ring_mesh(24, 6, 6));
    const std::vector<std::string> settings = {pitch_and_plunge, "frames=0:0.125:2", "vtk=none", "degree=2"};
    const auto bits = [&] {
        std::vector<std::string> all;
        for (int k = 1; k <= 17; ++k) all.push_back(text_of(ring.output + "/" + name_of(k) + ".msh"));
        for (const auto& row : frames_of(ring.output))
            all.push_back(concat(row.at("t"), row.at("status"), row.at("newton_steps"), row.at("max_distortion")));
        for (const auto& row : history_without_times(ring.output))
            for (const std::string& cell : row) all.back() += "," + cell;
        return all;
    };
    const Stopwatch watch;
    REQUIRE(ring.run(settings).code == 0);
    std::uniform_real_distribution<double> moment(0, watch.seconds());
    const auto whole = bits();
    CHECK(whole.size() == 34);
    std::mt19937 random(20261126);
    std::vector<std::string> resumed = settings;
    resumed.push_back("resume=1");
    for (int kills = 0; kills < times;) {
        REQUIRE(ring.run({"frames=0"}).code == 0);  // something else in the folder
        int code = -SIGKILL;
        for (bool first = true; code == -SIGKILL; first = false) {
            code = in_child([&] { return ring.run(first ? settings : resumed).code; }, [&](pid_t child) {
                if (kills >= times) return;
                std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
                kill(child, SIGKILL);
            });
            kills += code == -SIGKILL;
        }
        CHECK(code == 0);
        CHECK(bits() == whole);
    }
}

}  // namespace

TEST_CASE("a run of frames killed at some random moments and resumed ends with the same bits") { check_killed(10); }

TEST_CASE("a run of frames killed at fifty random moments and resumed ends with the same bits" * doctest::test_suite("long")) {
    check_killed(50);
}

TEST_CASE("history.csv has the iterations of all frames that are solved anew, also after a resume") {
    const RingDeck ring;
    const std::vector<std::string> settings = {pitch_and_plunge, "frames=0.1:0.1:0.4", "objective=minimax"};
    const auto frames = [&] {  // in the order of their rows
        std::string all;
        const auto rows = history_without_times(ring.output);
        for (std::size_t k = 1; k < rows.size(); ++k)
            if (all.empty() || all.back() != rows[k][0][0]) all += rows[k][0];
        return all;
    };
    REQUIRE(ring.run(settings).code == 0);
    CHECK(frames() == "1234");
    CHECK(ring.run({settings[0], settings[1], "max_al_iterations=1"}).code == 3);  // the first frame ends the run
    CHECK(frames() == "1");
    std::vector<std::string> parts = settings, rest = settings;
    parts[0] = "boundary inner=file " + ring.folder.path("wall-%d.csv") + " displacement";
    rest = {parts[0], settings[1], settings[2], "resume=1"};
    const auto wall = [&](int k, int nodes) {
        std::string text;
        for (int node = 1; node <= nodes; ++node) text += concat(node, ",", 0.2 * k, ",0\n");
        ring.folder.write(concat("wall-", k, ".csv"), text);
    };
    for (int k = 1; k <= 4; ++k) wall(k, 12);
    REQUIRE(ring.run(parts).code == 0);
    const auto of_files = history_without_times(ring.output);
    wall(3, 11);  // the run ends there
    REQUIRE(ring.run(parts).code == 2);
    CHECK(frames() == "12");
    wall(3, 12);
    REQUIRE(ring.run(rest).code == 0);
    CHECK(history_without_times(ring.output) == of_files);
    CHECK(frames() == "1234");
}

TEST_CASE("a run of frames that is out of time says how to go on; another run's state is refused") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    Outcome outcome = ring.run({pitch_and_plunge, "frames=0:0.0001:1", "vtk=none", "max_seconds=0.3"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, "try resume=1, which goes on from here"));
    const Outcome at_once = almesh_with({ring.deck, pitch_and_plunge, "frames=0:1:4", "max_seconds=1e-9",
                                         "output=" + ring.folder.path("other")});
    CHECK(at_once.code == 3);
    CHECK(has(at_once.out, "interrupted in frame 1, t = 0\n"));  // nothing has been saved
    const std::size_t done = frames_of(ring.output).size();
    CHECK(done > 0);
    outcome = ring.run({pitch_and_plunge, "frames=0:0.0002:1", "vtk=none", "resume=1"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "is of another run or program"));
    outcome = ring.run({pitch_and_plunge, "frames=0:0.0001:1", "vtk=none", "max_seconds=0.3", "resume=1"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.out, concat("resumes after frame ", done)));
    CHECK(frames_of(ring.output).size() > done);
}
