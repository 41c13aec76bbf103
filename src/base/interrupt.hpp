// Ctrl-C (SIGINT) and SIGTERM set a flag that long computations poll, so that a run ends with its results written.
#pragma once
#include <csignal>
#include <initializer_list>

namespace almesh {

inline volatile std::sig_atomic_t interrupt_flag = 0;

inline bool interrupted() { return interrupt_flag != 0; }
inline void clear_interrupt() { interrupt_flag = 0; }

// From now on the first of these signals sets the flag; the second one ends the program at once.
inline void catch_interrupts() {
    for (const int signal : {SIGINT, SIGTERM})
        std::signal(signal, [](int caught) {
            interrupt_flag = 1;
            std::signal(caught, SIG_DFL);
        });
}

}  // namespace almesh
