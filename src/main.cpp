// almesh: distortion based mesh moving and curving by the augmented Lagrangian method of Ruiz-Girones, Gargallo-Peiro,
// Sarrate and Roca, "An augmented Lagrangian formulation to impose boundary conditions for distortion based mesh moving
// and curving" (26th International Meshing Roundtable, 2017).
#include <cstdio>

#include "app/command_line.hpp"
#include "base/interrupt.hpp"

int main(int argc, char** argv) {
    almesh::catch_interrupts();
    return almesh::command_line({argv + 1, argv + argc}, stdout, stderr);
}
