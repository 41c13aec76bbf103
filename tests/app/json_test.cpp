// --json: objects for programs, one on each line. tests/json_lines.py, which shares nothing with the source, reads them
// by outputs/schema.json and compares them with the files of results.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <limits>

#include "problem/summary.hpp"
#include "report/iteration_table.hpp"
#include "support/child.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

const std::string good = ": as in outputs/schema.json";

// What the script says of the lines. arguments: its own.
std::string judged(const std::string& lines, const std::string& arguments = "") {
    const TemporaryFolder folder;
    const std::string file = folder.write("lines", lines);
    std::FILE* const script = popen(concat("tests/json_lines.py ", arguments, " < ", file, " 2>&1").c_str(), "r");
    REQUIRE(script);
    std::string said;
    for (int c; (c = std::fgetc(script)) != EOF;) said += static_cast<char>(c);
    CHECK((pclose(script) == 0) == has(said, good));
    return said;
}

// Of the command with --json at the place `at` among its arguments.
Outcome json_of(std::vector<std::string> arguments, std::size_t at = 0) {
    arguments.insert(arguments.begin() + static_cast<std::ptrdiff_t>(at), "--json");
    return almesh_with(arguments);
}

std::string last_line(const std::string& text) {
    const auto end = text.rfind('\n');
    return text.substr(text.rfind('\n', end - 1) + 1, end - text.rfind('\n', end - 1) - 1);
}

// Numbers before an `s` that ends a word become T, without the blanks around them.
std::string without_times(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t first = i, last, end;
        while (first < text.size() && text[first] == ' ') ++first;
        last = std::min(text.find_first_not_of("0123456789.", first), text.size());
        end = last < text.size() && text[last] == ' ' ? last + 1 : last;
        const bool is_time = last > first && end < text.size() && text[end] == 's' &&
                             (end + 1 == text.size() || !std::isalnum(static_cast<unsigned char>(text[end + 1])));
        if (is_time) result += " T";
        else result += text.substr(i, std::max(last, i + 1) - i);
        i = is_time ? end + 1 : std::max(last, i + 1);
    }
    return result;
}

std::string inner_named(const std::string& name) {
    std::string text = msh_of(ring_mesh(12, 3, 6));
    const auto at = text.find("\"inner\"");
    return text.replace(at + 1, 5, name);
}

}  // namespace

TEST_CASE("--json, anywhere: a run's iterations and its end with the digits of its files; the text goes to stderr") {
    const RingDeck ring;
    const Outcome text = ring.run({"degree=2"});
    for (const std::size_t at : {0, 1, 2}) {
        const Outcome outcome = json_of({ring.deck, "degree=2"}, at);
        CHECK(outcome.code == text.code);
        CHECK(without_times(outcome.error) == without_times(text.out));
        CHECK(has(judged(outcome.out, ring.output),
                  " 1 end: as in outputs/schema.json, numbers as in summary.txt, history.csv"));
        CHECK(has(last_line(outcome.out), "\"arguments\": [\"" + ring.deck + "\", \"degree=2\"]"));
    }
    CHECK(!has(text.out, "{"));
    CHECK(text.error == "");
}

TEST_CASE("--json: a run that is cut short, one with a false expectation, and volumes") {
    const RingDeck ring;
    const Outcome cut = json_of({ring.deck, "max_al_iterations=1", "boundary inner=translate 2.5 0"});
    CHECK(cut.code == 3);
    CHECK(has(last_line(cut.out),
              "\"exit_code\": 3, \"output\": \"" + ring.output + "\", \"status\": \"max_al_iterations\""));
    CHECK(has(last_line(cut.out), "\"diagnosis\": \"off_target\""));
    CHECK(has(judged(cut.out, ring.output), good));
    const Outcome expects = json_of({ring.deck, "expect nodes = 1"});
    CHECK(expects.code == 5);
    CHECK(has(last_line(expects.out), "\"exit_code\": 5"));
    CHECK(has(judged(expects.out, ring.output), good));
}

TEST_CASE("--json: what is wrong is the last object, and a sentence on stderr as before") {
    const RingDeck ring;
    const std::vector<std::vector<std::string>> wrong = {
        {ring.deck, "degre=2"}, {ring.deck, "de\x01\xFF\"\ngree=2"}, {ring.deck, "boundary inner=translate 9 0"},
        {"none.deck"}, {"--nothing"}, {"quality"}, {"info", ring.deck}, {ring.folder.path("ring.msh")}};
    for (const auto& arguments : wrong) {
        const Outcome text = almesh_with(arguments), outcome = json_of(arguments, 1);
        CHECK(outcome.code == text.code);
        CHECK((outcome.code == 1 || outcome.code == 2));
        CHECK(judged(outcome.out) == "1 end: as in outputs/schema.json\n");
        CHECK(has(outcome.out, concat("\"exit_code\": ", outcome.code, ", \"error\": \"")));
        CHECK(outcome.error == text.error);
    }
    const Outcome coupled = json_of({ring.deck, "frames=-"});
    CHECK(coupled.code == 1);
    CHECK(has(coupled.out, "\"error\": \"frames = -: its answers are lines of their own: without --json\""));
    CHECK(has(json_of({ring.deck, "degre=2"}).out, "\"error\": \"command line: unknown key `degre`"));
    CHECK(has(json_of({}).out, "\"arguments\": []"));
    for (const char* about : {"--help", "--keys", "--version"}) {
        const Outcome outcome = json_of({about});
        CHECK(outcome.code == 0);
        CHECK(outcome.error == almesh_with({about}).out);
        CHECK(judged(outcome.out) == "1 end: as in outputs/schema.json\n");
    }
}

TEST_CASE("--json: quality, info and improve") {
    const RingDeck ring;
    REQUIRE(ring.run().code == 0);
    const std::string mesh = ring.output + "/final.msh", before = "before=" + ring.folder.path("ring.msh"),
                      other = ring.folder.path("improved");
    const std::vector<std::vector<std::string>> commands = {
        {"quality", mesh, before}, {"quality", mesh}, {"info", mesh}, {"improve", mesh, "output=" + other}};
    for (const std::vector<std::string>& arguments : commands) {
        const Outcome text = almesh_with(arguments), outcome = json_of(arguments, 1);
        CHECK(outcome.code == 0);
        CHECK(without_times(outcome.error) == without_times(text.out));
        CHECK(has(judged(outcome.out, arguments[0] == "improve" ? other : ""), good));
    }
    const std::string quality = json_of({"quality", mesh, before}).out, info = json_of({"info", mesh}).out;
    const auto summary = summary_of(ring.output);
    CHECK(has(quality, "\"certified_bound\": 1,"));
    const std::string proof = ring.folder.path("ring.proof"), proved = json_of({"quality", mesh, "proof=" + proof}).out;
    CHECK(has(proved, "\"proof\": \"" + proof + "\"}"));
    CHECK(has(judged(proved), good));
    const std::string before_proof = text_of(mesh);
    CHECK(has(almesh_with({"quality", mesh, "proof=" + mesh}).error, "which the proof would overwrite"));
    CHECK(text_of(mesh) == before_proof);
    const std::string run = json_of({ring.deck, "proof=yes"}).out;
    CHECK(has(run, "\"proof\": \"" + ring.output + "/final.proof\""));
    CHECK(has(judged(run), good));
    CHECK(has(quality, "\"certified_valid\": \"yes\", \"certified_injective\": \"yes\""));
    CHECK(has(quality, "\"distances\": [{\"boundary\": \"inner\", \"boundary_distance\": "));
    CHECK(has(info, "{\"kind\": \"Boundaries\", \"group\": \"inner\", \"cells\": 12, \"nodes\": 12, \"box\": ["));
    const auto at = quality.find("\"scaled_jacobian_after_least\": ") + 31;
    const double least = parse_double(quality.substr(at, quality.find(',', at) - at)).value();
    CHECK(rounded_down(number(summary, "scaled_jacobian"), 4) == rounded_down(least, 4));
}

TEST_CASE("--json: derivatives by constants") {
    const RingDeck ring;
    std::string rows = "node,x,y\n";
    const Mesh mesh = mesh_of(ring.folder.path("ring.msh"));
    for (const long long id : mesh.file.node_id) rows += concat(id, ",1,2\n");
    const std::string J = ring.folder.write("J.csv", rows);
    const Outcome adjoint = json_of({"adjoint", ring.deck, J, "let a=1", "boundary inner=translate \"2*a\" 0"}, 3);
    CHECK(adjoint.code == 0);
    CHECK(has(judged(adjoint.out, ring.output), good));
    const std::string slope = csv_rows(text_of(ring.output + "/adjoint-constants.csv")).at(1).at(2);
    CHECK(has(last_line(adjoint.out),
              "\"derivatives\": [{\"function\": \"J\", \"constant\": \"a\", \"slope\": " + slope + "}]"));
    const Outcome tangent = json_of({"tangent", ring.deck, "let a=1", "boundary inner=translate \"2*a\" 0"}, 1);
    CHECK(tangent.code == 0);
    CHECK(has(judged(tangent.out, ring.output), good));
    const Outcome none = json_of({"adjoint", ring.deck, J, "let a=1", "max_al_iterations=1"});
    CHECK(none.code == 3);
    CHECK(has(last_line(none.out), "\"error\": \"" + ring.deck + ": no derivative: the run did not converge\""));
    CHECK(has(judged(none.out, ring.output), good));
}

TEST_CASE("--json: an object for each frame, also for one that ends the run") {
    const RingDeck ring;
    const Outcome three = json_of({ring.deck, "boundary inner=translate \"2*t\" 0", "frames=0, 0.5, 1"});
    CHECK(three.code == 0);
    CHECK(judged(three.out, ring.output) == "3 frame, 1 end: as in outputs/schema.json, numbers as in frames.csv\n");
    CHECK(has(three.out, "\"mesh\": \"" + ring.output + "/frame-0003.msh\"}"));
    const Outcome folds = json_of({ring.deck, "boundary inner=translate \"9*t\" 0", "frames=0, 0.2, 1"});
    CHECK(folds.code == 2);
    CHECK(judged(folds.out, ring.output) == "3 frame, 1 end: as in outputs/schema.json, numbers as in frames.csv\n");
}

TEST_CASE("--json: an object for each run of a sweep when it ends, for those of before at first; --run and --collect") {
    const RingDeck ring;
    const std::vector<std::string> sweep = {"sweep", ring.deck, "sweep mu0=10, 100", "sweep degree=1:1:2"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), sweep.begin(), sweep.end());
        return json_of(more, 2);
    };
    const Outcome task = with({"--run", "1/2"});
    CHECK(task.code == 0);
    CHECK(judged(task.out) == "2 run, 1 end: as in outputs/schema.json\n");
    const Outcome half = with({"--collect"});
    CHECK(half.code == 3);
    CHECK(judged(half.out, ring.output) == "2 run, 1 end: as in outputs/schema.json, numbers as in sweep.csv\n");
    CHECK(has(last_line(half.out), "\"runs\": 4, \"missing_runs\": 2"));
    const std::string whole = "4 run, 1 end: as in outputs/schema.json, numbers as in sweep.csv\n";
    CHECK(judged(with({}).out, ring.output) == whole);
    CHECK(judged(with({"--collect"}).out, ring.output) == whole);
    CHECK(has(with({"--collect"}).out,
              "\"results\": {\"exit_code\": 0, \"values\": {\"mu0\": \"100\", \"degree\": \"2\"}, "));
    const Outcome folds = json_of({"sweep", ring.deck, "sweep a=1, 9", "let a=1", "boundary inner=translate \"a\" 0"});
    CHECK(folds.code == 2);
    CHECK(judged(folds.out, ring.output) == "2 run, 1 end: as in outputs/schema.json, numbers as in sweep.csv\n");
}

TEST_CASE("--json: names of boundaries with quotes, backslashes, tabs and any bytes") {
    const TemporaryFolder folder;
    for (const auto& [name, written] : std::vector<std::pair<std::string, std::string>>{
             {"a\\b", "a\\\\b"}, {"a\tb", "a\\u0009b"}, {"a\"b", "a\\\"b"}, {"ä\U0001F600", "ä\U0001F600"},
             {"a\xFF\xC3" "b", "a\uFFFD\uFFFD" "b"}, {"\xC0\xAF\xED\xA0\x80", "\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD"}}) {
        const std::string mesh = folder.write("ring.msh", inner_named(name));
        const Outcome outcome = json_of({"info", mesh});
        CHECK(outcome.code == 0);
        CHECK(judged(outcome.out) == "1 end: as in outputs/schema.json\n");
        CHECK(has(outcome.out, "\"group\": \"" + written + "\""));
    }
}

TEST_CASE("--json: numbers that are none") {
    std::FILE *const lines = std::tmpfile(), *const text = std::tmpfile();
    IterationTable report(Output(text, lines), {2, 1}, "id");
    AlIteration row;
    row.iteration = 1;
    row.energy = std::numeric_limits<double>::infinity();
    row.gradient_norm = std::numeric_limits<double>::quiet_NaN();
    row.constraint_norm = -row.energy;
    report.add(row);
    std::fclose(text);
    const std::string said = take_contents(lines);
    CHECK(judged(said, "--open") == "1 iteration: as in outputs/schema.json\n");
    CHECK(has(said, "\"energy\": \"inf\", \"gradient_norm\": \"nan\", \"constraint_norm\": \"-inf\""));
}

TEST_CASE("--json: what a run has printed when it is killed are lines of JSON") {
    const RingDeck ring(ring_mesh(48, 12, 6));
    for (const int lines : {1, 3, 8}) {
        const std::string file = ring.folder.path("lines.json");
        std::FILE* const nowhere = std::fopen("/dev/null", "w");
        std::remove(file.c_str());
        const auto run = [&] {
            return command_line({"--json", ring.deck, "refine=1"}, std::fopen(file.c_str(), "w"), nowhere);
        };
        in_child(run, [&](pid_t child) {
            std::string text;
            for (int k = 0; std::count(text.begin(), text.end(), '\n') < lines && k < 20000; ++k, usleep(200))
                text = text_of(file);
            kill(child, SIGKILL);
        });
        std::fclose(nowhere);
        CHECK(pieces(text_of(file), '\n').size() >= lines);
        CHECK(has(judged(text_of(file), "--open"), good));
    }
}

TEST_CASE("--json: nobody reads it: a run goes on, quality and info end with code 2") {
    std::signal(SIGPIPE, SIG_IGN);
    const RingDeck ring;
    const std::string mesh = ring.folder.path("ring.msh");
    const std::vector<std::vector<std::string>> commands = {{ring.deck}, {"quality", mesh}, {"info", mesh}};
    for (const auto& arguments : commands) {
        const int code = arguments.size() == 1 ? 0 : 2;
        std::FILE *const full = std::fopen("/dev/full", "w"), *const error = std::tmpfile();
        if (!full) return;
        std::vector<std::string> all = arguments;
        all.emplace_back("--json");
        CHECK(command_line(all, full, error) == code);
        CHECK(has(take_contents(error), "almesh: cannot write the output") == (code == 2));
        std::fclose(full);
    }
    CHECK(summary_of(ring.output).at("status") == "converged");
    std::signal(SIGPIPE, SIG_DFL);
}

TEST_CASE("the schema has every quantity and column with the meaning that --keys tells, and its unit") {
    const std::string schema = text_of("outputs/schema.json");
    std::vector<Named> rows = summary_quantities();
    for (const Named& column : history_columns()) rows.push_back(column);
    for (const Named& row : rows) {
        const std::string start = concat("        \"", row.name, "\": {\"description\": \"", row.meaning, "\", ");
        const std::string end = *row.unit ? concat("\"unit\": \"", row.unit, "\", ") : "\"type\": \"string\"}";
        CHECK_MESSAGE(has(schema, start + end), row.name);
    }
}

TEST_CASE("the script that judges lines refuses what is no JSON, not in the schema, or not what the files have") {
    const RingDeck ring;
    const std::string lines = json_of({ring.deck}).out, end = last_line(lines) + "\n";
    REQUIRE(has(judged(lines, ring.output), good));
    const auto with = [&](const std::string& old, const std::string& other) {
        std::string text = lines;
        REQUIRE(has(text, old));
        return text.replace(text.rfind(old), old.size(), other);
    };
    const std::string nodes = "\"nodes\": " + summary_of(ring.output).at("nodes");
    CHECK(!has(judged(with(nodes, "\"nodes\": 7"), ring.output), good));
    for (const std::string& other : {with(nodes, nodes + ".5"), with(nodes, "\"nodes\": NaN"),
                                     with(nodes, nodes + ", " + nodes), with("\"nodes\"", "\"knots\""),
                                     with("\"yes\"", "yes"), with("converged", "\xFF"), with("converged", "a\tb"),
                                     lines + end, lines.substr(0, lines.size() - 1), with(end, ""), end + lines})
        CHECK(!has(judged(other), good));
}
