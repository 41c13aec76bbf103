#include "app/expectation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {

namespace {

enum class Kind { word, count, decimal };

struct Quantity {
    const char* name;
    Kind kind;
};

constexpr std::array<Quantity, 30> quantities = {{
    {"status", Kind::word},
    {"dimension", Kind::count},
    {"degree", Kind::count},
    {"nodes", Kind::count},
    {"elements", Kind::count},
    {"al_iterations", Kind::count},
    {"newton_iterations", Kind::count},
    {"coarse_newton_iterations", Kind::count},
    {"linear_iterations", Kind::count},
    {"pocket_steps", Kind::count},
    {"constraint_norm", Kind::decimal},
    {"projected_constraint_norm", Kind::decimal},
    {"max_boundary_error", Kind::decimal},
    {"gradient_norm", Kind::decimal},
    {"relative_quality", Kind::decimal},
    {"max_distortion", Kind::decimal},
    {"min_scaled_jacobian", Kind::decimal},
    {"certified_valid", Kind::word},
    {"time_run", Kind::decimal},
    {"time_setup", Kind::decimal},
    {"time_coarse", Kind::decimal},
    {"time_certify", Kind::decimal},
    {"time_write", Kind::decimal},
    {"time_total", Kind::decimal},
    {"time_assembly", Kind::decimal},
    {"time_linear", Kind::decimal},
    {"time_line_search", Kind::decimal},
    {"time_pockets", Kind::decimal},
    {"threads", Kind::count},
    {"peak_memory_mb", Kind::decimal},
}};

std::string with_form(const std::string& why) {
    return why + ": expected `expect QUANTITY OP VALUE [+- TOLERANCE]`, OP being <=, >= or =";
}

const Quantity& find_quantity(const std::string& name) {
    for (const Quantity& quantity : quantities)
        if (name == quantity.name) return quantity;
    throw UsageError("the summary has no quantity " + in_backquotes(name) + ": did you mean " +
                     in_backquotes(nearest(name, summary_quantities())) + "?");
}

// Takes the operator off the front of `text`.
Expectation::Relation take_relation(std::string_view& text) {
    const std::string_view symbol = text.substr(0, std::min(text.find_first_not_of("<>="), text.size()));
    text.remove_prefix(symbol.size());
    if (symbol == "<=") return Expectation::Relation::at_most;
    if (symbol == ">=") return Expectation::Relation::at_least;
    if (symbol == "=") return Expectation::Relation::equal;
    throw UsageError(with_form(in_backquotes(symbol) + " is no comparison"));
}

const char* symbol_of(Expectation::Relation relation) {
    if (relation == Expectation::Relation::equal) return "=";
    return relation == Expectation::Relation::at_most ? "<=" : ">=";
}

void check_meaning(const Expectation& expectation, Kind kind) {
    const bool equal = expectation.relation == Expectation::Relation::equal;
    const std::string quantity = in_backquotes(expectation.quantity);
    if (words(expectation.value).size() != 1) throw UsageError(with_form("one value is needed"));
    if (kind == Kind::word) {
        if (!equal || expectation.tolerance > 0) throw UsageError(quantity + " is a word: compare it with = alone");
        return;
    }
    if (!parse_double(expectation.value))
        throw UsageError(in_backquotes(expectation.value) + " is not a number, but " + quantity + " is one");
    if (!equal && expectation.tolerance > 0) throw UsageError(with_form("+- goes with = only"));
    if (equal && kind == Kind::decimal && expectation.tolerance == 0)
        throw UsageError(quantity + " is a decimal number: add a tolerance, `= " + expectation.value +
                         " +- TOLERANCE`");
}

bool compare(const Expectation& expectation, const std::string& got) {
    const auto expected_number = parse_double(expectation.value), got_number = parse_double(got);
    if (find_quantity(expectation.quantity).kind == Kind::word) return got == expectation.value;
    if (!expected_number || !got_number) return false;
    const double difference = *got_number - *expected_number;
    if (expectation.relation == Expectation::Relation::at_most) return difference <= 0;
    if (expectation.relation == Expectation::Relation::at_least) return difference >= 0;
    // A value exactly a tolerance away in decimals holds: 0.9370 = 0.9365 +- 0.0005.
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(*expected_number);
    return std::abs(difference) <= expectation.tolerance + (expectation.tolerance > 0 ? rounding : 0);
}

}  // namespace

std::vector<std::string> summary_quantities() {
    std::vector<std::string> names;
    for (const Quantity& quantity : quantities) names.push_back(quantity.name);
    return names;
}

Expectation parse_expectation(std::string_view text) {
    const auto symbol = text.find_first_of("<>=");
    if (symbol == std::string_view::npos) throw UsageError(with_form("no comparison in " + in_backquotes(text)));
    Expectation expectation;
    expectation.quantity = trim(text.substr(0, symbol));
    const Kind kind = find_quantity(expectation.quantity).kind;
    text.remove_prefix(symbol);
    expectation.relation = take_relation(text);
    const auto plus_minus = text.find("+-");
    expectation.value = trim(text.substr(0, plus_minus));
    if (plus_minus != std::string_view::npos) {
        const auto tolerance = parse_double(trim(text.substr(plus_minus + 2)));
        if (!tolerance || *tolerance <= 0) throw UsageError(with_form("+- needs a number > 0"));
        expectation.tolerance = *tolerance;
    }
    check_meaning(expectation, kind);
    return expectation;
}

ExpectationResult check(const Expectation& expectation, const Summary& summary) {
    const auto it = std::find_if(summary.begin(), summary.end(),
                                 [&](const auto& entry) { return entry.first == expectation.quantity; });
    const std::string got = it == summary.end() ? "nothing" : it->second;
    ExpectationResult result;
    result.holds = it != summary.end() && compare(expectation, got);
    result.text = "expected " + to_string(expectation) + ", got " + got + (result.holds ? ": holds" : ": fails");
    return result;
}

std::string to_string(const Expectation& expectation) {
    std::string text = expectation.quantity + " " + symbol_of(expectation.relation) + " " + expectation.value;
    if (expectation.tolerance > 0) text += " +- " + to_text(expectation.tolerance);
    return text;
}

}  // namespace almesh
