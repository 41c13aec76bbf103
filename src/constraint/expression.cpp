// Recursive descent, a function per level of precedence; ^ binds from the right and before a sign: -x^2 is -(x^2).
//
//     condition = conjunction {or conjunction},  conjunction = comparison {and comparison},
//     comparison = sum (<|<=|>|>=) sum,
//     sum = product {(+|-) product},  product = signed {(*|/) signed},  signed = [+|-] signed | power,
//     power = operand [^ signed],  operand = number | name | function ( sum {, sum} ) | table(FILE) | ( sum )
#include "constraint/expression.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "base/decimal.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

// A function of the time t given by a file with rows `t value`, separated by blanks or commas: straight lines between
// them. What stands behind # is a comment, and a first row without numbers is passed over.
class TimeTable {
public:
    // Throws UsageError where the file cannot be read, with its line where a row is none or the times run backwards.
    explicit TimeTable(const std::string& path) try : path_(path) {
        const std::string text = read_text_file(path);
        int number = 0;
        bool is_first = true;
        for (const std::string_view line : split(text, '\n')) {
            ++number;
            std::string row(line.substr(0, line.find('#')));
            std::replace(row.begin(), row.end(), ',', ' ');
            const auto word = words(row);
            if (word.empty()) continue;
            const auto t = parse_double(word[0]), value = parse_double(word.back());
            if (std::exchange(is_first, false) && !t && !value) continue;
            if (word.size() != 2 || !t || !value)
                throw UsageError(path, ":", number, ": expected a row `t value` of two finite numbers");
            if (!t_.empty() && *t <= t_.back())
                throw UsageError(path, ":", number, ": the times run backwards, ", *t, " is after ", t_.back());
            t_.push_back(*t);
            value_.push_back(*value);
        }
        if (t_.empty()) throw UsageError(path, ": no rows `t value`");
    } catch (const InputError& error) {
        throw UsageError(error.what());
    }

    // (1 - s) f_k + s f_{k+1},   s = (t - t_k) / (t_{k+1} - t_k),   t_k <= t <= t_{k+1}. Throws UsageError outside of
    // the range of its times.
    double operator()(double t) const {
        if (!(t >= t_.front() && t <= t_.back()))
            throw UsageError("t = ", t, " is outside of the table ", path_, ", from ", t_.front(), " to ", t_.back());
        const std::size_t k = std::upper_bound(t_.begin(), t_.end(), t) - t_.begin() - 1;
        if (t == t_[k]) return value_[k];
        const double s = (t - t_[k]) / (t_[k + 1] - t_[k]);
        return (1 - s) * value_[k] + s * value_[k + 1];
    }

private:
    std::string path_;
    std::vector<double> t_, value_;
};

using Value = std::function<double(const FormulaPoint&)>;
using Truth = std::function<bool(const FormulaPoint&)>;

struct Function {
    std::string name;
    double (*of_one)(double) = nullptr;
    double (*of_two)(double, double) = nullptr;
};

const std::array<Function, 17> functions = {{
    {"sin", [](double a) { return std::sin(a); }},
    {"cos", [](double a) { return std::cos(a); }},
    {"tan", [](double a) { return std::tan(a); }},
    {"asin", [](double a) { return std::asin(a); }},
    {"acos", [](double a) { return std::acos(a); }},
    {"atan", [](double a) { return std::atan(a); }},
    {"sinh", [](double a) { return std::sinh(a); }},
    {"cosh", [](double a) { return std::cosh(a); }},
    {"tanh", [](double a) { return std::tanh(a); }},
    {"exp", [](double a) { return std::exp(a); }},
    {"log", [](double a) { return std::log(a); }},
    {"sqrt", [](double a) { return std::sqrt(a); }},
    {"abs", [](double a) { return std::abs(a); }},
    {"atan2", nullptr, [](double a, double b) { return std::atan2(a, b); }},
    {"min", nullptr, [](double a, double b) { return a < b ? a : b; }},
    {"max", nullptr, [](double a, double b) { return a > b ? a : b; }},
    {"hypot", nullptr, [](double a, double b) { return std::hypot(a, b); }},
}};

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

struct Parser {
    std::string_view text;
    std::vector<std::string> names;  // of the coordinates of a point
    const Constants& constants;
    std::size_t at = 0;
    int depth = 0;
    std::array<bool, 6> named_at = {};  // which of the names stand in the text

    [[noreturn]] void fail(const std::string& what, std::size_t where) const {
        throw UsageError(in_backquotes(text), ", column ", where + 1, ": ", what);
    }

    void skip_blanks() {
        while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
    }

    bool take(char c) {
        skip_blanks();
        if (at >= text.size() || text[at] != c) return false;
        ++at;
        return true;
    }

    void expect(char c) {
        if (!take(c)) fail(std::string("expected `") + c + "`", at);
    }

    bool take_word(std::string_view word) {
        skip_blanks();
        if (!text.substr(at).starts_with(word)) return false;
        at += word.size();
        return true;
    }

    Truth condition() {
        Truth left = conjunction();
        while (take_word("or"))
            left = [a = left, b = conjunction()](const FormulaPoint& x) { return a(x) || b(x); };
        return left;
    }

    Truth conjunction() {
        Truth left = comparison();
        while (take_word("and"))
            left = [a = left, b = comparison()](const FormulaPoint& x) { return a(x) && b(x); };
        return left;
    }

    Truth comparison() {
        const Value left = sum();
        if (take_word("<=")) return [a = left, b = sum()](const FormulaPoint& x) { return a(x) <= b(x); };
        if (take_word(">=")) return [a = left, b = sum()](const FormulaPoint& x) { return a(x) >= b(x); };
        if (take('<')) return [a = left, b = sum()](const FormulaPoint& x) { return a(x) < b(x); };
        if (take('>')) return [a = left, b = sum()](const FormulaPoint& x) { return a(x) > b(x); };
        fail("expected <, <=, > or >=", at);
    }

    void end() {
        skip_blanks();
        if (at < text.size()) fail("expected an operator or the end", at);
    }

    Value sum() {
        Value left = product();
        for (;;) {
            if (take('+')) left = [a = left, b = product()](const FormulaPoint& x) { return a(x) + b(x); };
            else if (take('-')) left = [a = left, b = product()](const FormulaPoint& x) { return a(x) - b(x); };
            else return left;
        }
    }

    Value product() {
        Value left = with_sign();
        for (;;) {
            if (take('*')) left = [a = left, b = with_sign()](const FormulaPoint& x) { return a(x) * b(x); };
            else if (take('/')) left = [a = left, b = with_sign()](const FormulaPoint& x) { return a(x) / b(x); };
            else return left;
        }
    }

    Value with_sign() {
        constexpr int deepest = 100;
        if (++depth > deepest) fail("nested too deeply", at);
        Value value;
        if (take('-')) value = [a = with_sign()](const FormulaPoint& x) { return -a(x); };
        else if (take('+')) value = with_sign();
        else value = power();
        --depth;
        return value;
    }

    Value power() {
        Value base = operand();
        if (!take('^')) return base;
        return [a = base, b = with_sign()](const FormulaPoint& x) { return std::pow(a(x), b(x)); };
    }

    Value operand() {
        skip_blanks();
        if (take('(')) {
            Value inside = sum();
            expect(')');
            return inside;
        }
        if (at < text.size() && std::isalpha(static_cast<unsigned char>(text[at]))) return named();
        const bool has_sign = at < text.size() && text[at] == '-';
        double number = 0;
        const auto [stop, error] = read_double(text.data() + at, text.data() + text.size(), number);
        if (has_sign || error != std::errc()) fail("expected a number, x, y, z, pi, a function or `(`", at);
        at = stop - text.data();
        return [number](const FormulaPoint&) { return number; };
    }

    // Behind `table(`, in a formula that may name t.
    Value table() {
        constexpr std::size_t time = 3;
        const std::size_t end = text.find(')', at);
        if (end == std::string_view::npos) fail("expected `)` behind the name of a file", text.size());
        const std::string path(trim(text.substr(at, end - at)));
        at = end + 1;
        named_at[time] = true;
        return [f = std::make_shared<const TimeTable>(path)](const FormulaPoint& x) { return (*f)(x[time]); };
    }

    Value named() {
        const std::size_t begin = at;
        while (at < text.size() && is_of_name(text[at])) ++at;
        if (text.substr(begin).starts_with("table(") && names.back() == "t") {
            ++at;
            return table();
        }
        const std::string_view name = text.substr(begin, at - begin);
        if (const Constant* const constant = find_row(constants, name))
            return [v = constant->value](const FormulaPoint&) { return v; };
        if (name == "pi") return [](const FormulaPoint&) { return std::numbers::pi; };
        for (std::size_t a = 0; a < names.size(); ++a)
            if (name == names[a]) {
                named_at[a] = true;
                return [a](const FormulaPoint& x) { return x[a]; };
            }
        const Function* const function = find_row(functions, name);
        if (!function) {
            std::vector<std::string> known = names_of(functions);
            known.insert(known.begin(), "pi");
            known.insert(known.begin(), names.begin(), names.end());
            for (const Constant& constant : constants) known.push_back(constant.name);
            fail("unknown name " + in_backquotes(name) + did_you_mean(name, known), begin);
        }
        expect('(');
        Value first = sum();
        if (function->of_one) {
            expect(')');
            return [f = function->of_one, a = first](const FormulaPoint& x) { return f(a(x)); };
        }
        expect(',');
        Value second = sum();
        expect(')');
        return [f = function->of_two, a = first, b = second](const FormulaPoint& x) { return f(a(x), b(x)); };
    }
};

}  // namespace

void check_constant_name(std::string_view name) {
    const bool is_word = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) &&
                         std::all_of(name.begin(), name.end(), is_of_name);
    if (!is_word)
        throw UsageError("`let` needs a name of letters, digits and _, that begins with a letter: `let NAME = NUMBER`");
    for (const std::string_view taken :
         {"x", "y", "z", "t", "nx", "ny", "nz", "pi", "and", "or", "axis", "about", "table"})
        if (name == taken || find_row(functions, name))
            throw UsageError("the name ", in_backquotes(name), " has a meaning in formulas already: take another");
}

Expression::Expression(std::string_view text, const Constants& constants) : text_(text) {
    Parser parser{text, {"x", "y", "z", "t"}, constants};
    value_ = parser.sum();
    parser.end();
    names_point_ = parser.named_at[0] || parser.named_at[1] || parser.named_at[2];
    names_time_ = parser.named_at[3];
}

Condition::Condition(std::string_view text, const Constants& constants) {
    Parser parser{text, {"x", "y", "z", "nx", "ny", "nz"}, constants};
    holds_ = parser.condition();
    parser.end();
}

}  // namespace almesh
