#include "base/interrupt.hpp"

#include <csignal>

namespace almesh {
namespace {

volatile std::sig_atomic_t requested = 0;

extern "C" void request(int signal) {
    requested = 1;
    std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
    std::signal(SIGINT, request);
    std::signal(SIGTERM, request);
}

bool interrupted() { return requested != 0; }

void clear_interrupt() { requested = 0; }

}  // namespace almesh
