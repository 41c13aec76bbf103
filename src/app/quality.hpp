// `almesh quality FILE`: is every element of a mesh valid, and how well shaped are they?
#pragma once
#include <cstdio>
#include <string>

#include "base/error.hpp"

namespace almesh {

// Prints certificate and statistics to `out`. success: every element certified valid, else not_certified.
ExitCode quality(const std::string& mesh_path, std::FILE* out);

}  // namespace almesh
