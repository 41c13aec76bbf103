#include "base/text.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

using namespace almesh;

TEST_CASE("trim, split and words") {
    CHECK(trim(" \t a b \r\n") == "a b");
    CHECK(trim("") == "");
    CHECK(trim(" \t ") == "");
    CHECK(split("a; b ;;c ", ';') == std::vector<std::string_view>{"a", "b", "", "c"});
    CHECK(split("", ';') == std::vector<std::string_view>{""});
    CHECK(split("a;", ';') == std::vector<std::string_view>{"a", ""});
    CHECK(words("  translate\t8  0 ") == std::vector<std::string_view>{"translate", "8", "0"});
    CHECK(words("  ").empty());
}

TEST_CASE("numbers are parsed strictly") {
    CHECK(parse_double("1e-8") == 1e-8);
    CHECK(parse_double("-.5") == -0.5);
    CHECK(parse_double("+3") == 3.0);
    CHECK(parse_double("5.") == 5.0);
    for (const char* bad : {"",    "+",   "-",   "+-1", "++1",  "1 ",       " 1",    "1x",     "1e",   "0x10",
                            "1,5", "1f3", "nan", "inf", "-inf", "infinity", "1e400", "1e-400", "auto", "1 2"})
        CHECK_MESSAGE(!parse_double(bad), bad);
    CHECK(parse_int("42") == 42);
    CHECK(parse_int("-7") == -7);
    CHECK(parse_int("+7") == 7);
    CHECK(parse_int("0", 0, 8) == 0);
    CHECK(parse_int("8", 0, 8) == 8);
    CHECK(!parse_int("9", 0, 8));
    CHECK(!parse_int("-1", 0, 8));
    for (const char* bad : {"", "1.0", "1e3", "99999999999", "3 ", "three", "0x1"}) CHECK_MESSAGE(!parse_int(bad), bad);
}

TEST_CASE("printed numbers come back to the same bits") {
    CHECK(to_text(0.1) == "0.1");
    CHECK(to_text(8) == "8");
    CHECK(to_text(-2.5) == "-2.5");
    CHECK(to_text(1e-16) == "1e-16");
    std::mt19937_64 random(7);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t bits = random();
        double value;
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) continue;
        const auto back = parse_double(to_text(value));
        REQUIRE(back);
        CHECK(std::memcmp(&*back, &value, sizeof value) == 0);
    }
    for (double value : {std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min(), -0.0})
        CHECK(std::signbit(*parse_double(to_text(value))) == std::signbit(value));
}

TEST_CASE("messages are put together from their parts") {
    const std::string name = "inner";
    CHECK(concat("node ", 12, " of ", name, std::string_view(": "), 0.25, " at ", -7LL) ==
          "node 12 of inner: 0.25 at -7");
    CHECK(counted(0, "face") == "0 faces");
    CHECK(counted(1, "face") == "1 face");
    CHECK(counted(2, "face") == "2 faces");
}

TEST_CASE("a place in its dimension and unit") {
    const double x[3] = {1.5, -2e-7, 1.0 / 3};
    CHECK(position_text(x, 2) == "(1.5, -2e-07)");
    CHECK(position_text(x, 3) == "(1.5, -2e-07, 0.333333)");
}

TEST_CASE("edit distance") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("kitten", "sitting") == 3);
    CHECK(edit_distance("degree", "degere") == 1);  // two neighbours swapped
    CHECK(edit_distance("omega0", "omega_0") == 1);
    const std::vector<std::string> some = {"mu0", "omega0", "omega_star", "epsilon0", "mesh", ""};
    for (const auto& a : some)
        for (const auto& b : some) {
            CHECK(edit_distance(a, b) == edit_distance(b, a));
            CHECK((edit_distance(a, b) == 0) == (a == b));
        }
}

TEST_CASE("nearest word") {
    const std::vector<std::string> keys = {"mesh", "degree", "refine", "target"};
    CHECK(nearest("degre", keys) == "degree");
    CHECK(nearest("MESH", keys) == "mesh");
    CHECK(nearest("erfine", keys) == "refine");
    CHECK(nearest("tree", {"three", "free"}) == "three");  // both at distance 1: the first
    CHECK(nearest("x", {}) == "");
    CHECK(did_you_mean("degre", keys) == ": did you mean `degree`?");
}

TEST_CASE("lines and tables") {
    CHECK(wrap("one two  three", 7) == std::vector<std::string>{"one two", "three"});
    CHECK(wrap("unbreakable x", 3) == std::vector<std::string>{"unbreakable", "x"});
    CHECK(wrap("", 10).empty());
    CHECK(table_row({"a", "b", "one two three"}, {4, 3, 7}) == "a   b  one two\n       three\n");
    CHECK(table_row({"abcdef", "x"}, {4, 3}) == "abcdef\n    x\n");
    CHECK(table_row({"a", ""}, {4, 3}) == "a   \n");
}

TEST_CASE("quotes") {
    CHECK(with_quotes("outer wall") == "\"outer wall\"");
    CHECK(without_quotes("\"outer wall\"") == "outer wall");
    CHECK(without_quotes("plain") == "plain");
    CHECK(without_quotes("\"\"") == "");
    CHECK(!without_quotes("\""));
    CHECK(!without_quotes("a\"b"));
    CHECK(!without_quotes("\"a\"b\""));
    for (const char* text : {"a\"b", "\"", "\"\"", "\"a\" \"", "a # \"b"})
        CHECK(without_quotes(quoted_where_needed(text, "#\"")) == text);
    CHECK(closing_quote("\"a\"\"b\" = c\"") == 5);
    CHECK(closing_quote("\"a\"\"") == std::string_view::npos);
}

TEST_CASE("bounds are printed down") {
    CHECK(rounded_down(0.123456, 4) == "0.1234");
    CHECK(rounded_down(0.99999, 4) == "0.9999");
    CHECK(rounded_down(-0.123456, 4) == "-0.1235");
    CHECK(rounded_down(1, 4) == "1");
    CHECK(rounded_down(0, 4) == "0");
    CHECK(rounded_down(9.9996e-7, 4) == "9.999e-07");
    CHECK(rounded_down(-std::numeric_limits<double>::infinity(), 4) == "-inf");
    for (double value = -3; value < 3; value += 0.000731) CHECK(parse_double(rounded_down(value, 3)) <= value);
}

TEST_CASE("a hash of a text") {
    CHECK(hash_of("") == "cbf29ce484222325");
    CHECK(hash_of("a") == "af63dc4c8601ec8c");  // the published test vectors of FNV-1a
    CHECK(hash_of("foobar") == "85944171f73967e8");
}
