// Ctrl-C (SIGINT) and SIGTERM set a flag that long computations poll, so that a run ends with its results written.
#pragma once

namespace almesh {

// From now on the first of these signals sets the flag; the second one ends the program at once.
void catch_interrupts();

bool interrupted();  // the flag
void clear_interrupt();

}  // namespace almesh
