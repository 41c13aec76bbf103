#include "base/decimal.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace almesh {
namespace {

#ifdef __cpp_lib_to_chars

std::from_chars_result read_number(const char* begin, const char* end, double& value) {
    return std::from_chars(begin, end, value);
}

#else

bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* after_digits(const char* at, const char* end) {
    while (at != end && is_digit(*at)) ++at;
    return at;
}

// Behind the word, in letters of either case; nullptr where the text does not begin with it.
const char* after_word(const char* at, const char* end, std::string_view word) {
    for (const char letter : word) {
        if (at == end || std::tolower(static_cast<unsigned char>(*at)) != letter) return nullptr;
        ++at;
    }
    return at;
}

// Behind "inf", "infinity", "nan" or "nan(letters)", or nullptr.
const char* after_named(const char* at, const char* end) {
    if (const char* const stop = after_word(at, end, "infinity")) return stop;
    if (const char* const stop = after_word(at, end, "inf")) return stop;
    const char* const nan = after_word(at, end, "nan");
    if (!nan || nan == end || *nan != '(') return nan;
    const char* stop = nan + 1;
    while (stop != end && (std::isalnum(static_cast<unsigned char>(*stop)) || *stop == '_')) ++stop;
    return stop != end && *stop == ')' ? stop + 1 : nan;
}

// Behind digits with a point among them or not, and an exponent that has digits; nullptr where there is no digit.
const char* after_decimal(const char* const begin, const char* end) {
    const char* stop = after_digits(begin, end);
    bool any = stop != begin;
    if (stop != end && *stop == '.') {
        const char* const fraction = stop + 1;
        stop = after_digits(fraction, end);
        any = any || stop != fraction;
    }
    if (!any) return nullptr;
    if (stop == end || (*stop != 'e' && *stop != 'E')) return stop;
    const char* exponent = stop + 1;
    if (exponent != end && (*exponent == '+' || *exponent == '-')) ++exponent;
    const char* const last = after_digits(exponent, end);
    return last == exponent ? stop : last;
}

bool has_digit_but_zero(const char* at, const char* end) {
    for (; at != end && *at != 'e' && *at != 'E'; ++at)
        if (*at >= '1' && *at <= '9') return true;
    return false;
}

// strtod() takes what the functions above have delimited, and more. Its decimal point is that of the locale, which
// nothing in the program sets: it is "C".
std::from_chars_result read_number(const char* begin, const char* end, double& value) {
    const char* const digits = begin != end && *begin == '-' ? begin + 1 : begin;
    const char* const decimal = after_decimal(digits, end);
    const char* const stop = decimal ? decimal : after_named(digits, end);
    if (!stop) return {begin, std::errc::invalid_argument};
    const double nearest = std::strtod(std::string(begin, stop).c_str(), nullptr);
    if (decimal && (std::isinf(nearest) || (nearest == 0 && has_digit_but_zero(digits, decimal))))
        return {stop, std::errc::result_out_of_range};
    value = nearest;
    return {stop, std::errc()};
}

#endif

}  // namespace

std::from_chars_result read_double(const char* begin, const char* end, double& value) {
    constexpr std::ptrdiff_t longest = 8;  // of an exponent
    const auto [stop, error] = read_number(begin, end, value);
    const bool is_fortran = error != std::errc::invalid_argument && stop != end && (*stop == 'd' || *stop == 'D');
    if (!is_fortran && error != std::errc::result_out_of_range) return {stop, error};
    std::string text(begin, is_fortran ? stop + std::min(end - stop, longest) : stop);
    if (is_fortran) text[stop - begin] = 'e';
    const auto [last, error_now] = read_number(text.data(), text.data() + text.size(), value);
    if (error_now == std::errc::result_out_of_range) value = std::strtod(text.c_str(), nullptr);
    return {begin + (last - text.data()), error_now};
}

}  // namespace almesh
