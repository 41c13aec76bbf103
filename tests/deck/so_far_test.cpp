// Runs that were stopped, killed or had no room to write, and go on with start = so-far.msh.
#include "deck/so_far.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>

#include "deck/deck.hpp"
#include "support/child.hpp"
#include "support/high_order.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Killed {};

std::vector<double> positions_in(const std::string& path) {
    std::vector<double> x;
    for (const RawNode& node : read_mesh(path).nodes) x.insert(x.end(), node.x, node.x + 3);
    return x;
}

// A deck with the mesh that it moves, and what it comes to.
struct Project {
    TemporaryFolder folder;
    std::string deck, output = folder.path("results"), so_far = output + "/so-far.msh";

    Project(const Mesh& mesh, const std::string& more) {
        folder.write("some.msh", msh_of(mesh));
        deck = folder.write("some.deck", "mesh = some.msh\nthreads = 1\nvtk = none\noutput = " + output + "\n" + more);
    }

    // stop: after so many steps it is stopped, or killed. Returns the number of steps.
    int run(std::vector<std::string> settings, int stop = -1, bool kills = false) const {
        int steps = 0;
        RunHooks hooks;
        hooks.stepped = [&] {
            if (++steps != stop) return;
            if (kills) throw Killed();
            interrupt_flag = 1;
        };
        hooks.seconds_between_meshes = kills ? 0 : 1e9;
        std::FILE* const out = std::tmpfile();
        try {
            const ExitCode code = almesh::run(read_deck(deck, settings), out, hooks);
            CHECK(code == (stop < 0 || steps < stop ? ExitCode::success : ExitCode::not_converged));
        } catch (const Killed&) {
        }
        clear_interrupt();
        printed = take_contents(out);
        return steps;
    }

    int go_on(int stop = -1, bool kills = false) const { return run({"start=" + so_far}, stop, kills); }

    std::vector<double> positions() const { return positions_in(output + "/final.msh"); }
    double eta() const { return number(summary_of(output), "max_distortion"); }

    mutable std::string printed;  // by the last run
};

double distance(const std::vector<double>& x, const std::vector<double>& y) {
    REQUIRE(x.size() == y.size());
    double largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(x[i] - y[i]));
    return largest;
}

// Of degree 3, whose boundaries have bumps that fold the elements there.
Mesh with_bumps() {
    Mesh mesh = with_degree(square_mesh(8), 3);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, 2);
        if (x[1] == 0) x[1] += 0.12 * std::exp(-80 * std::pow(x[0] - 0.25, 2));
        else if (x[1] == 1) x[1] -= 0.11 * std::exp(-80 * std::pow(x[0] - 0.7, 2));
        else if (x[0] == 0) x[0] += 0.1 * std::exp(-80 * std::pow(x[1] - 0.6, 2));
        else if (x[0] == 1) x[0] -= 0.12 * std::exp(-80 * std::pow(x[1] - 0.4, 2));
    }
    return mesh;
}

// Of degree 3, straight but for some faces of the boundary on which the two inner nodes have changed places.
Mesh with_folded_faces() {
    Mesh mesh = with_degree(square_mesh(8), 3);
    for (int f = 0; f < mesh.face_count(); f += 3)
        for (int a = 0; a < 2; ++a) std::swap(point(mesh.x, mesh.face(f)[2], 2)[a], point(mesh.x, mesh.face(f)[3], 2)[a]);
    return mesh;
}

Mesh shaken() {
    Mesh mesh = square_mesh(6);
    std::vector<char> on_boundary(mesh.nodes(), 0);
    for (const int i : mesh.faces) on_boundary[i] = 1;
    for (int i = 0; i < 2 * mesh.nodes(); ++i)
        if (!on_boundary[i / 2]) mesh.x[i] += 0.04 * std::sin(17 * i);
    return mesh;
}

struct Case {
    const char* name;
    Mesh mesh;
    std::string text;
    double tolerance;
};

std::vector<Case> cases() {
    const std::string move = "boundary inner = translate 2 0\nboundary outer = fixed\n";
    return {{"turn", ring_mesh(12, 12, 200), "boundary inner = rotate 330\nboundary outer = fixed\ncontinuation = always\n",
             1e-5},
            {"turn of a raised degree", ring_mesh(12, 6, 200),
             "boundary inner = rotate 330\nboundary outer = fixed\ncontinuation = always\ndegree = 2\n", 1e-5},
            {"minimax", ring_mesh(12, 3, 6), move + "objective = minimax\n", 1e-4},
            {"degree", ring_mesh(12, 3, 6), move + "degree = 3\nrefine = 1\n", 1e-5},
            {"slide", ring_mesh(12, 3, 6), "boundary inner = translate 2 0\nboundary outer = slide\n", 1e-5},
            {"penalty", ring_mesh(12, 3, 6), move + "method = penalty\nepsilon_star = 1e-8\n", 1e-5},
            {"repair", with_bumps(), "boundary all = fixed\nlocal_repair = 1\n", 1e-9},
            {"whole repair", with_bumps(), "boundary all = fixed\nlocal_repair = 0\n", 1e-5},
            {"improve", shaken(), "boundary all = fixed\nideal = regular\n", 1e-5}};
}

}  // namespace

TEST_CASE("a run that is stopped or killed at any place goes on to the same minimiser") {
    constexpr int places = 4;
    for (const Case& each : cases()) {
        CAPTURE(each.name);
        const Project project(each.mesh, each.text);
        const int steps = project.run({});
        const std::vector<double> whole = project.positions();
        const double eta = project.eta(), size = *std::max_element(whole.begin(), whole.end());
        CHECK(!std::filesystem::exists(project.so_far));
        for (const bool kills : {false, true})
            for (int place = 1; place <= places; ++place) {
                const int stop = std::max(1, steps * place / (places + 1));
                CAPTURE(kills);
                CAPTURE(stop);
                std::filesystem::remove_all(project.output);
                project.run({}, stop, kills);
                const bool has_begun = std::filesystem::exists(project.so_far);  // else in its first increment
                CHECK((has_begun || std::string(each.name) == "turn"));
                CHECK((has_begun && !kills) ==
                      has(project.printed, "\ntry almesh " + project.deck + " start=" + project.so_far + " with"));
                has_begun ? project.go_on() : project.run({});
                CHECK(has(project.printed, "goes on from " + project.so_far + "\n") == has_begun);
                CHECK(distance(project.positions(), whole) < each.tolerance * size);
                CHECK(project.eta() == doctest::Approx(eta).epsilon(1e-4));
                CHECK(!std::filesystem::exists(project.so_far));
            }
    }
}

TEST_CASE("a run that every process takes a few steps further comes to the same minimiser") {
    for (const auto& [k, few] : {std::pair(1, 25), std::pair(3, 2)}) {
        const Case each = cases()[k];
        CAPTURE(each.name);
        const Project project(each.mesh, each.text);
        project.run({});
        const std::vector<double> whole = project.positions();
        project.run({}, few, true);
        int runs = 0;
        while (project.go_on(few, true) >= few) REQUIRE(++runs < 60);
        CHECK(runs >= 1);
        CHECK(distance(project.positions(), whole) < each.tolerance * *std::max_element(whole.begin(), whole.end()));
    }
}

TEST_CASE("a repair whose nodes have slid is stopped again as soon as it goes on") {
    const Project project(with_folded_faces(), "boundary all = fixed\nlocal_repair = 1\n");
    const int steps = project.run({});
    const std::vector<double> whole = project.positions();
    int slid = 0;
    for (int tenth = 5; tenth < 10; ++tenth) {
        project.run({}, steps * tenth / 10);
        const std::string text = text_of(project.so_far);
        const auto freed = text.find("\nfreed ");
        slid += text.find('1', freed) < text.find('\n', freed + 1);
        project.run({"start=" + project.so_far, "max_seconds=1e-9"}, 0);
        project.go_on();
        CHECK(distance(project.positions(), whole) < 1e-9);
    }
    CHECK(slid > 0);
}

TEST_CASE("the mesh from which a run goes on stays until there is a newer one") {
    const Case turn = cases()[0];
    const Project project(turn.mesh, turn.text);
    project.run({}, 20);
    const std::string before = text_of(project.so_far);
    const auto go_on_and_die = [&](double seconds) {
        RunHooks hooks;
        hooks.stepped = [] { throw Killed(); };
        hooks.seconds_between_meshes = seconds;
        std::FILE* const out = std::tmpfile();
        CHECK_THROWS_AS(almesh::run(read_deck(project.deck, {"start=" + project.so_far}), out, hooks), Killed);
        std::fclose(out);
    };
    go_on_and_die(1e9);
    CHECK(text_of(project.so_far) == before);
    go_on_and_die(0);
    CHECK(text_of(project.so_far) != before);
    project.run({});  // from the beginning
    CHECK(!std::filesystem::exists(project.so_far));
}

TEST_CASE("the mesh so far is a mesh as any other on another way, and where its run stood is not trusted if damaged") {
    const Case turn = cases()[0];
    const Project project(turn.mesh, turn.text);
    project.run({}, 20);
    const std::string other = project.folder.path("other.msh"), text = text_of(project.so_far);
    std::filesystem::copy_file(project.so_far, other);
    project.run({"start=" + other, "boundary inner=rotate 300"});
    CHECK(has(project.printed, "note: " + other + " was written on the way to another target or by another motion"));
    CHECK(!has(project.printed, "goes on from"));
    project.run({"start=" + other});
    CHECK(has(project.printed, "goes on from " + other));
    for (const char* const word : {"fraction 0.", "power ", "freed"}) {
        CAPTURE(word);
        std::string damaged = text;
        damaged.replace(damaged.rfind(word), std::string(word).size(), "fraction -3 ");
        write_file(other, damaged);
        const Outcome outcome = almesh_with({project.deck, "start=" + other});
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, "command line: start = " + other + ": where its run stood is damaged"));
    }
}

TEST_CASE("resume is for frames, and says what goes on elsewhere") {
    const RingDeck ring;
    const Outcome outcome = ring.run({"resume=1"});
    CHECK(outcome.code == 1);
    CHECK(has(outcome.error, "command line: resume is for frames; try almesh " + ring.deck + " start=" + ring.output +
                                 "/so-far.msh with the other settings of this run, which goes on from where it stood\n"));
    CHECK(has(ring.run({"max_seconds=1e-9"}).out, "try max_seconds = 4e-09"));  // nothing has been done yet
}

TEST_CASE("where a disk is full nothing that was there is lost, and the run goes on when there is room again") {
    const RingDeck ring(ring_mesh(24, 6, 6));
    REQUIRE(ring.run().code == 0);
    const std::string whole = text_of(ring.output + "/final.msh"), other = ring.folder.path("other");
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
            RunHooks hooks;
            hooks.seconds_between_meshes = 0;
            try {
                return static_cast<int>(almesh::run(read_deck(ring.deck, {"output=" + other}), stderr, hooks));
            } catch (const Error& error) {
                return static_cast<int>(error.exit_code);
            }
        };
        CHECK(in_child(run, [](pid_t) {}) == 2);
        const auto is_whole = [&](const std::string& file) { return file.empty() || file.ends_with("$EndComments\n"); };
        CHECK(text_of(other + "/final.msh").size() % whole.size() == 0);  // whole or not there
        CHECK(is_whole(text_of(other + "/so-far.msh")));
        std::vector<std::string> settings = {"output=" + other};
        if (std::filesystem::exists(other + "/so-far.msh")) settings.push_back("start=" + other + "/so-far.msh");
        CHECK(ring.run(settings).code == 0);
        CHECK(distance(positions_in(other + "/final.msh"), positions_in(ring.output + "/final.msh")) < 1e-6);
    }
}
