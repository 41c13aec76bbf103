// The same tables for std::from_chars() and for what replaces it.
#include "base/decimal.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <string_view>

using namespace almesh;

namespace {

constexpr double untouched = 12345;

struct Read {
    double value = untouched;
    std::size_t length;
    std::errc error;
};

Read read(std::string_view text) {
    Read result;
    const auto [stop, error] = read_double(text.data(), text.data() + text.size(), result.value);
    result.length = static_cast<std::size_t>(stop - text.data());
    result.error = error;
    return result;
}

std::uint64_t bits_of(double value) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

double of_bits(std::uint64_t bits) {
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

// Decimal expansion of digits * 2^exponent, exact: the digits of the integer digits * 2^exponent, or, for exponent < 0,
// digits * 5^-exponent with the point -exponent places from the right.
std::string exact_text(std::uint64_t digits, int exponent) {
    std::string number = std::to_string(digits);
    for (int i = 0; i < std::abs(exponent); ++i) {
        int carry = 0;
        for (auto digit = number.rbegin(); digit != number.rend(); ++digit) {
            const int product = (*digit - '0') * (exponent < 0 ? 5 : 2) + carry;
            *digit = static_cast<char>('0' + product % 10);
            carry = product / 10;
        }
        if (carry > 0) number.insert(number.begin(), static_cast<char>('0' + carry));
    }
    return exponent < 0 ? number + "e" + std::to_string(exponent) : number;
}

}  // namespace

TEST_CASE("the longest number that a text begins with") {
    struct Row {
        const char* text;
        double value;
        std::size_t length;
    };
    for (const Row& row :
         {Row{"1", 1, 1}, Row{"-1.5e3x", -1500, 6}, Row{"5.", 5, 2}, Row{".5", 0.5, 2}, Row{"-.5", -0.5, 3},
          Row{"1e", 1, 1}, Row{"1e+", 1, 1}, Row{"1E-", 1, 1}, Row{"1e+2", 100, 4}, Row{"1E-2 3", 0.01, 4},
          Row{"1.2.3", 1.2, 3}, Row{"0x10", 0, 1}, Row{"1,5", 1, 1}, Row{"1f3", 1, 1}, Row{"007", 7, 3},
          Row{"1e0000000000000000000000000000000002", 100, 36}, Row{"0e999999999999", 0, 14},
          Row{"0.1", 0.1, 3}, Row{"2.2250738585072014e-308", std::numeric_limits<double>::min(), 23},
          Row{"1.7976931348623157e308", std::numeric_limits<double>::max(), 22},
          Row{"5e-324", std::numeric_limits<double>::denorm_min(), 6}}) {
        CAPTURE(row.text);
        const Read got = read(row.text);
        CHECK(got.error == std::errc());
        CHECK(got.length == row.length);
        CHECK(bits_of(got.value) == bits_of(row.value));
    }
    CHECK(bits_of(read("-0").value) == bits_of(-0.0));
    CHECK(read(std::string_view("123456", 3)).value == 123);  // not a character behind the end
    CHECK(read(std::string_view("1e5", 2)).length == 1);
}

TEST_CASE("infinity and nan are numbers here") {
    for (const std::string text : {"inf", "INF", "infinity", "Infinity"}) {
        const Read got = read(text + " 1");
        CHECK(got.error == std::errc());
        CHECK(got.length == text.size());
        CHECK(got.value == std::numeric_limits<double>::infinity());
    }
    CHECK(read("-inf").value == -std::numeric_limits<double>::infinity());
    CHECK(read("infinit").length == 3);
    CHECK(read("nan(12").length == 3);
    CHECK(read("-NaN(1_a)").length == 9);
    CHECK(std::isnan(read("nan").value));
}

TEST_CASE("what is no number, or none that a double can hold") {
    for (const char* text : {"", "-", "+1", "--1", " 1", ".", "-.", "e5", ".e5", "x", "in", "na", "+inf", "-+1"}) {
        CAPTURE(text);
        const Read got = read(text);
        CHECK(got.error == std::errc::invalid_argument);
        CHECK(got.length == 0);
        CHECK(got.value == untouched);
    }
    for (const std::string text : {"1e400", "-1e400", "1e-400", "-1e-400", "0.000001e-400", "1e99999999999999999999",
                                   "1.7976931348623159e308", "2e-324"}) {
        CAPTURE(text);
        const Read got = read(text + "x");
        CHECK(got.error == std::errc::result_out_of_range);
        CHECK(got.length == text.size());
        CHECK((std::isinf(got.value) || got.value == 0));
    }
}

TEST_CASE("the exponents of Fortran") {
    CHECK(read("1.5D+03 ").value == 1500);
    CHECK(read("-25d-1,").value == -2.5);
    CHECK(read(".5D0").length == 4);
    CHECK(read("1.0D-400").error == std::errc::result_out_of_range);
    CHECK(read("1.0D-400").value == 0);
    CHECK(std::isinf(read("1D+400").value));
    for (const std::string text : {"2d", "2D+", "2dx", "2e1d3"}) CHECK(read(text).length == text.find_first_of("dD"));
    CHECK(read("D5").error == std::errc::invalid_argument);
}

TEST_CASE("the nearest double, and of two the even one") {
    std::mt19937_64 random(11);
    for (int i = 0; i < 2000; ++i) {
        // (m + 1/2) 2^e between the neighbours m 2^e and (m + 1) 2^e, in all its digits.
        const std::uint64_t m = (random() >> 12) | (1ull << 52);
        const int e = static_cast<int>(random() % 400) - 200;
        const double below = std::ldexp(static_cast<double>(m), e), above = of_bits(bits_of(below) + 1);
        std::string half = exact_text(2 * m + 1, e - 1);
        CAPTURE(half);
        CHECK(read(half).value == (m % 2 ? above : below));
        const auto point = std::min(half.find('e'), half.size());
        CHECK(read(half.substr(0, point) + ".00000000000000000000001" + half.substr(point)).value == above);
        --half[point - 1];  // the last digit, where it is no 0
        if (half[point - 1] >= '0') CHECK(read(half).value == below);
    }
}
