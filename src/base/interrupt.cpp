#include "base/interrupt.hpp"

#include <csignal>

namespace almesh {
namespace {

volatile std::sig_atomic_t flag = 0;

extern "C" void set_flag(int signal) {
    flag = 1;
    std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
    std::signal(SIGINT, set_flag);
    std::signal(SIGTERM, set_flag);
}

bool interrupted() { return flag != 0; }

void clear_interrupt() { flag = 0; }

}  // namespace almesh
