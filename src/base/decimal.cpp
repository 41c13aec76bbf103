#include "base/decimal.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

namespace almesh {
namespace {

#ifdef __cpp_lib_to_chars

std::from_chars_result read_number(const char* begin, const char* end, double& value) {
    return std::from_chars(begin, end, value);
}

#else

// strtod() takes blanks, a leading + and hexadecimal digits too: it is given none. Its decimal point is that of the
// locale, which nothing in the program sets: it is "C".
std::from_chars_result read_number(const char* begin, const char* end, double& value) {
    const auto may_belong = [](char c) {
        const auto letter = static_cast<unsigned char>(c);
        return std::isalnum(letter) ? std::tolower(letter) != 'x' : c != '\0' && std::strchr("+-._()", c) != nullptr;
    };
    const std::string text(begin, std::find_if_not(begin, end, may_belong));
    char* stop = nullptr;
    errno = 0;
    const double nearest = text.starts_with('+') || text.starts_with("-+") ? 0 : std::strtod(text.c_str(), &stop);
    if (!stop || stop == text.c_str()) return {begin, std::errc::invalid_argument};
    const char* const last = begin + (stop - text.c_str());
    if (errno == ERANGE && (nearest == 0 || std::isinf(nearest))) return {last, std::errc::result_out_of_range};
    value = nearest;
    return {last, std::errc()};
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
