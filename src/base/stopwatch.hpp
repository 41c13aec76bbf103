// Wall-clock time, and where a run spends it.
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

// Seconds; total includes what the others leave out.
struct Timings {
    double total = 0, assembly = 0, linear = 0, line_search = 0, pockets = 0;
};

// Adds the time it lives to one of the fields of Timings.
class TimeAdder {
public:
    explicit TimeAdder(double& sum) : sum_(sum) {}
    ~TimeAdder() { sum_ += watch_.seconds(); }
    TimeAdder(const TimeAdder&) = delete;
    TimeAdder& operator=(const TimeAdder&) = delete;

private:
    double& sum_;
    Stopwatch watch_;
};

}  // namespace almesh
