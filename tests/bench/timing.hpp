// Repeats what is measured and takes the median: on a machine with other work to do the mean tells little.
#pragma once
#include <algorithm>
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
double median_seconds(double budget, const Prepare& prepare, const Body& body) {
    std::vector<double> times;
    for (const Stopwatch all; times.size() < 3 || all.seconds() < budget;) {
        prepare();
        const Stopwatch watch;
        body();
        times.push_back(watch.seconds());
    }
    return median(times);
}

template <class Body>
double median_seconds(double budget, const Body& body) {
    return median_seconds(budget, [] {}, body);
}

}  // namespace almesh::bench
