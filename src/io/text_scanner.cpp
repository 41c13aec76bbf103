#include "io/text_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {

void TextScanner::fail(int where, const std::string& message) const {
    throw InputError(path + ":" + std::to_string(where) + ": " + message);
}

bool TextScanner::next_line() {
    for (skip_blanks(); at != end && *at == '\n'; skip_blanks()) {
        ++at;
        ++line;
    }
    return at != end;
}

std::string_view TextScanner::rest_of_line() {
    const char* const begin = at;
    at = std::find(at, end, '\n');
    return trim(std::string_view(begin, static_cast<std::size_t>(at - begin)));
}

std::string TextScanner::word() const {
    if (at_line_end()) return "the end of the line";
    const char* stop = at;
    while (!is_word_end(stop) && stop - at < 40) ++stop;
    std::string shown = "`";
    shown.append(at, stop);
    return shown += '`';
}

void TextScanner::end_of_line() {
    skip_blanks();
    if (!at_line_end()) fail("expected the end of the line, got " + word());
}

long long TextScanner::integer(const char* what, long long lowest, long long highest) {
    skip_blanks();
    long long value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc::invalid_argument || !is_word_end(stop))
        fail(std::string("expected ") + what + ", got " + word());
    if (error != std::errc() || value < lowest || value > highest)
        fail(std::string(what) + " " + word() + " is out of range");
    at = stop;
    return value;
}

int TextScanner::small_integer(const char* what, int lowest) {
    return static_cast<int>(integer(what, lowest, std::numeric_limits<int>::max()));
}

double TextScanner::real(const char* what) {
    skip_blanks();
    const char* const begin = at != end && *at == '+' ? at + 1 : at;
    double value = 0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument || !is_word_end(stop))
        fail(std::string("expected ") + what + ", got " + word());
    // from_chars() does not distinguish underflow (1e-400, read as 0) from overflow (1e400).
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(begin, stop).c_str(), nullptr);
    if (!std::isfinite(value)) fail(std::string(what) + " " + word() + " is not a finite number");
    at = stop;
    return value;
}

}  // namespace almesh
