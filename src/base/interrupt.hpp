// Signals that ask a run to end (Ctrl-C, SIGTERM, a terminal that closes) set a flag that long computations poll, so that
// it ends with its results written.
#pragma once
#include <csignal>

namespace almesh {

inline volatile std::sig_atomic_t interrupt_flag = 0;

inline bool interrupted() { return interrupt_flag != 0; }
inline void clear_interrupt() { interrupt_flag = 0; }

// While it lives, the signal does something else; not where it is ignored, as under nohup.
class HandleSignal {
public:
    HandleSignal(int signal, void (*handler)(int)) : signal_(signal), before_(std::signal(signal, handler)) {
        if (before_ == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    ~HandleSignal() { std::signal(signal_, before_); }
    HandleSignal(const HandleSignal&) = delete;
    HandleSignal& operator=(const HandleSignal&) = delete;

private:
    int signal_;
    void (*before_)(int);
};

// While it lives, the first of these signals sets the flag, and a second one of its kind ends the program at once. For
// where the flag is polled: elsewhere a signal must not be swallowed.
class CatchInterrupts {
    static void set_flag(int caught) {
        interrupt_flag = 1;
        std::signal(caught, SIG_DFL);
    }
    HandleSignal interrupt_{SIGINT, set_flag}, terminate_{SIGTERM, set_flag}, hang_up_{SIGHUP, set_flag};
};

}  // namespace almesh
