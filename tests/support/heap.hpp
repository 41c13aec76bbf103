#pragma once

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace almesh::test {

// Bytes in use on the heap; 0 where the C library does not count them.
inline double allocated() {
#ifdef __GLIBC__
    const struct mallinfo2 all = mallinfo2();
    return static_cast<double>(all.uordblks + all.hblkhd);
#else
    return 0;
#endif
}

}  // namespace almesh::test
