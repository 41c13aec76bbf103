#include "deck/deck.hpp"

#include <doctest/doctest.h>

#include <sstream>

#include "base/error.hpp"
#include "report/iteration_table.hpp"

using namespace almesh;

namespace {

// The value after setting, or the message.
std::string result_of(const char* name, const char* text) {
    Deck deck;
    try {
        set_value(deck, *find_row(deck_keys(), name), text);
        return find_row(deck_keys(), name)->value.text(deck);
    } catch (const UsageError& error) {
        return error.what();
    }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("every default is legal and prints to itself") {
    const Deck defaults;
    for (const DeckKey& key : deck_keys()) {
        Deck deck;
        const std::string text = key.value.text(defaults);
        REQUIRE_NOTHROW(set_value(deck, key, text));
        CHECK(key.value.text(deck) == text);
        CHECK(find_row(deck_keys(), key.name) == &key);
    }
    CHECK(find_row(deck_keys(), "nothing") == nullptr);
}

TEST_CASE("legal ranges end where they should") {
    struct Ends {
        const char *key, *lowest, *highest, *below, *above;
    };
    for (const Ends& e :
         {Ends{"degree", "0", "7", "-1", "8"}, Ends{"refine", "0", "8", "-1", "9"},
          Ends{"weight_exponent", "0", "1", "-1e-9", "1.0001"}, Ends{"max_al_iterations", "1", "1000", "0", "1001"},
          Ends{"max_newton_iterations", "1", "100000", "0", "100001"},
          Ends{"min_certified_bound", "0", "0.5", "-1", "0.51"}, Ends{"quadrature", "0", "40", "-1", "41"},
          Ends{"iterates", "0", "1000000", "-1", "1000001"},
          Ends{"threads", "0", "1024", "-1", "1025"},
          Ends{"max_seconds", "0", "1e+09", "-1", "1.1e9"}}) {
        CHECK(result_of(e.key, e.lowest) == e.lowest);
        CHECK(result_of(e.key, e.highest) == e.highest);
        CHECK(has(result_of(e.key, e.below), ": expected "));
        CHECK(has(result_of(e.key, e.above), ": expected "));
    }
    CHECK(result_of("delta", "0") == "0");
    CHECK(result_of("delta", "-1") == "delta = -1: expected number >= 0");
    for (const char* key : {"mu0", "omega0", "epsilon0", "omega_star", "epsilon_star"}) {
        CHECK(result_of(key, "1e-300") == "1e-300");
        CHECK(result_of(key, "0") == key + std::string(" = 0: expected number > 0"));
        CHECK(has(result_of(key, "auto"), "expected number > 0"));
    }
    CHECK(result_of("length_scale", "auto") == "auto");
    CHECK(result_of("length_scale", "300") == "300");
    CHECK(result_of("length_scale", "0") == "length_scale = 0: expected auto or number > 0");
}

TEST_CASE("choices, by their words only") {
    Deck deck;
    set_value(deck, *find_row(deck_keys(), "target"), "nodal");
    set_value(deck, *find_row(deck_keys(), "objective"), "squared");
    set_value(deck, *find_row(deck_keys(), "algorithm"), "literal");
    set_value(deck, *find_row(deck_keys(), "solver"), "gmres");
    CHECK(deck.target == TargetKind::nodal);
    CHECK(deck.distortion.objective == Objective::squared);
    CHECK(deck.method.algorithm == Algorithm::literal);
    CHECK(deck.linear.kind == SolverKind::gmres);
    set_value(deck, *find_row(deck_keys(), "objective"), "size_shape");
    CHECK(deck.distortion.objective == Objective::size_shape);
    for (const char* word : {"auto", "cg", "gmres", "cholesky"}) CHECK(result_of("solver", word) == word);
    for (const char* word : {"auto", "fixed"}) CHECK(result_of("forcing", word) == word);
    for (const char* word : {"adaptive", "paper", "literal"}) CHECK(result_of("algorithm", word) == word);
    for (const char* word : {"squared", "deviation", "size_shape"}) CHECK(result_of("objective", word) == word);
    CHECK(result_of("target", "Nodal") == "target = Nodal: expected nodal | least_squares: did you mean `nodal`?");
    CHECK(has(result_of("solver", ""), "expected auto | cg | gmres | cholesky"));
}

TEST_CASE("text values and their quotes") {
    CHECK(result_of("title", "Circle, section 4.1") == "Circle, section 4.1");
    CHECK(result_of("title", "\"run #3\"") == "\"run #3\"");
    CHECK(result_of("title", "\" x\"") == "\" x\"");
    CHECK(result_of("title", "\"\"") == "\"\"");
    CHECK(has(result_of("title", ""), "expected text (nothing is written"));
    CHECK(has(result_of("title", "5\" pipe"), "double quotes stand around"));
}

TEST_CASE("numbers with garbage are refused with what is legal") {
    CHECK(result_of("degree", "4.0") == "degree = 4.0: expected integer in 0..7");
    CHECK(has(result_of("degree", "four"), "expected integer in 0..7"));
    CHECK(has(result_of("degree", "99999999999999"), "expected integer in 0..7"));
    CHECK(has(result_of("omega0", "1e-3x"), "expected number > 0"));
    CHECK(has(result_of("omega0", "inf"), "expected number > 0"));
    CHECK(has(result_of("omega0", "\"1\""), "expected number > 0"));
    CHECK(result_of("min_certified_bound", "1") == "min_certified_bound = 1: expected number in 0..0.5");
}

TEST_CASE("the table of keys lists everything within 100 columns") {
    const std::string table = keys_table(history_columns());
    for (const DeckKey& key : deck_keys()) {
        CHECK(has("\n" + table, "\n" + key.name + " "));
        CHECK(has(table, key.value.legal));
    }
    for (const char* word : {"\nboundary NAME", "\nexpect QUANTITY", "\ncylinder PX", "\nilu_shift"})
        CHECK(has(table, word));
    for (const Named& quantity : summary_quantities()) CHECK(has(table, std::string("\n") + quantity.name + " "));
    std::istringstream lines(table);
    std::size_t longest = 0;
    for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
    CHECK(longest <= 100);
}
