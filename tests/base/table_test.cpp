#include "base/table.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace almesh;

TEST_CASE("numbers with some digits are those of printf") {
    CHECK(to_text(0.000123456, 3) == "0.000123");
    CHECK(to_text(1234567, 4) == "1.235e+06");
    CHECK(fixed(2.0 / 3, 2) == "0.67");
    CHECK(fixed(-0.0, 1) == "-0.0");
    CHECK(scientific(7.1554, 3) == "7.155e+00");
    CHECK(fixed(std::numeric_limits<double>::max(), 6).size() == 309 + 7);
    for (const double beyond : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
        CHECK(scientific(beyond, 2) == (beyond > 0 ? "inf" : "-inf"));
}

TEST_CASE("a CSV row: numbers with all digits, texts in quotes where they need them, sentences always") {
    CHECK(csv_row({3, 0.1, "a b", "", 1LL << 40}) == "3,0.1,a b,,1099511627776\n");
    CHECK(csv_row({"a,b", " a", "the \"a\"\nand b", sentence("")}) == "\"a,b\",\" a\",the 'a' and b,\"\"\n");
    CHECK(csv_row({sentence("all, \"a\"")}) == "\"all, 'a'\"\n");
}

TEST_CASE("JSON: numbers with all digits or as words, words escaped, members without a value left out") {
    const double inf = std::numeric_limits<double>::infinity();
    CHECK(json({3, 0.1, -inf, std::numeric_limits<double>::quiet_NaN(), 1e-300, 1LL << 40}).text ==
          "[3, 0.1, \"-inf\", \"nan\", 1e-300, 1099511627776]");
    const Named length = {"length", "", "m"}, word = {"word", ""};
    const Field none = {length, "none"}, digits = {word, "12"}, some = {length, "12"}, empty = {length, ""};
    CHECK(json({none, digits, some, empty}).text == "{\"length\": null, \"word\": \"12\", \"length\": 12}");
    CHECK(json({{"a", json({})}, {"b", json({{"c", "none"}})}}).text == "{\"a\": [], \"b\": {\"c\": \"none\"}}");
    CHECK(json({"\"\\/", "\b\f\n\r\t", std::string(1, '\0'), "\x1F\x7F"}).text ==
          "[\"\\\"\\\\/\", \"\\u0008\\u000c\\u000a\\u000d\\u0009\", \"\\u0000\", \"\\u001f\x7F\"]");
}

TEST_CASE("JSON: characters of UTF-8 stay, each byte of what is none becomes U+FFFD") {
    for (const std::string good : {"\xC2\x80", "\u00E9", "\u07FF", "\u0800", "\uD7FF", "\uE000", "\uFFFF", "\U00010000",
                                   "\U0010FFFF"})
        CHECK(json({"a" + good + "b"}).text == "[\"a" + good + "b\"]");
    for (const std::string bad : {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC3", "\xE0\x9F\xBF", "\xE2\x82",
                                  "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF0\x9F\x98", "\xF5\x80\x80\x80",
                                  "\xFF"}) {
        std::string marks;
        for (std::size_t k = 0; k < bad.size(); ++k) marks += "\uFFFD";
        CHECK(json({bad + "b"}).text == "[\"" + marks + "b\"]");
        CHECK(json({bad}).text == "[\"" + marks + "\"]");
    }
}

TEST_CASE("output: without anyone who reads objects none is written, else each is a line, at once") {
    std::FILE *const text = std::tmpfile(), *const lines = std::tmpfile();
    const Output people(text), both(text, lines);
    people.tell("a", {{"b", 1}});
    both.tell("a", {{"b", 1}});
    both.add({{"c", 2}});
    Output(both).add({{"d", 3}});  // copies share the last object
    both.tell("end", *both.end);
    CHECK(std::ftell(text) == 0);
    std::rewind(lines);
    char read[100] = {};
    CHECK(std::fread(read, 1, sizeof read, lines) > 0);
    CHECK(std::string(read) == "{\"event\": \"a\", \"b\": 1}\n{\"event\": \"end\", \"c\": 2, \"d\": 3}\n");
    std::fclose(text);
    std::fclose(lines);
}

TEST_CASE("columns of a table stand below each other, the first one as wide as its longest cell") {
    const TextTable table{{{"name", -4}, {"x", 5}, {"note"}}};
    CHECK(table.heading() == "name      x  note\n");
    CHECK(table.line({"a", 12}) == "a        12\n");
    CHECK(table.line({"a", 12, "b"}, ", c") == "a        12  b, c\n");
    CHECK(table.text({{"a", 1, "-"}, {"longer", 123456, ""}}) ==
          "name        x  note\n"
          "a           1  -\n"
          "longer  123456  \n");
}
