// What asks a run to end in good order, with its results written: signals (Ctrl-C, SIGTERM, a terminal that closes),
// the time that it was given, and who called the library. Long computations poll interrupted(), in the thread that has
// called the run: time and callers are those of a thread.
#pragma once
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>

namespace almesh {

inline volatile std::sig_atomic_t interrupt_flag = 0;

using Clock = std::chrono::steady_clock;
inline thread_local Clock::time_point deadline = Clock::time_point::max();
inline thread_local const std::function<bool()>* caller_stops = nullptr;  // null: the caller is not asked

inline bool out_of_time() { return Clock::now() >= deadline; }
inline bool interrupted() { return interrupt_flag != 0 || out_of_time() || (caller_stops && (*caller_stops)()); }
inline void clear_interrupt() { interrupt_flag = 0; }

// While it lives, the time ends `seconds` after it was made; 0: never.
class TimeLimit {
public:
    explicit TimeLimit(double seconds) {
        const auto limit = std::chrono::duration<double>(seconds);
        if (seconds > 0) deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
    }
    ~TimeLimit() { deadline = Clock::time_point::max(); }
    TimeLimit(const TimeLimit&) = delete;
    TimeLimit& operator=(const TimeLimit&) = delete;
};

// While it lives, the signal does something else; not where it is ignored, as under nohup.
class HandleSignal {
public:
    HandleSignal(int signal, void (*handler)(int)) : signal_(signal), before_(std::signal(signal, handler)) {
        if (before_ == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    ~HandleSignal() { std::signal(signal_, before_); }
    HandleSignal(const HandleSignal&) = delete;

private:
    const int signal_;
    void (*before_)(int);
};

template <void (*handler)(int)>
struct OnInterrupts {
    HandleSignal interrupt{SIGINT, handler}, terminate{SIGTERM, handler}, hang_up{SIGHUP, handler};
};

// While it lives, the first of these signals sets the flag, and a second one of its kind ends the program at once. For
// where the flag is polled: elsewhere a signal must not be swallowed.
inline void set_flag_once(int caught) {
    interrupt_flag = 1;
    std::signal(caught, SIG_DFL);
}
using CatchInterrupts = OnInterrupts<set_flag_once>;

// While it lives, one of them ends the program as it ends a run later, but for the results: there are none yet.
inline void end_program(int) {
    constexpr char text[] = "almesh: interrupted before the first step; try the run again\n";
    _exit(write(STDERR_FILENO, text, sizeof text - 1) < 0 ? 1 : 3);
}
using EndAtInterrupts = OnInterrupts<end_program>;

}  // namespace almesh
