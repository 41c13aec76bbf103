// almesh: distortion based mesh moving and curving by the augmented Lagrangian method of Ruiz-Girones, Gargallo-Peiro,
// Sarrate and Roca, "An augmented Lagrangian formulation to impose boundary conditions for distortion based mesh moving
// and curving" (26th International Meshing Roundtable, 2017).
#include <cstdio>
#include <cstdlib>
#include <new>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "app/commands.hpp"
#include "base/error.hpp"

namespace {

// Waiting threads spin for some ten microseconds, about what they mostly have to wait, and then sleep, unless the user
// has said otherwise: if other programs want the cores too, spinning makes a run several times as long. OpenMP
// libraries read the environment once: clang++'s at its first use, g++'s before main(). The latter is linked into the
// program (Makefile), whose constructors run in the order of their priority: this one is first.
[[gnu::constructor(101)]] void let_waiting_threads_sleep() {
    if (std::getenv("OMP_WAIT_POLICY")) return;
    setenv("OMP_WAIT_POLICY", "passive", 0);
    setenv("GOMP_SPINCOUNT", "1000", 0);
}

// Keeps freed memory, up to a limit, in the program: else every local minimisation would get its arrays from the system
// anew, page by page, for a tenth of its time.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int kept = 256 << 20, largest = 32 << 20;  // bytes, of all and of one array
    mallopt(M_TRIM_THRESHOLD, kept);
    mallopt(M_MMAP_THRESHOLD, largest);
#endif
}

// An exception cannot leave a parallel loop: a failed allocation inside one would call std::terminate.
void end_without_memory() {
    std::fflush(stdout);
    std::fprintf(stderr, "almesh: %s\n", almesh::out_of_memory);
    std::_Exit(static_cast<int>(almesh::ExitCode::input));
}

}  // namespace

int main(int argc, char** argv) {
    std::set_new_handler(end_without_memory);
    keep_freed_memory();
    return almesh::command_line({argv + 1, argv + argc}, stdout, stderr);
}
