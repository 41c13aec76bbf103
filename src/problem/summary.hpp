// summary.txt, one `key = value` line per quantity, and the `expect` lines of a deck: statements about these
// quantities, checked at the end of the run.
//
//   expect status = converged
//   expect relative_quality = 0.9365 +- 0.0005
//   expect max_distortion <= 2.8
//
// A decimal number is compared with = and a tolerance, a count or a word with = alone. Name, meaning, unit and value
// of every quantity: one table in summary.cpp.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/table.hpp"

namespace almesh {

struct Problem;
struct Solution;

using Summary = Fields;  // in the order of summary.txt

Summary summarise(const Problem& problem, const Solution& solution);

std::vector<Named> summary_quantities();  // in the same order, for the list of keys

struct Expectation {
    std::string quantity;
    std::string relation;  // <=, >= or =
    std::string value;     // the number or word as written
    double tolerance = 0;  // 0: none given
    std::string where;     // "circle.deck:12" or "command line"
};

// "QUANTITY OP VALUE [+- TOLERANCE]" as it stands after `expect`. Throws UsageError without file and line: the deck
// adds them.
Expectation parse_expectation(std::string_view text);

std::string to_string(const Expectation& expectation);  // parse_expectation() reads it again

struct ExpectationResult {
    bool holds = false;
    std::string got;   // value of the summary, "nothing" where it lacks the quantity
    std::string text;  // "expected relative_quality = 0.9365 +- 0.0005, got 0.93653: holds"
};

// A quantity that the summary lacks, or that is not a number where one is expected, does not hold.
ExpectationResult check(const Expectation& expectation, const Summary& summary);

// expectations.csv: a row per expectation, with what was got and `yes` or `no` in the column `holds`.
std::string expectations_csv(const std::vector<Expectation>& expectations, const Summary& summary);

}  // namespace almesh
