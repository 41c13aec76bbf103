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
