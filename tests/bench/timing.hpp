// Repeats what is measured. Whole runs are told by their median, kernels and limits by their best time: other work on
// the machine can only add to it, and a limit is what the machine can do at best.
#pragma once
#include <algorithm>
#include <limits>
#include <vector>

#include "base/stopwatch.hpp"

namespace almesh::bench {

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Seconds of body(), after prepare() each time: at least three times, and until both have taken `budget` seconds.
template <class Prepare, class Body>
double best_seconds(double budget, const Prepare& prepare, const Body& body) {
    double best = std::numeric_limits<double>::infinity();
    int count = 0;
    for (const Stopwatch all; count < 3 || all.seconds() < budget; ++count) {
        prepare();
        const Stopwatch watch;
        body();
        best = std::min(best, watch.seconds());
    }
    return best;
}

template <class Body>
double best_seconds(double budget, const Body& body) {
    return best_seconds(budget, [] {}, body);
}

}  // namespace almesh::bench
