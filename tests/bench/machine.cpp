#include "bench/machine.hpp"

#include "base/lanes.hpp"
#include "base/parallel.hpp"
#include "bench/timing.hpp"

namespace almesh::bench {
namespace {

constexpr double budget = 2;  // seconds per limit, long enough to meet a quiet moment
constexpr int chains = 12;  // independent sums: more than latency times the units of today's processors
constexpr int rounds = 1'000'000;

// Runs `rounds` multiply-adds on each chain; the result keeps the compiler from leaving them out.
double multiply_add() {
    Lanes sum[chains];
    for (int c = 0; c < chains; ++c) sum[c] = in_all_lanes(1 + 0.01 * c);
    const Lanes factor = in_all_lanes(0.999999), term = in_all_lanes(1e-6);
    for (int k = 0; k < rounds; ++k)
#pragma GCC unroll 12
        for (int c = 0; c < chains; ++c) sum[c] = sum[c] * factor + term;
    double total = 0;
    for (const Lanes& chain : sum) total += sum_of_lanes(chain);
    return total;
}

double peak(int threads) {
    std::vector<double> result(threads);
    const double seconds = best_seconds(budget, [&] {
#pragma omp parallel for schedule(static, 1)
        for (int t = 0; t < threads; ++t) result[t] = multiply_add();
    });
    return 2.0 * lanes * chains * rounds * threads / seconds;
}

constexpr int triad_size = 8'000'000;  // entries of each of the three arrays, 64 MB

double bandwidth() {
    std::vector<double> a(triad_size), b(triad_size, 1.0), c(triad_size, 2.0);
    const auto triad = [&](int i) { a[i] = b[i] + 3.0 * c[i]; };
    const double seconds = best_seconds(budget, [&] { parallel_for(triad_size, triad); });
    return 32.0 * triad_size / seconds;
}

}  // namespace

Machine measure_machine(Table& table) {
    Machine machine;
    machine.threads = {1};
    if (max_threads() > 1) machine.threads.push_back(max_threads());
    for (int threads : machine.threads) {
        set_threads(threads);
        machine.peak.push_back(peak(threads));
        machine.bandwidth.push_back(bandwidth());
        table.add("machine", "limits", threads, "peak", machine.peak.back() / 1e9, "GF/s");
        table.add("machine", "limits", threads, "bandwidth", machine.bandwidth.back() / 1e9, "GB/s");
    }
    table.print("machine", "The machine's own limits");
    return machine;
}

}  // namespace almesh::bench
