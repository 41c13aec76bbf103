// Recursive descent, a function per level of precedence; ^ binds from the right and before a sign: -x^2 is -(x^2).
//
//     sum = product {(+|-) product},  product = signed {(*|/) signed},  signed = [+|-] signed | power,
//     power = operand [^ signed],  operand = number | name | function ( sum {, sum} ) | ( sum )
#include "constraint/expression.hpp"

#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

using Value = std::function<double(const Vec<3>&)>;

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

struct Parser {
    std::string_view text;
    std::size_t at = 0;
    int depth = 0;

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

    Value sum() {
        Value left = product();
        for (;;) {
            if (take('+')) left = [a = left, b = product()](const Vec<3>& x) { return a(x) + b(x); };
            else if (take('-')) left = [a = left, b = product()](const Vec<3>& x) { return a(x) - b(x); };
            else return left;
        }
    }

    Value product() {
        Value left = with_sign();
        for (;;) {
            if (take('*')) left = [a = left, b = with_sign()](const Vec<3>& x) { return a(x) * b(x); };
            else if (take('/')) left = [a = left, b = with_sign()](const Vec<3>& x) { return a(x) / b(x); };
            else return left;
        }
    }

    Value with_sign() {
        constexpr int deepest = 100;
        if (++depth > deepest) fail("nested too deeply", at);
        Value value;
        if (take('-')) value = [a = with_sign()](const Vec<3>& x) { return -a(x); };
        else if (take('+')) value = with_sign();
        else value = power();
        --depth;
        return value;
    }

    Value power() {
        Value base = operand();
        if (!take('^')) return base;
        return [a = base, b = with_sign()](const Vec<3>& x) { return std::pow(a(x), b(x)); };
    }

    Value operand() {
        skip_blanks();
        if (take('(')) {
            Value inside = sum();
            expect(')');
            return inside;
        }
        const std::size_t begin = at;
        if (at < text.size() && std::isalpha(static_cast<unsigned char>(text[at]))) return named();
        while (at < text.size() && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.')) ++at;
        if (at > begin && at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
            std::size_t end = at + 1;
            if (end < text.size() && (text[end] == '+' || text[end] == '-')) ++end;
            const std::size_t digits = end;
            while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
            if (end > digits) at = end;
        }
        const auto number = parse_double(text.substr(begin, at - begin));
        if (!number) fail("expected a number, x, y, z, pi, a function or `(`", begin);
        return [v = *number](const Vec<3>&) { return v; };
    }

    Value named() {
        const std::size_t begin = at;
        while (at < text.size() && std::isalnum(static_cast<unsigned char>(text[at]))) ++at;
        const std::string_view name = text.substr(begin, at - begin);
        if (name == "pi") return [](const Vec<3>&) { return std::numbers::pi; };
        for (int a = 0; a < 3; ++a)
            if (name.size() == 1 && name[0] == "xyz"[a]) return [a](const Vec<3>& x) { return x[a]; };
        const Function* const function = find_row(functions, name);
        if (!function) {
            std::vector<std::string> known = names_of(functions);
            known.insert(known.begin(), {"x", "y", "z", "pi"});
            fail("unknown name " + in_backquotes(name) + did_you_mean(name, known), begin);
        }
        expect('(');
        Value first = sum();
        if (function->of_one) {
            expect(')');
            return [f = function->of_one, a = first](const Vec<3>& x) { return f(a(x)); };
        }
        expect(',');
        Value second = sum();
        expect(')');
        return [f = function->of_two, a = first, b = second](const Vec<3>& x) { return f(a(x), b(x)); };
    }
};

}  // namespace

Expression::Expression(std::string_view text) : text_(text) {
    Parser parser{text};
    value_ = parser.sum();
    parser.skip_blanks();
    if (parser.at < text.size()) parser.fail("expected an operator or the end", parser.at);
}

}  // namespace almesh
