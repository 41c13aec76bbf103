// Ctrl-C (SIGINT) and SIGTERM as a request that long computations notice, so that a run ends with its results written.
#pragma once

namespace almesh {

// From now on the first of these signals is a request; the second one ends the program at once.
void catch_interrupts();

bool interrupted();      // whether there was a request
void clear_interrupt();  // forgets it

}  // namespace almesh
