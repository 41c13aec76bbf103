// SHA-256 (FIPS 180-4), by which a proof names its mesh file.
#pragma once
#include <string>
#include <string_view>

namespace almesh {

std::string sha256(std::string_view bytes);  // 64 hexadecimal digits

}  // namespace almesh
