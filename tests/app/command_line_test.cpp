#include "app/commands.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "check/certificate.hpp"
#include "deck/deck.hpp"
#include "support/high_order.hpp"
#include "support/ring_deck.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// A square of 8 x 8 cells, `count` of its inner nodes, no neighbours, moved so far that elements turn over.
Mesh tangled_square(int count) {
    Mesh mesh = square_mesh(8);
    for (int j = 2; j < 8; j += 2)
        for (int i = 2; i < 8 && count > 0; i += 2, --count) mesh.x[2 * (9 * j + i)] += 0.2;
    return mesh;
}

// Indented lines after the last `start`, 0 where it does not occur.
int count_lines_after(const std::string& text, const std::string& start) {
    int count = 0;
    for (const std::string& line : pieces(text.substr(std::min(text.rfind(start), text.size())), '\n'))
        count += line.starts_with("  ");
    return count;
}

}  // namespace

TEST_CASE("--help tells usage and exit codes") {
    for (const char* option : {"--help", "-h"}) {
        const Outcome outcome = almesh_with({option});
        CHECK(outcome.code == 0);
        CHECK(outcome.error.empty());
        for (const char* part :
             {"almesh DECK", "almesh quality FILE", "--keys", "--version", "Exit codes", "boundary inner"})
            CHECK(has(outcome.out, part));
        // Wherever it stands.
        CHECK(almesh_with({"info", option}).out == outcome.out);
        CHECK(almesh_with({"quality", option}).out == outcome.out);
        CHECK(almesh_with({"no-such.deck", option}).out == outcome.out);
    }
}

TEST_CASE("--keys lists every key, motion and quantity within 100 columns") {
    const Outcome outcome = almesh_with({"--keys"});
    CHECK(outcome.code == 0);
    for (const DeckKey& key : deck_keys()) CHECK(has(outcome.out, "\n" + key.name + " "));
    for (const char* part : {"boundary NAME", "expect QUANTITY", "translate DX DY", "certified_valid"})
        CHECK(has(outcome.out, part));
    for (const std::string& line : pieces(outcome.out, '\n')) CHECK(line.size() <= 100);
}

TEST_CASE("--version tells program, commit and compiler") {
    const Outcome outcome = almesh_with({"--version"});
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "almesh "));
    CHECK(has(outcome.out, "commit "));
    CHECK(has(outcome.out, "++ "));
}

TEST_CASE("wrong command lines end with code 1 and a hint, and print nothing else") {
    for (const auto& [arguments, message] :
         std::vector<std::pair<std::vector<std::string>, std::string>>{{{"--hlep"}, "unknown option --hlep"},
                                                                       {{"-x"}, "unknown option -x"},
                                                                       {{"quality"}, "almesh quality FILE"},
                                                                       {{"quality", "a", "b"}, "expected `key = value`, got `b`"},
                                                                       {{"no/such.deck"}, "no/such.deck"}}) {
        const Outcome outcome = almesh_with(arguments);
        CHECK(outcome.code == 1);
        CHECK(outcome.out.empty());
        CHECK(outcome.error.starts_with("almesh: "));
        CHECK(has(outcome.error, message));
        CHECK(outcome.error.ends_with('\n'));
    }
}

TEST_CASE("without arguments: the help, and code 1") {
    const Outcome outcome = almesh_with({});
    CHECK(outcome.code == 1);
    CHECK(outcome.out == almesh_with({"--help"}).out);
    CHECK(outcome.error.empty());
}

TEST_CASE("a mesh in place of a deck: code 1, and what to type") {
    const TemporaryFolder folder;
    const std::string mesh = msh_of(square_mesh(2)), square = folder.write("square.msh", mesh);
    for (const std::string& path : {square, folder.write("named.otherwise", mesh), folder.write("a.su2", "%\nNDIME= 2\n"),
                                    folder.write("empty of sense.msh", "no mesh\n")}) {
        const Outcome outcome = almesh_with({path, "boundary all=fixed"});
        CHECK(outcome.code == 1);
        CHECK(outcome.out.empty());
        CHECK(has(outcome.error, path + ": this is a mesh"));
    }
    CHECK(has(almesh_with({square}).error, "\n  almesh info " + square + " > square.deck\n  almesh square.deck\n"));
    CHECK(has(almesh_with({folder.path("empty of sense.msh")}).error, " > \"empty of sense.deck\"\n"));
    CHECK(has(almesh_with({folder.path("missing.msh")}).error, "cannot be opened"));
    CHECK(has(almesh_with({folder.write("empty.deck", "")}).error, "mesh"));
}

TEST_CASE("quality of a valid mesh") {
    const TemporaryFolder folder;
    for (const Mesh& mesh : {square_mesh(3), raise_degree(ring_mesh(8, 2, 3), 3), cube_mesh(2)}) {
        const Outcome outcome = almesh_with({"quality", folder.write("mesh.msh", msh_of(mesh))});
        CHECK(outcome.code == 0);
        CHECK(outcome.error.empty());
        CHECK(has(outcome.out, std::to_string(mesh.nodes()) + " nodes, " + std::to_string(mesh.element_count()) +
                                   (mesh.dim == 2 ? " triangles" : " tetrahedra")));
        CHECK(has(outcome.out, "of degree " + std::to_string(mesh.degree)));
        CHECK(has(outcome.out, "\ncertified valid: certified bound "));
        CHECK(count_lines_after(outcome.out, "worst elements") == 10);
    }
}

TEST_CASE("quality of a regular triangle is one") {
    const TemporaryFolder folder;
    const Mesh mesh =
        linear_mesh(2, {0, 0, 1, 0, 0.5, 0.8660254037844386}, {0, 1, 2}, [](const double*) { return "rim"; });
    const Outcome outcome = almesh_with({"quality", folder.write("mesh.msh", msh_of(mesh))});
    CHECK(has(outcome.out, "; edges 1 to 1\n"));
    for (const char* row : {"\nscaled Jacobian                  1    1.0000        0  ",
                            "\nquality 1/eta                    1    1.0000        0  "})
        CHECK(has(outcome.out, row));
    CHECK(has(outcome.out, "0.9 - 1.0         1"));
}

TEST_CASE("quality of a mesh with inverted elements: code 4, and the first ten by id") {
    const TemporaryFolder folder;
    Mesh curved = raise_degree(square_mesh(1), 2);  // only the curved inside of the element is inverted
    for (int i = 0; i < curved.nodes(); ++i)
        if (curved.x[2 * i] == 0.5 && curved.x[2 * i + 1] == 0) curved.x[2 * i + 1] = 0.4;
    REQUIRE(certify(tangled_square(9), tangled_square(9).x).uncertified.size() > 10);
    for (const Mesh& mesh : {curved, tangled_square(1), tangled_square(9)}) {
        const std::size_t bad = certify(mesh, mesh.x).uncertified.size();
        REQUIRE(bad > 0);
        const Outcome outcome = almesh_with({"quality", folder.write("bad.msh", msh_of(mesh))});
        CAPTURE(outcome.out);
        CHECK(outcome.code == 4);
        CHECK(has(outcome.out, "NOT certified valid: " + std::to_string(bad) + " element"));
        CHECK(count_lines_after(outcome.out, "NOT certified") == static_cast<int>(bad > 10 ? 11 : bad));
    }
}

// The shear x + t^2 (2, -1), t = x + 2 y, keeps areas, but not those of triangles with straight edges.
TEST_CASE("quality takes curved elements as they are where their vertices alone would be folded") {
    const TemporaryFolder folder;
    Mesh mesh = with_degree(square_mesh(4), 2);
    for (int i = 0; i < mesh.nodes(); ++i) {
        double* const x = point(mesh.x, i, 2);
        const double t = x[0] + 2 * x[1];
        x[0] += 8 * t * t;
        x[1] -= 4 * t * t;
    }
    Mesh straight = mesh;
    straight.x = straight_sided(mesh);
    REQUIRE(!certify(straight, straight.x).valid);
    folder.write("sheared.msh", msh_of(mesh));
    const Outcome outcome = almesh_with({"quality", folder.path("sheared.msh")});
    CHECK(has(outcome.out, "\ncertified valid: certified bound "));
    CHECK(!has(outcome.out, "same side"));
    const std::string deck = "mesh = sheared.msh\nboundary rest = fixed\noutput = " + folder.path("out") + "\n";
    const Outcome run = almesh_with({folder.write("sheared.deck", deck), "ideal=straight"});
    CHECK(run.code == 2);
    CHECK(has(run.error, "without their curves: the straight form of the mesh folds over itself"));
}

TEST_CASE("quality does not certify two elements on the same side of their common face, both positive in the file") {
    const TemporaryFolder folder;
    const std::string path = folder.write("fold.msh",
                                          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n"
                                          "3 0.5 1 0\n4 0.5 0.5 0\n$EndNodes\n$Elements\n6\n1 1 2 1 1 1 3\n"
                                          "2 1 2 1 1 2 3\n3 1 2 1 1 1 4\n4 1 2 1 1 2 4\n5 2 2 2 1 1 2 3\n"
                                          "6 2 2 2 1 1 2 4\n$EndElements\n");
    const Outcome outcome = almesh_with({"quality", path});
    CHECK(outcome.code == 4);
    CHECK(has(outcome.out,
              "NOT certified injective: elements 5 and 6 lie on the same side of their common face at (0.5, "));
    CHECK(!has(outcome.out, "no two elements overlap"));
}

TEST_CASE("quality of what is no mesh: code 2, naming the file") {
    const TemporaryFolder folder;
    for (const std::string& path : {folder.path("none.msh"), folder.path(), folder.write("empty.msh", ""),
                                    folder.write("text.msh", "a deck = here\n")}) {
        const Outcome outcome = almesh_with({"quality", path});
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, path));
    }
}

TEST_CASE("a reader of the table that goes away does not end a run") {
    const RingDeck ring;
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    close(ends[0]);
    std::FILE *const out = fdopen(ends[1], "w"), *const error = std::tmpfile();
    std::setvbuf(out, nullptr, _IOLBF, BUFSIZ);
    CHECK(command_line({ring.deck}, out, error) == 0);
    CHECK(take_contents(error).empty());
    CHECK(summary_of(ring.output).at("status") == "converged");
    std::fclose(out);  // as at the end of the program
    std::signal(SIGPIPE, SIG_DFL);
}

TEST_CASE("a command whose output cannot be written ends with code 2") {
    const TemporaryFolder folder;
    const std::string mesh = folder.write("a.msh", msh_of(square_mesh(2)));
    const std::vector<std::vector<std::string>> commands = {{"quality", mesh}, {"info", mesh}, {"--keys"}, {"--help"}};
    for (const auto& command : commands) {
        std::FILE *const full = std::fopen("/dev/full", "w"), *const error = std::tmpfile();
        if (!full) return;
        CHECK(command_line(command, full, error) == 2);
        CHECK(has(take_contents(error), "almesh: cannot write the output: No space left"));
        std::fclose(full);
    }
}

TEST_CASE("the first signal ends a command that nobody can interrupt otherwise") {
    const TemporaryFolder folder;
    const std::string fifo = folder.path("mesh.msh");
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP})
        for (const char* command : {"quality", "info"}) {
            int ready[2];
            REQUIRE(pipe(ready) == 0);
            const pid_t child = fork();
            if (child == 0) {
                std::signal(signal, SIG_DFL);  // the test program has its own
                if (write(ready[1], "", 1) != 1) _exit(9);
                std::FILE* const nowhere = std::fopen("/dev/null", "w");
                _exit(command_line({command, fifo}, nowhere, nowhere));
            }
            char byte;
            REQUIRE(read(ready[0], &byte, 1) == 1);
            close(ready[0]);
            close(ready[1]);
            usleep(20000);
            kill(child, signal);
            int status = 0;
            REQUIRE(waitpid(child, &status, 0) == child);
            CHECK(WIFSIGNALED(status));
        }
}

TEST_CASE("a signal while a run reads its mesh ends with a sentence") {
    const TemporaryFolder folder;
    const std::string fifo = folder.path("mesh.msh"), error = folder.path("error.txt"),
                      deck = folder.write("a.deck", "mesh = mesh.msh\nboundary all = fixed\n"),
                      frames = folder.write("b.deck", "mesh = mesh.msh\nboundary all = fixed\nframes = 0, 1\n");
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    for (const std::vector<std::string>& command : {std::vector{deck}, {frames}, {"improve", fifo}}) {
        const pid_t child = fork();
        if (child == 0) {
            std::signal(SIGTERM, SIG_DFL);
            if (!std::freopen(error.c_str(), "w", stderr)) _exit(9);
            _exit(command_line(command, stdout, stderr));
        }
        const int in = open(fifo.c_str(), O_WRONLY);  // waits until the run opens it
        kill(child, SIGTERM);
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        close(in);
        CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 3));
        CHECK(has(text_of(error), "almesh: interrupted"));
    }
}
