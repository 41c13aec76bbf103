// Data compressed by zlib (RFC 1950, 1951).
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace almesh {

// The data, or nothing where the stream is damaged or they are not of this size.
std::optional<std::string> inflate(std::string_view stream, std::size_t size);

// A stream that holds the data as they are, without compression.
std::string stored(std::string_view data);

}  // namespace almesh
