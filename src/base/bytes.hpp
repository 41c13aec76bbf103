// Numbers as bytes in an order, for binary files.
#pragma once
#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace almesh {

template <class Number>
void append_bytes(std::string& text, Number value, std::endian order) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (order != std::endian::native) std::reverse(bytes, bytes + sizeof bytes);
    text.append(bytes, sizeof bytes);
}

// The number in the first bytes at `at`.
template <class Number>
Number from_bytes(const char* at, std::endian order) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, at, sizeof bytes);
    if (order != std::endian::native) std::reverse(bytes, bytes + sizeof bytes);
    Number value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

}  // namespace almesh
