#include "problem/summary.hpp"

#include <doctest/doctest.h>

#include "base/error.hpp"

using namespace almesh;

namespace {

const Summary summary = {{"status", "converged"},        {"nodes", "841"},          {"relative_quality", "0.93653"},
                         {"constraint_norm", "1.8e-08"}, {"max_distortion", "inf"}, {"certified_valid", "yes"}};

bool holds(const char* text) { return check(parse_expectation(text), summary).holds; }

std::string error_of(const char* text) {
    try {
        parse_expectation(text);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("expectations are compared with the summary") {
    CHECK(holds("status = converged"));
    CHECK(!holds("status = max_iterations"));
    CHECK(holds("certified_valid = yes"));
    CHECK(holds("nodes = 841"));
    CHECK(!holds("nodes = 842"));
    CHECK(holds("nodes = 850 +- 10"));
    CHECK(holds("nodes >= 841"));
    CHECK(!holds("nodes >= 842"));
    CHECK(holds("constraint_norm <= 1e-7"));
    CHECK(!holds("constraint_norm <= 1e-8"));
    CHECK(holds("constraint_norm <= 1.8e-8"));
    CHECK(holds("relative_quality = 0.9365 +- 0.0005"));
    CHECK(!holds("relative_quality = 0.926 +- 0.001"));
    CHECK(holds("relative_quality=0.9365+-5e-4"));
}

TEST_CASE("a difference of exactly the tolerance holds") {
    const Expectation expectation = parse_expectation("relative_quality = 0.9365 +- 0.0005");
    CHECK(check(expectation, {{"relative_quality", "0.937"}}).holds);
    CHECK(check(expectation, {{"relative_quality", "0.936"}}).holds);
    CHECK(!check(expectation, {{"relative_quality", "0.93700001"}}).holds);
}

TEST_CASE("what is no number, or missing, does not hold") {
    CHECK(!holds("max_distortion >= 1"));
    CHECK(!holds("max_distortion <= 1e300"));
    CHECK(!holds("degree = 1"));
    CHECK(check(parse_expectation("degree = 1"), summary).text == "expected degree = 1, got nothing: fails");
}

TEST_CASE("the result says what was expected and what came") {
    CHECK(check(parse_expectation("relative_quality = 0.9365 +- 0.0005"), summary).text ==
          "expected relative_quality = 0.9365 +- 0.0005, got 0.93653: holds");
    CHECK(check(parse_expectation("nodes <= 100"), summary).text == "expected nodes <= 100, got 841: fails");
}

TEST_CASE("a file of expectations has a row for each, in their order") {
    CHECK(expectations_csv({}, summary) == "quantity,expected,got,holds,run\n");
    CHECK(expectations_csv({parse_expectation("relative_quality = 0.9365 +- 0.0005"),
                            parse_expectation("nodes <= 100"), parse_expectation("degree = 1")},
                           summary) ==
          "quantity,expected,got,holds,run\n"
          "relative_quality,= 0.9365 +- 0.0005,0.93653,yes,\n"
          "nodes,<= 100,841,no,\n"
          "degree,= 1,nothing,no,\n");
}

TEST_CASE("text of an expectation reads back") {
    for (const char* text : {"status = converged", "nodes = 841", "relative_quality = 0.9365 +- 0.0005",
                             "max_distortion <= 2.8", "certified_bound >= 1e-3"})
        CHECK(to_string(parse_expectation(text)) == text);
    CHECK(to_string(parse_expectation("nodes=841")) == "nodes = 841");
}

TEST_CASE("bad expectations are refused") {
    CHECK(has(error_of("relativ_quality = 1 +- 1"), "did you mean `relative_quality`"));
    CHECK(has(error_of("relative_quality"), "no comparison"));
    CHECK(has(error_of("relative_quality < 1"), "`<` is no comparison"));
    CHECK(has(error_of("relative_quality == 1 +- 1"), "`==` is no comparison"));
    CHECK(has(error_of("relative_quality = 0.9"), "add a tolerance, `= 0.9 +- TOLERANCE`"));
    CHECK(has(error_of("relative_quality = 0.9 +- 0"), "+- needs a number > 0"));
    CHECK(has(error_of("relative_quality = 0.9 +- x"), "+- needs a number > 0"));
    CHECK(has(error_of("relative_quality <= 0.9 +- 0.1"), "+- goes with = only"));
    CHECK(has(error_of("relative_quality = good +- 0.1"), "`good` is not a number"));
    CHECK(has(error_of("nodes = many"), "`many` is not a number"));
    CHECK(has(error_of("nodes ="), "one value is needed"));
    CHECK(has(error_of("nodes = 1 2"), "one value is needed"));
    CHECK(has(error_of("status = not converged"), "one value is needed"));
    CHECK(has(error_of("status <= converged"), "is a word"));
    CHECK(has(error_of("status = converged +- 1"), "is a word"));
    CHECK(has(error_of("= 3"), "no quantity ``"));
}
