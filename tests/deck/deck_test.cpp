#include "deck/deck.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"

using namespace almesh;

namespace {

const std::string file_name = "inputs/circle.deck";

Deck parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return parse_deck("mesh = meshes/circle.msh\n" + text, file_name, overrides);
}

// The message of the first error; the deck's text starts in line 2.
std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        parsed(text, overrides);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void check_same(const Deck& a, const Deck& b) {
    for (const DeckKey& key : deck_keys()) CHECK(key.value.text(a) == key.value.text(b));
    REQUIRE(a.boundaries.size() == b.boundaries.size());
    for (std::size_t i = 0; i < a.boundaries.size(); ++i) {
        CHECK(a.boundaries[i].name == b.boundaries[i].name);
        CHECK(a.boundaries[i].motion == b.boundaries[i].motion);
    }
    REQUIRE(a.expectations.size() == b.expectations.size());
    for (std::size_t i = 0; i < a.expectations.size(); ++i)
        CHECK(to_string(a.expectations[i]) == to_string(b.expectations[i]));
}

// A file that is removed at the end of its test.
struct TemporaryFile {
    std::string path;
    TemporaryFile(const std::string& name, const std::string& content)
        : path((std::filesystem::temp_directory_path() / name).string()) {
        std::ofstream(path, std::ios::binary) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path); }
};

}  // namespace

TEST_CASE("a deck with a bit of everything") {
    const Deck deck = parse_deck(
        "# the circle of section 4.1\n"
        "title = Circle: q = 0.9365   # with a comment\n"
        "mesh=meshes/circle.msh\n"
        "\n"
        "degree = 2\t\n"
        "  objective = squared\n"
        "mu0 = 1e4\n"
        "boundary inner = rotate 30 about 0 0; translate 8 0 # there\n"
        "boundary \"outer wall = #2\"=fixed\n"
        "boundary\t\"tag 7\" = translate 1 0\n"
        "expect status = converged\n"
        "expect relative_quality = 0.9365 +- 0.0005",
        "inputs/circle.deck");
    CHECK(deck.title == "Circle: q = 0.9365");
    CHECK(deck.mesh == "inputs/meshes/circle.msh");
    CHECK(deck.output == "outputs/circle");
    CHECK(deck.degree == 2);
    CHECK(deck.distortion.objective == Objective::squared);
    CHECK(deck.method.mu0 == 1e4);
    CHECK(!deck.length_scale);
    REQUIRE(deck.boundaries.size() == 3);
    CHECK(deck.boundaries[0].name == "inner");
    CHECK(to_string(deck.boundaries[0].motion) == "rotate 30 about 0 0; translate 8 0");
    CHECK(deck.boundaries[0].where == "inputs/circle.deck:8");
    CHECK(deck.boundaries[1].name == "outer wall = #2");
    CHECK(deck.boundaries[2].name == "tag 7");
    REQUIRE(deck.expectations.size() == 2);
    CHECK(deck.expectations[1].tolerance == 0.0005);
    CHECK(deck.expectations[1].where == "inputs/circle.deck:12");
    CHECK(deck.name == "circle");
    CHECK(deck.folder == "inputs");
    CHECK(deck.given.at("degree") == "inputs/circle.deck:5");
    CHECK(deck.given.count("refine") == 0);
}

TEST_CASE("byte order mark, CRLF line ends, no last line end") {
    const Deck deck = parse_deck("\xEF\xBB\xBFmesh = a.msh\r\n\r\ndegree = 3\r\ntitle = x\r", "a.deck");
    CHECK(deck.mesh == "a.msh");
    CHECK(deck.degree == 3);
    CHECK(deck.title == "x");
    CHECK(deck.output == "outputs/a");
}

TEST_CASE("the mesh path starts in the deck's folder, or in the current one on the command line") {
    CHECK(parse_deck("mesh = ../m/a.msh", "inputs/paper/a.deck").mesh == "inputs/m/a.msh");
    CHECK(parse_deck("mesh = /data/a.msh", "inputs/a.deck").mesh == "/data/a.msh");
    CHECK(parse_deck("mesh = a.msh", "inputs/a.deck", {"mesh=b.msh"}).mesh == "b.msh");
    CHECK(parse_deck("", "inputs/a.deck", {"mesh=./m/../b.msh"}).mesh == "b.msh");
}

TEST_CASE("the command line replaces what the file says") {
    const std::string text =
        "degree = 2\nboundary inner = translate 8 0\nexpect nodes = 841\nexpect max_distortion <= 3\n";
    const Deck deck = parsed(text, {"degree=4", "boundary inner=translate 4 0", "boundary \"outer wall\"=fixed",
                                    "expect nodes = 3324", "title=run #3", " output = outputs/x "});
    CHECK(deck.degree == 4);
    CHECK(deck.given.at("degree") == "command line");
    REQUIRE(deck.boundaries.size() == 2);
    CHECK(to_string(deck.boundaries[0].motion) == "translate 4 0");
    CHECK(deck.boundaries[0].where == "command line");
    CHECK(deck.boundaries[1].name == "outer wall");
    REQUIRE(deck.expectations.size() == 2);
    CHECK(to_string(deck.expectations[0]) == "max_distortion <= 3");
    CHECK(to_string(deck.expectations[1]) == "nodes = 3324");
    CHECK(deck.title == "run #3");
    CHECK(deck.output == "outputs/x");
    CHECK(deck.mesh == "inputs/meshes/circle.msh");
    const Deck range = parsed(text, {"expect max_distortion >= 2", "expect max_distortion <= 4"});
    REQUIRE(range.expectations.size() == 3);  // both replace the file's line, neither the other
}

TEST_CASE("constants of formulas and of numbers of steps") {
    const std::string text =
        "boundary inner = rotate \"30*turn\" about shift 0; translate shift \"t + shift\"\n"
        "let turn = 2\nlet shift = \"turn/4\"\nselect top = y > shift\n";
    const auto numbers = [](const Deck& deck, int step) { return deck.boundaries.at(0).motion.steps.at(step).numbers; };
    const Deck deck = parsed(text);
    CHECK(numbers(deck, 0) == std::vector<double>{60});
    CHECK(deck.boundaries[0].motion.steps[0].about == std::vector<double>{0.5, 0});
    CHECK(numbers(deck, 1) == std::vector<double>{0.5, 0.5});
    CHECK(deck.selections.at(0).condition.value()({0, 0.6, 0}, {}));
    CHECK(to_string(deck.boundaries[0].motion) ==
          "rotate \"30*turn\" about \"shift\" 0; translate \"shift\" \"t + shift\"");
    const Deck other = parsed(text, {"let turn=8"});  // and what is made of it
    CHECK(numbers(other, 0) == std::vector<double>{240});
    CHECK(numbers(other, 1) == std::vector<double>{2, 2});
    const Deck again = parse_deck(resolved(deck), "outputs/a/deck.txt", {"let turn = 8"});
    CHECK(numbers(again, 1) == numbers(other, 1));
    CHECK(resolved(parse_deck(resolved(deck), deck.output + "/deck.txt")) == resolved(deck));

    CHECK(has(error_of("let a = 1\nlet a = 2"), "let a is already set (inputs/circle.deck:2)"));
    CHECK(has(error_of("let a = b\nlet b = 2"), "inputs/circle.deck:2: let a: `b`, column 1: unknown name `b`"));
    CHECK(has(error_of("let a = x"), "may name constants alone"));
    CHECK(has(error_of("let a = 1/0"), "is not finite"));
    CHECK(has(error_of("let sin = 1"), "inputs/circle.deck:2: the name `sin` has a meaning in formulas already"));
    CHECK(has(error_of("let a"), "expected `let NAME = NUMBER`"));
    CHECK(has(error_of("let 2a = 1"), "needs a name of letters"));
    CHECK(has(error_of("boundary inner = translate shift 0"), "`shift` is not a number"));
}

TEST_CASE("errors name the place and what to do") {
    CHECK(error_of("\n\ndegre = 3") == "inputs/circle.deck:4: unknown key `degre`: did you mean `degree`?");
    CHECK(error_of("degree = 12") == "inputs/circle.deck:2: degree = 12: expected integer in 0..7");
    CHECK(error_of("", {"degree=12"}) == "command line: degree = 12: expected integer in 0..7");
    CHECK(error_of("", {"Degree=1"}) == "command line: unknown key `Degree`: did you mean `degree`?");
    CHECK(error_of("degree = 2\ndegree = 2") ==
          "inputs/circle.deck:3: `degree` is already set (inputs/circle.deck:2): remove one of the two");
    CHECK(has(error_of("", {"degree=1", "degree=2"}), "already set (command line)"));
    CHECK(has(error_of("degree 3"), ":2: expected `key = value`, got `degree 3`"));
    CHECK(has(error_of("", {""}), "command line: expected `key = value`"));
    CHECK(has(error_of("= 3"), "unknown key ``"));
    CHECK(has(error_of("bundary inner = fixed"), "unknown key `bundary inner`: did you mean `boundary`"));
    CHECK(has(error_of("title = 5\" pipe"), ":2: a double quote is not closed"));
    CHECK(has(error_of("title = a \"b\" c"), "double quotes stand around the whole value"));
    CHECK(has(error_of("degree ="), "expected integer in 0..7"));
    CHECK(has(error_of(std::string("title = a\0b", 11)), ":2: control characters"));
    CHECK(has(error_of("title = a\rdegree = 2"), ":2: control characters"));
    CHECK(has(error_of("", {"title=a\ndegree=2"}), "command line: control characters"));
    CHECK(has(error_of("", {"title=a\n"}), "command line: control characters"));
}

TEST_CASE("a missing mesh is an error") {
    const auto message = [](const std::string& text) {
        try {
            parse_deck(text, "a.deck");
        } catch (const UsageError& error) {
            CHECK(error.exit_code == ExitCode::usage);
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(has(message(""), "a.deck: no mesh: add a line `mesh = FILE`"));
    CHECK(has(message("mesh = \"\""), "no mesh"));
    CHECK(has(message("mesh ="), "a.deck:1: mesh = : expected file"));
}

TEST_CASE("bad boundary lines") {
    CHECK(has(error_of("boundary inner"), ":2: expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary = fixed"), "expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary \"\" = fixed"), "expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary"), "expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary \"a\" fixed"), "expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary \"a\" b = fixed"), "expected `boundary NAME = MOTION`"));
    CHECK(has(error_of("boundary outer wall = fixed"), "`outer wall` has blanks: put it in double quotes"));
    CHECK(has(error_of("", {"boundary \"outer = fixed"}), "command line: expected `boundary NAME"));
    CHECK(has(error_of("boundary inner = translat 1 0"),
              ":2: boundary \"inner\": unknown motion `translat`: did you mean `translate`?"));
    CHECK(has(error_of("boundary inner ="), "boundary \"inner\": a step of the motion is empty"));
    CHECK(has(error_of("boundary a = fixed\nboundary a = fixed"),
              ":3: boundary \"a\" is already set (inputs/circle.deck:2)"));
    CHECK(has(error_of("", {"boundary a=fixed", "boundary a=fixed"}), "already set (command line)"));
}

TEST_CASE("bad expect lines") {
    CHECK(has(error_of("expect quality <= 1"), ":2: the summary has no quantity `quality`: did you mean "));
    CHECK(has(error_of("expect"), ":2: no comparison"));
    CHECK(has(error_of("expect relative_quality = 0.9"), "add a tolerance"));
    CHECK(has(error_of("expect nodes = 1\nexpect nodes = 2"),
              "`expect nodes = 1` is already set (inputs/circle.deck:2)"));
    CHECK(error_of("expect max_distortion <= 3\nexpect max_distortion >= 2") == "");
}

TEST_CASE("the resolved deck is the same deck") {
    const std::vector<std::string> samples = {
        "",
        "degree = 7\nrefine = 1\ntarget = nodal\nobjective = squared\ndelta = 1e-3\nweight_exponent = 0.5\n"
        "algorithm = literal\nmu0 = 300\nomega0 = 0.30000000000000004\nepsilon0 = 1e-300\nomega_star = 1e-6\n"
        "epsilon_star = 1e-12\nlength_scale = 1\nmax_al_iterations = 9\nmax_newton_iterations = 99\nsolver = cholesky\n"
        "forcing = fixed\nquadrature = 5\niterates = 3\nmax_seconds = 1.5\n"
        "wall = \"inner # 1\"\nthreads = 2\ntitle = \"  a # b \"\noutput = \"outputs/a b/#1\"\n"
        "boundary \"inner # 1\" = rotate 30 about 0.1 0.2; translate 8 0\nboundary outer = fixed\n"
        "boundary \"a=b\" = scale 2 3\nexpect status = converged\nexpect nodes = 841\n"
        "expect relative_quality = 0.9365 +- 0.0005\nexpect max_distortion <= 2.8\n"};
    for (const std::string& sample : samples) {
        const Deck deck = parsed(sample);
        const std::string text = resolved(deck);
        const Deck again = parse_deck(text, deck.output + "/resolved.deck");
        check_same(deck, again);
        CHECK(deck.method.omega0 == again.method.omega0);
        CHECK(deck.method.mu0 == again.method.mu0);
        CHECK(deck.length_scale == again.length_scale);
        CHECK(resolved(again) == text);
        for (const DeckKey& key : deck_keys()) CHECK(has(text, "\n" + key.name + " = "));
    }
}

TEST_CASE("the resolved deck finds the mesh from the output folder") {
    const auto mesh_line = [](const std::string& mesh, const std::string& output) {
        const std::string text = resolved(parse_deck("", "a.deck", {"mesh=" + mesh, "output=" + output}));
        const auto begin = text.find("\nmesh = ") + 8;
        return text.substr(begin, text.find('\n', begin) - begin);
    };
    const std::string here = std::filesystem::current_path().string();
    CHECK(mesh_line("inputs/a.msh", "outputs/a") == "../../inputs/a.msh");
    CHECK(mesh_line("outputs/a/a.msh", "outputs/a") == "a.msh");
    CHECK(mesh_line("../a.msh", "outputs") == "../../a.msh");
    CHECK(mesh_line("a.msh", ".") == "a.msh");
    CHECK(mesh_line("/data/a.msh", "outputs/a") == "/data/a.msh");
    CHECK(mesh_line("a.msh", "/results") == here + "/a.msh");
    CHECK(mesh_line("a.msh", "../results") == here + "/a.msh");
}

TEST_CASE("deck files") {
    const auto message = [](const std::string& path) {
        try {
            read_deck(path);
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const TemporaryFile good("almesh_deck_test.deck", "mesh = m/a.msh\ndegree = 2\n");
    const Deck deck = read_deck(good.path, {"degree=3"});
    CHECK(deck.degree == 3);
    CHECK(deck.name == "almesh_deck_test");
    CHECK(deck.mesh == (std::filesystem::path(deck.folder) / "m/a.msh").string());

    const TemporaryFile huge("almesh_deck_huge.deck", std::string(1000001, '\n'));
    CHECK(has(message(huge.path), "more than 1 MB"));
    const TemporaryFile just("almesh_deck_just.deck", "mesh = a" + std::string(1000000 - 8, '\n'));
    CHECK(message(just.path) == "");
    const TemporaryFile binary("almesh_deck_binary.deck", std::string("mesh = a\nMZ\x01\0\0\0", 15));
    CHECK(has(message(binary.path), ":2: control characters"));
    const TemporaryFile wide("almesh_deck_wide.deck", std::string("\xFF\xFEm\0e\0", 6));
    CHECK(has(message(wide.path), ":1: control characters"));
    CHECK(has(message("/nowhere/a.deck"), "/nowhere/a.deck: cannot be opened"));
    CHECK(has(message(std::filesystem::temp_directory_path().string()), "a folder"));
}

// Whatever comes in, the answer is a deck or a UsageError.
TEST_CASE("mangled decks never do worse than an error") {
    const std::string text =
        "mesh = \"a.msh\"\nboundary \"o w\" = rotate 3 axis 0 0 1 about 1 2 3; scale 2 # x\nexpect nodes = 3 +- 1\n"
        "mu0 = 300\n";
    const std::string alphabet = "\"#=;\n\r\t \\0a+-<>.9\x01";
    std::uint32_t state = 1;
    const auto next = [&](std::size_t n) { return (state = state * 1664525u + 1013904223u) / 65536 % n; };
    int read = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::string mangled = text;
        for (std::size_t k = 0, count = 1 + next(4); k < count; ++k) {
            const std::size_t at = next(mangled.size());
            if (next(3) == 0)
                mangled.erase(at, 1 + next(5));
            else
                mangled[at] = alphabet[next(alphabet.size())];
        }
        try {
            const Deck deck = parse_deck(mangled, "a.deck");
            check_same(deck, parse_deck(resolved(deck), deck.output + "/resolved.deck"));
            ++read;
        } catch (const UsageError&) {
        }
    }
    CHECK(read > 500);
}
