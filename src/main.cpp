// almesh: distortion based mesh moving and curving by the augmented Lagrangian method of Ruiz-Girones, Gargallo-Peiro,
// Sarrate and Roca, "An augmented Lagrangian formulation to impose boundary conditions for distortion based mesh moving
// and curving" (26th International Meshing Roundtable, 2017).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <new>

#include "app/commands.hpp"
#include "base/error.hpp"
#include "base/interrupt.hpp"

namespace {

// Threads that wait shall spin for some ten microseconds, about what the others mostly need, and then sleep, unless
// the user has said otherwise: where other programs want the cores too, spinning ones make a run ten times as long, and
// where they do not, falling asleep and waking up for each wait costs some percent. g++'s OpenMP asks before main(), so
// the program starts once more. Where that is not possible nothing else changes.
void start_with_sleeping_threads([[maybe_unused]] char** argv) {
#if defined(_OPENMP) && defined(__linux__)
    if (std::getenv("OMP_WAIT_POLICY") || setenv("OMP_WAIT_POLICY", "passive", 0) != 0) return;
    setenv("GOMP_SPINCOUNT", "1000", 0);
    execv("/proc/self/exe", argv);
#endif
}

// An exception cannot leave a parallel loop, so that running out of memory inside one would end in std::terminate.
void end_without_memory() {
    std::fflush(stdout);
    std::fputs(almesh::out_of_memory, stderr);
    std::_Exit(static_cast<int>(almesh::ExitCode::input));
}

}  // namespace

int main(int argc, char** argv) {
    start_with_sleeping_threads(argv);
    std::set_new_handler(end_without_memory);
    almesh::catch_interrupts();
    return almesh::command_line({argv + 1, argv + argc}, stdout, stderr);
}
