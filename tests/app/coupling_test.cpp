// A solver beside the program, which asks for one mesh after the other by lines.
#include "app/frames/coupling.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "support/child.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// The program in a process of its own, between two pipes.
class Asked {
public:
    Asked(const RingDeck& ring, std::vector<std::string> settings) : error_(ring.folder.path("error.txt")) {
        settings.insert(settings.begin(), ring.deck);
        settings.push_back("frames=-");
        int in[2], out[2];
        REQUIRE(pipe(in) == 0);
        REQUIRE(pipe(out) == 0);
        child_ = fork();
        if (child_ == 0) {
            std::signal(SIGTERM, SIG_DFL);
            dup2(in[0], 0);
            for (const int end : {in[0], in[1], out[0]}) close(end);
            std::FILE* const error = std::fopen(error_.c_str(), "w");
            const int code = command_line(settings, fdopen(out[1], "w"), error);
            std::fclose(error);
            _exit(code);
        }
        close(in[0]);
        close(out[1]);
        in_ = fdopen(in[1], "w");
        out_ = fdopen(out[0], "r");
    }
    ~Asked() { end(); }

    std::string ask(const std::string& line) {
        tell(line);
        std::string text;
        for (int c; (c = std::fgetc(out_)) != EOF && c != '\n';) text += static_cast<char>(c);
        return text;
    }
    void stop_reading() { std::fclose(std::exchange(out_, nullptr)); }
    void tell(const std::string& line) {
        std::fprintf(in_, "%s\n", line.c_str());
        std::fflush(in_);
    }
    pid_t process() const { return child_; }
    int end() {
        if (child_ == 0) return 0;
        std::fclose(in_);
        if (out_) std::fclose(out_);
        int status = 0;
        waitpid(std::exchange(child_, 0), &status, 0);
        return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
    }
    std::string error() const { return text_of(error_); }

private:
    std::string error_;
    pid_t child_ = 0;
    std::FILE *in_ = nullptr, *out_ = nullptr;
};

// Of the nodes first .. first + 11: the inner boundary, or the outer one.
std::string rows(double shift, int first = 1, int count = 12) {
    std::string text;
    for (int i = 0; i < count; ++i) text += concat(first + i, ",", shift, ",0\n");
    return text;
}

const std::string by_file = "boundary inner=file - displacement";

}  // namespace

TEST_CASE("a line of input is a mesh, and a line of output when it is there") {
    const RingDeck ring;
    Asked run(ring, {by_file});
    const std::string mesh = ring.output + "/frame-000";
    for (int k = 1; k <= 3; ++k) {
        const std::string file = ring.folder.write(concat("wall ", k, ".csv"), rows(0.2 * k));
        CHECK(run.ask(concat(0.5 * k, " \t", file)) == concat(0.5 * k, " converged ", mesh, k, ".msh"));
        CHECK(mesh_of(concat(mesh, k, ".msh")).x[0] == 1 + 0.2 * k);
    }
    CHECK(run.end() == 0);
    CHECK(run.error().empty());
    CHECK(has(text_of(ring.output + "/frames.log"), "3 frames, all certified valid and injective"));
    CHECK(csv_rows(text_of(ring.output + "/frames.csv")).size() == 4);

    const std::string other = ring.folder.path("listed");  // the same from a list of times, to the last bit
    REQUIRE(ring.run({concat("boundary inner=file \"", ring.folder.path("wall %d.csv"), "\" displacement"),
                      "frames=0.5:0.5:1.5", "output=" + other}).code == 0);
    for (int k = 1; k <= 3; ++k)
        CHECK(mesh_of(concat(mesh, k, ".msh")).x == mesh_of(concat(other, "/frame-000", k, ".msh")).x);
}

TEST_CASE("a time step that is tried again replaces its mesh; one that is refused leaves it") {
    const RingDeck ring;
    Asked run(ring, {by_file});
    const std::string file = ring.folder.path("wall.csv"), second = ring.output + "/frame-0002.msh";
    const auto ask = [&](double t, double shift) {
        ring.folder.write("wall.csv", rows(shift));
        return run.ask(concat(t, " ", file));
    };
    ask(0, 0.1);
    ask(1, 0.5);
    CHECK(ask(1, 0.75) == "1 converged " + second);
    CHECK(mesh_of(second).x[0] == 1.75);
    CHECK(has(ask(1, 9), "1 refused the target makes the boundary itself invalid"));
    CHECK(mesh_of(second).x[0] == 1.75);
    CHECK(has(ask(2, 9), "2 refused the target makes"));
    CHECK(ask(1.5, 1) == concat("1.5 converged ", ring.output, "/frame-0004.msh"));
    CHECK(has(ask(1, 1), "1 refused the times run backwards, the last mesh is of t = 1.5"));
    CHECK(ask(2, 1.1) == concat("2 converged ", ring.output, "/frame-0003.msh"));
    CHECK(run.end() == 0);
    const auto table = csv_rows(text_of(ring.output + "/frames.csv"));
    REQUIRE(table.size() == 5);
    CHECK(table[2][2] == "converged");
}

TEST_CASE("the same time and file again give the same bits, whatever was tried between") {
    const RingDeck ring;
    Asked run(ring, {by_file, "velocity=faces"});
    const auto ask = [&](double t, double shift, int number) {
        const std::string name = concat(ring.output, "/frame-000", number);
        CHECK(has(run.ask(concat(t, " ", ring.folder.write("wall.csv", rows(shift)))), " converged "));
        return text_of(name + ".msh") + text_of(name + "-velocity.csv");
    };
    const auto check = [&](double t, double shift, int number) {
        const std::string first = ask(t, shift, number);
        CHECK(ask(t, shift, number) == first);
        CHECK(ask(t, -0.7 * shift, number) != first);
        CHECK(ask(t, shift, number) == first);
    };
    check(0, 0.25, 1);  // solved anew
    check(0.5, 0.5, 2);
    check(1, 0.875, 3);
    check(1.25, 0.9, 4);  // three meshes are known
    CHECK(run.end() == 0);
}

TEST_CASE("a mesh to which the nodes cannot go straight has a word of its own") {
    const RingDeck ring;
    Asked run(ring, {"boundary inner=rotate \"360*t\""});
    CHECK(has(run.ask("0.4"), "0.4 converged "));
    CHECK(run.ask("0.7") == concat("0.7 way_not_valid ", ring.output, "/frame-0002.msh"));  // the other way round
    CHECK(has(run.ask("0.75"), "0.75 converged "));
    CHECK(run.end() == 0);
    const auto table = csv_rows(text_of(ring.output + "/frames.csv"));
    CHECK(table[2][10] == "not valid");
    CHECK(table[2][8] == "yes");
}

TEST_CASE("meshes of a coupled run stay until another one has its first, and where that is of another mesh") {
    const RingDeck ring;
    const auto coupled = [&](const std::vector<std::string>& settings, const std::vector<std::string>& lines) {
        Asked run(ring, settings);
        std::string last;
        for (const std::string& line : lines) last = run.ask(line);
        run.end();
        return last;
    };
    const std::string shift = "boundary inner=translate \"t\" 0", mesh = ring.output + "/frame-0002.msh";
    REQUIRE(has(coupled({shift}, {"0.1", "0.2"}), "converged"));
    const auto files = [&] {
        std::string all;
        for (const char* name : {"frame-0001.msh", "frame-0002.msh", "frames.csv", "deck.txt", "summary.txt"})
            all += text_of(ring.output + "/" + name);
        return all;
    };
    const std::string before = files();
    CHECK(coupled({shift}, {}) == "");
    CHECK(has(coupled({shift}, {"9"}), "9 refused the target makes"));
    CHECK(has(coupled({shift, "max_newton_iterations=1"}, {"1"}), "1 max_newton_iterations"));
    CHECK(files() == before);
    CHECK(!std::filesystem::exists(ring.output + "/stop.vtk"));
    CHECK(has(text_of(ring.output + "/frames.log"), "the meshes of the run before are still in " + ring.output));

    ring.folder.write("other.msh", msh_of(ring_mesh(13, 3, 6)));
    const std::string other = "mesh=" + ring.folder.path("other.msh");
    for (const std::string frames : {"frames=0.3", ""}) {
        std::vector<std::string> settings = {other};
        if (!frames.empty()) settings.insert(settings.end(), {shift, frames});
        const Outcome outcome = ring.run(settings);
        CHECK(outcome.code == 1);
        CHECK(has(outcome.error, ring.output + " has the meshes of a coupled run of another mesh, "));
        CHECK(has(outcome.error, "ring.msh, which this run would remove: give it another folder, `output = FOLDER`"));
    }
    {
        Asked run(ring, {shift, other});
        CHECK(run.end() == 1);
    }
    CHECK(files() == before);
    REQUIRE(has(coupled({shift}, {"9", "0.3"}), "0.3 converged " + mesh));
    CHECK(!std::filesystem::exists(ring.output + "/frame-0001.msh"));
    CHECK(csv_rows(text_of(ring.output + "/frames.csv")).size() == 3);  // the one that was refused has a row, too
    CHECK(text_of(ring.output + "/deck.txt") != before);
}

TEST_CASE("velocities of a time step that is tried again are relative to the step before it") {
    const RingDeck ring;
    Asked run(ring, {by_file, "velocity=faces"});
    const std::string file = ring.folder.path("wall.csv");
    const auto speed = [&](double t, double shift, int number) {
        ring.folder.write("wall.csv", rows(shift));
        CHECK(has(run.ask(concat(t, " ", file)), "converged"));
        return *parse_double(csv_rows(text_of(concat(ring.output, "/frame-000", number, "-velocity.csv")))[1][3]);
    };
    CHECK(speed(0, 0, 1) == 0);
    CHECK(speed(0.5, 0.25, 2) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(speed(1, 1, 3) == doctest::Approx(1.5).epsilon(1e-14));
    const std::string tried = text_of(ring.output + "/frame-0003-swept.csv");
    CHECK(speed(1, 0.75, 3) == doctest::Approx(1).epsilon(1e-14));
    CHECK(text_of(ring.output + "/frame-0003-swept.csv") != tried);
    CHECK(speed(1, 1, 3) == doctest::Approx(1.5).epsilon(1e-14));
    CHECK(run.end() == 0);
}

TEST_CASE("what is wrong with a line or its file is answered in a line, and the run goes on") {
    const RingDeck ring;
    Asked run(ring, {by_file});
    const std::string file = ring.folder.write("wall.csv", rows(0.1)), bad = ring.folder.path("bad.csv");
    REQUIRE(has(run.ask("0 " + file), "0 converged"));
    const auto refused = [&](const std::string& line, const std::string& why) {
        const std::string answer = run.ask(line);
        CHECK_MESSAGE(answer.starts_with(line.substr(0, line.find(' ')) + " refused "), answer);
        CHECK_MESSAGE(has(answer, why), answer);
    };
    refused("nan " + file, "`nan` is not a number");
    refused("next " + file, "expected a time and 1 file: `next` is not a number");
    refused("-1 " + file, "the times run backwards, the last mesh is of t = 0");
    refused("1", "the deck takes 1 file with each time, in its steps named `-`; here are 0");
    refused("1 " + bad, "boundary inner, frame 2, t = 1: no such file: " + bad);
    ring.folder.write("bad.csv", rows(0.1) + "13,0.1,0\n");
    refused("1 " + bad, "bad.csv:13: node 13 is not on boundary inner");
    ring.folder.write("bad.csv", rows(0.1, 1, 11));
    refused("1 " + bad, "1 node of boundary inner missing, the first with id 12");
    ring.folder.write("bad.csv", "1 nan 0\n");
    refused("1 " + bad, "bad.csv:1: a coordinate `nan` is not a finite number");
    ring.folder.write("bad.csv", "1 0\n");
    refused("1 " + bad, "bad.csv:1: ");
    const std::string table = ring.output + "/frames.csv";
    std::filesystem::remove(table);
    std::filesystem::create_directory(table);  // as if the disk were full
    const std::string full = run.ask("1 " + file);
    CHECK_MESSAGE((full.starts_with("1 refused ") && has(full, table)), full);
    std::filesystem::remove(table);
    for (const char* empty : {"", " \t", "\r"})
        CHECK(run.ask(empty) == "- refused expected a time and 1 file: the line is empty");
    CHECK(run.ask("1 " + file) == concat("1 converged ", ring.output, "/frame-0002.msh"));
    CHECK(run.end() == 0);
    CHECK(csv_rows(text_of(ring.output + "/frames.csv")).size() == 3);
}

TEST_CASE("no file, or one for each of several boundaries; formulas of t beside them") {
    const RingDeck ring;
    const std::string inner = ring.folder.write("inner.csv", rows(0.25)), outer = ring.folder.write("outer.csv",
                                                                                                     rows(0.5, 37));
    {
        Asked run(ring, {"boundary inner=translate \"t\" 0"});
        CHECK(has(run.ask("0.5"), "0.5 converged"));
        CHECK(has(run.ask("0.75 " + inner), "refused the deck takes 0 files with each time"));
        CHECK(mesh_of(ring.output + "/frame-0001.msh").x[0] == 1.5);
    }
    Asked run(ring, {by_file + "; translate \"t\" 0", "boundary outer=file - displacement"});
    CHECK(has(run.ask("0.5 " + inner), "here is 1"));
    CHECK(has(run.ask(concat("0.5 ", inner, " ", outer)), "0.5 converged"));
    const Mesh mesh = mesh_of(ring.output + "/frame-0001.msh");
    CHECK(mesh.x[0] == 1.75);
    CHECK(mesh.x[2 * 36] == 6.5);
}

TEST_CASE("answers that nobody reads end the run, with its meshes; a second run in the folder is refused") {
    const RingDeck ring;
    Asked run(ring, {"boundary inner=translate \"t\" 0"});
    REQUIRE(has(run.ask("0.5"), "converged"));
    const Outcome second = ring.run({"frames=0,1"});
    CHECK(second.code == 2);
    CHECK(has(second.error, "another run writes to " + ring.output));
    run.stop_reading();
    run.tell("1");
    CHECK(run.end() == 2);
    CHECK(has(run.error(), "frames = -: nobody reads the answers any more; the meshes made so far are there"));
    CHECK(csv_rows(text_of(ring.output + "/frames.csv")).size() == 3);
    CHECK(std::filesystem::exists(ring.output + "/frame-0002.msh"));
}

TEST_CASE("a run that waits for a line ends with the signal") {
    const RingDeck ring;
    Asked run(ring, {"boundary inner=translate \"t\" 0"});
    REQUIRE(has(run.ask("0.5"), "converged"));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // until it waits
    kill(run.process(), SIGTERM);
    CHECK(run.end() == -SIGTERM);
    CHECK(std::filesystem::exists(ring.output + "/frame-0001.msh"));
    CHECK(ring.run({"frames=0,1"}).code == 0);  // the folder is free
}

TEST_CASE("files that a line names need frames = -, which does not go with resume") {
    const RingDeck ring;
    CHECK(has(ring.run({by_file}).error, "needs `frames = -`"));
    CHECK(has(ring.run({by_file, "frames=0,1"}).error, "needs `frames = -`"));
    CHECK(has(ring.run({by_file, "frames=-", "resume=1"}).error, "resume does not go with frames = -"));
}
