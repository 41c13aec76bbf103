// Wall-clock times, in seconds, and what they are spent on.
#pragma once
#include <chrono>

namespace almesh {

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

// Seconds of the minimisation; total: all of it, what the other four leave out included.
struct Timings {
    double total = 0, assembly = 0, linear = 0, line_search = 0, elimination = 0;

    Timings& operator+=(const Timings& other) {
        total += other.total;
        assembly += other.assembly;
        linear += other.linear;
        line_search += other.line_search;
        elimination += other.elimination;
        return *this;
    }
};

// Adds its lifetime to `sum`: the time of the block in which it stands.
class TimeAdder {
public:
    explicit TimeAdder(double& sum) : sum_(sum) {}
    ~TimeAdder() { sum_ += watch_.seconds(); }
    TimeAdder(const TimeAdder&) = delete;

private:
    double& sum_;
    Stopwatch watch_;
};

}  // namespace almesh
