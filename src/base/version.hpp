// What was built, for --version and for every file that a run writes.
#pragma once
#include <string>

namespace almesh {

std::string version();   // "almesh 0.2.0"
std::string commit();    // abbreviated git commit, -dirty where the tree had changes, "unknown" outside git
std::string compiler();  // name, version and flags

}  // namespace almesh
