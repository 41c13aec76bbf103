// `expect` lines of a deck: statements about the summary of the run, checked at its end.
//
//   expect status = converged
//   expect relative_quality = 0.9365 +- 0.0005
//   expect max_distortion <= 2.8
//
// The quantities are the keys of summary.txt. A decimal number is compared with = and a tolerance, a count or a word
// with = alone.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace almesh {

struct Expectation {
    enum class Relation { at_most, at_least, equal };

    std::string quantity;
    Relation relation = Relation::equal;
    std::string value;     // the number or word as written
    double tolerance = 0;  // 0: none given
    std::string where;     // "circle.deck:12" or "command line"
};

// (key, value) lines of summary.txt, in its order.
using Summary = std::vector<std::pair<std::string, std::string>>;

struct ExpectationResult {
    bool holds = false;
    std::string text;  // "expected relative_quality = 0.9365 +- 0.0005, got 0.93653: holds"
};

std::vector<std::string> summary_quantities();

// "QUANTITY OP VALUE [+- TOLERANCE]" as it stands after `expect`. Throws UsageError without a place: the deck adds it.
Expectation parse_expectation(std::string_view text);

// A quantity that the summary lacks, or that is not a number where one is expected, does not hold.
ExpectationResult check(const Expectation& expectation, const Summary& summary);

std::string to_string(const Expectation& expectation);  // parse_expectation() reads it again

}  // namespace almesh
