// The macros come from the Makefile.
#include "base/version.hpp"

namespace almesh {

std::string version() { return "almesh " ALMESH_VERSION; }
std::string commit() { return ALMESH_COMMIT; }

std::string compiler() {
#ifdef __clang__
    return std::string("clang++ ") + __clang_version__ + " " + ALMESH_FLAGS;
#else
    return std::string("g++ ") + __VERSION__ + " " + ALMESH_FLAGS;
#endif
}

}  // namespace almesh
