#include "constraint/expression.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/error.hpp"

using namespace almesh;

namespace {

double value(const std::string& text, const Vec<3>& x = {2, 3, 5}) { return Expression(text)(x); }

std::string error_of(const std::string& text) {
    try {
        Expression{text};
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("formulas with the usual precedence") {
    CHECK(value("1 + 2*3") == 7);
    CHECK(value("(1+2)*3 - 4/2/2") == 8);
    CHECK(value("10 - 4 - 3") == 3);
    CHECK(value("2^3^2") == 512);
    CHECK(value("-2^2") == -4);
    CHECK(value("2^-1") == 0.5);
    CHECK(value("--3 + +1") == 4);
    CHECK(value("1.5e-1*2E1") == doctest::Approx(3));
    CHECK(value("x + 10*y + 100*z") == 532);
    CHECK(value("x*-y") == -6);
    CHECK(value("sin(pi/6) + 2*cos(0)") == doctest::Approx(2.5));
    CHECK(value("max(x, y)^2 - min(x, y) + hypot(x, y)^2") == doctest::Approx(20));
    CHECK(value("atan2(y, x)") == std::atan2(3.0, 2.0));
    CHECK(value("sqrt(abs(-16)) + log(exp(2)) + tanh(0) + acos(1)") == doctest::Approx(6));
    CHECK(Expression(" x ") .text() == " x ");
}

TEST_CASE("errors name the column and what was expected") {
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    CHECK(has(error_of(""), "column 1: expected a number"));
    CHECK(has(error_of("x +"), "column 4: expected a number"));
    CHECK(has(error_of("(x + 1"), "column 7: expected `)`"));
    CHECK(has(error_of("x 3"), "column 3: expected an operator"));
    CHECK(has(error_of("sin x"), "column 5: expected `(`"));
    CHECK(has(error_of("atan2(x)"), "column 8: expected `,`"));
    CHECK(has(error_of("w + 1"), "unknown name `w`"));
    CHECK(has(error_of("1.2.3"), "column 4: expected an operator"));
    CHECK(has(error_of("1.5D+1 d"), "column 8: expected an operator"));
    CHECK(has(error_of("2 * .x"), "column 5: expected a number"));
    CHECK(has(error_of(std::string(500, '(')), "nested too deeply"));
    CHECK(has(error_of(std::string(500, '-') + "x"), "nested too deeply"));
}

TEST_CASE("a formula tells what it names") {
    CHECK(Expression("x + t^2")({1, 0, 0}, 3) == 10);
    CHECK(Expression("x + t^2")({1, 0, 0}) == 1);
    CHECK(Expression("2*pi*t").names_time());
    CHECK(!Expression("2*pi*t").names_point());
    CHECK(Expression("z").names_point());
    CHECK(!Expression("z").names_time());
    CHECK_THROWS_AS(Condition("t > 1"), UsageError);
}

TEST_CASE("a formula may use constants") {
    const Constants constants = {{"a", "0.5", "", 0.5}, {"long_name2", "4", "", 4}};
    CHECK(Expression("a*x + long_name2", constants)({2, 0, 0}) == 5);
    CHECK(!Expression("a", constants).names_point());
    CHECK(Condition("x > a", constants)({0.6, 0, 0}, {}));
    CHECK(!Condition("x > a", constants)({0.4, 0, 0}, {}));
    CHECK(error_of("a").find("unknown name `a`") != std::string::npos);
    for (const char* name : {"a", "B2", "long_name"}) CHECK_NOTHROW(check_constant_name(name));
    for (const char* name : {"", "2a", "_a", "a-b", "a b", "x", "t", "pi", "sin", "axis"})
        CHECK_THROWS_AS(check_constant_name(name), UsageError);
}
