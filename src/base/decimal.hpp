// std::from_chars() of a double, also with a standard library that has it for integers only, such as libc++, macOS's.
#pragma once
#include <charconv>

namespace almesh {

// The nearest double to the longest number that the text begins with, as std::from_chars() has it: no blanks, no
// leading +, no hexadecimal digits, "inf" and "nan" taken; also with the exponent of Fortran, 1.5D+03. `value` is left
// as it is where there is no number. An infinite double, or of a number that is not zero a zero, is an error beside it.
std::from_chars_result read_double(const char* begin, const char* end, double& value);

}  // namespace almesh
