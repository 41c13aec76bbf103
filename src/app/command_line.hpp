// The program's commands.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

namespace almesh {

// arguments: without the program's name. Results go to `out`, errors to `error`; returns the exit code.
int command_line(const std::vector<std::string>& arguments, std::FILE* out, std::FILE* error);

}  // namespace almesh
