// The memory of the machine.
#pragma once
#include <unistd.h>

namespace almesh {

// Bytes.
inline double physical_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace almesh
