// almesh: distortion based mesh moving and curving by the augmented Lagrangian method of Ruiz-Girones, Gargallo-Peiro,
// Sarrate and Roca, "An augmented Lagrangian formulation to impose boundary conditions for distortion based mesh moving
// and curving" (26th International Meshing Roundtable, 2017).
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "app/command_line.hpp"
#include "base/interrupt.hpp"

namespace {

// Threads that wait shall spin for some hundred microseconds, which the others mostly need, and then sleep, unless the user
// has said otherwise: where other programs want the cores too, spinning ones make a run ten times as long, and where
// they do not, falling asleep and waking up takes a tenth of it. g++'s OpenMP asks before main(), so the program starts
// once more. Where that is not possible nothing else changes.
void start_with_sleeping_threads([[maybe_unused]] char** argv) {
#if defined(_OPENMP) && defined(__linux__)
    if (std::getenv("OMP_WAIT_POLICY") || setenv("OMP_WAIT_POLICY", "passive", 0) != 0) return;
    setenv("GOMP_SPINCOUNT", "5000", 0);
    execv("/proc/self/exe", argv);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    start_with_sleeping_threads(argv);
    almesh::catch_interrupts();
    return almesh::command_line({argv + 1, argv + argc}, stdout, stderr);
}
