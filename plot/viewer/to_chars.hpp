// std::to_chars() of a double for emscripten's libc++ of before version 14, which has it for integers only: with the
// characters that libstdc++ gives. `make wasm` includes it in front of all files.
#pragma once
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace std {

inline to_chars_result to_chars(char* first, char* last, double value, chars_format format, int digits) {
    const bool is_fixed = format == chars_format::fixed, is_scientific = format == chars_format::scientific;
    const char* const form = is_fixed ? "%.*f" : is_scientific ? "%.*e" : "%.*g";
    char text[512];  // 309 digits before the point
    const int size = snprintf(text, sizeof text, form, digits, value);
    if (size > last - first) return {last, errc::value_too_large};
    memcpy(first, text, size);
    return {first + size, errc()};
}

// The fewest digits that give the same double. general: with an exponent below 1e-4 and from 1e6 on; no format: with an
// exponent where that is shorter.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format format = chars_format()) {
    char text[32];
    int digits = 0, length;
    do length = snprintf(text, sizeof text, "%.*e", digits, value);
    while (strtod(text, nullptr) != value && ++digits < 17);
    const char* const exponent = strchr(text, 'e');
    const int power = exponent ? atoi(exponent + 1) : 0;
    if (format == chars_format() || (format == chars_format::general && power >= -4 && power < 6)) {
        const auto fixed = to_chars(first, last, value, chars_format::fixed, digits > power ? digits - power : 0);
        if (format == chars_format::general || (fixed.ec == errc() && fixed.ptr - first <= length)) return fixed;
    }
    return to_chars(first, last, value, chars_format::scientific, digits);
}

}  // namespace std
