#include "io/text_scanner.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "base/error.hpp"

using namespace almesh;

namespace {

const std::string path = "a.txt";

void check_finds(const std::vector<long long>& ids, const std::vector<long long>& others) {
    IdIndex index(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) CHECK(index.insert(ids[i], static_cast<int>(i)) == -1);
    for (std::size_t i = 0; i < ids.size(); ++i) CHECK(index.find(ids[i]) == static_cast<int>(i));
    for (long long id : others) CHECK(index.find(id) == -1);
}

}  // namespace

TEST_CASE("records are found over blank lines, CR LF and blanks, with their line") {
    TextScanner in("\n  \r\n 7 \t -3\r\n\n+2.5e-1\n\nlast words \t", path);
    REQUIRE(in.next_line());
    CHECK(in.line == 3);
    CHECK(in.integer("a number", 0, 10) == 7);
    CHECK(in.small_integer("a number") == -3);
    in.end_of_line();
    REQUIRE(in.next_line());
    CHECK(in.line == 5);
    CHECK(in.real("a number") == 0.25);
    REQUIRE(in.next_line());
    CHECK(in.rest_of_line() == "last words");
    CHECK(in.line == 7);
    CHECK_FALSE(in.next_line());
}

TEST_CASE("numbers stop at the line end") {
    TextScanner in("1\n2", path);
    CHECK(in.integer("x", 0, 9) == 1);
    CHECK_THROWS_WITH_AS(in.integer("x", 0, 9), "a.txt:1: expected x, got the end of the line", InputError);
    CHECK_THROWS_WITH_AS(in.real("x"), "a.txt:1: expected x, got the end of the line", InputError);
}

TEST_CASE("what is no number is shown") {
    const auto integer_error = [](const char* text, const char* message) {
        TextScanner in(text, path);
        CHECK_THROWS_WITH_AS(in.integer("a tag", 1, 100), message, InputError);
    };
    integer_error("x7", "a.txt:1: expected a tag, got `x7`");
    integer_error("7.5", "a.txt:1: expected a tag, got `7.5`");
    integer_error("101", "a.txt:1: a tag `101` is out of range");
    integer_error("0", "a.txt:1: a tag `0` is out of range");
    integer_error("99999999999999999999", "a.txt:1: a tag `99999999999999999999` is out of range");
    const auto real_error = [](const char* text, const char* message) {
        TextScanner in(text, path);
        CHECK_THROWS_WITH_AS(in.real("x"), message, InputError);
    };
    real_error("1.0F+00", "a.txt:1: expected x, got `1.0F+00`");
    real_error("+", "a.txt:1: expected x, got `+`");
    real_error("nan", "a.txt:1: x `nan` is not a finite number");
    real_error("-inf", "a.txt:1: x `-inf` is not a finite number");
    real_error("1e400", "a.txt:1: x `1e400` is not a finite number");
}

TEST_CASE("tiny numbers are numbers") {
    TextScanner in("1e-400 4.9406564584124654e-324", path);
    CHECK(in.real("x") == 0);
    CHECK(in.real("x") == 5e-324);
}

TEST_CASE("what is left in a line, and the end of an empty text") {
    TextScanner in("1 2", path);
    in.integer("x", 0, 9);
    CHECK_THROWS_WITH_AS(in.end_of_line(), "a.txt:1: expected the end of the line, got `2`", InputError);
    TextScanner empty("", path);
    CHECK_FALSE(empty.next_line());
    CHECK(empty.rest_of_line() == "");
}

TEST_CASE("ids are found, dense or sparse, in any order, and no others") {
    constexpr long long low = std::numeric_limits<long long>::min(), high = std::numeric_limits<long long>::max();
    check_finds({}, {0, 1, low, high});
    check_finds({5}, {4, 6, low, high});
    check_finds({1, 2, 3, 7}, {0, 4, 8, -1, high});
    check_finds({3, 1, 2}, {0, 4});
    check_finds({high, low, 0}, {1, -1, high - 1});
    check_finds({1000000, 1}, {2, 999999, 0});
}

TEST_CASE("an id that is there already keeps its index, which is told") {
    IdIndex index(2);
    for (const long long id : {3LL, 3000000000LL}) {
        CHECK(index.insert(id, 7) == -1);
        CHECK(index.insert(id, 8) == 7);
        CHECK(index.find(id) == 7);
    }
}
