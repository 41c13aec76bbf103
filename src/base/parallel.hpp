// Loops and sums over threads that give the same bits for any number of threads.
//
// Floating-point addition is not associative: an OpenMP `reduction` adds per-thread partial sums and so depends on
// the number of threads. Here a sum is cut into fixed blocks of `sum_block` terms; each block is added by one
// thread from left to right, and the block sums are added in order. Without OpenMP everything runs serially.
#pragma once
#include <algorithm>
#include <exception>
#include <thread>
#include <vector>
#ifdef _OPENMP
#include <omp.h>
#endif

namespace almesh {

inline constexpr int sum_block = 1024;

// Loops with less work than this (in simple loop bodies) stay on one thread: starting a team costs more.
inline constexpr int parallel_work = 10000;

inline int max_threads() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

// 0 keeps what the environment (OMP_NUM_THREADS) says.
inline void set_threads([[maybe_unused]] int threads) {
#ifdef _OPENMP
    if (threads > 0) omp_set_num_threads(threads);
#endif
}

// Whether a team of threads is worth starting if it is asked for. A team of one is not: it costs an allocation and a
// call of the kernel, as much as a hundred small elements.
inline bool team_helps([[maybe_unused]] bool wanted) {
#ifdef _OPENMP
    return wanted && omp_get_max_threads() > 1 && !omp_in_parallel();
#else
    return false;
#endif
}

template <class Body>
void serial_for(int n, const Body& body) {
    for (int i = 0; i < n; ++i) body(i);
}

// body(i) for i in [0, n), each about `work` simple operations; iterations must write to disjoint places.
template <class Body>
void parallel_for(int n, const Body& body, double work = 10) {
    if (!team_helps(n > 1 && n * work >= 10.0 * parallel_work)) return serial_for(n, body);
#pragma omp parallel for schedule(static)
    for (int i = 0; i < n; ++i) body(i);
}

// parallel_for() where some iterations are much more work than others: dynamic scheduling in small chunks.
template <class Body>
void parallel_for_uneven(int n, const Body& body, double work = 10) {
    [[maybe_unused]] constexpr int chunks = 256;
    if (!team_helps(n > 1 && n * work >= 10.0 * parallel_work)) return serial_for(n, body);
#pragma omp parallel for schedule(dynamic, std::max(1, n / chunks))
    for (int i = 0; i < n; ++i) body(i);
}

// By a team if it is asked for, each iteration by the next thread that is free, beginning with the first.
template <class Body>
void parallel_tasks(int n, bool parallel, const Body& body) {
    if (!team_helps(parallel && n > 1)) return serial_for(n, body);
#pragma omp parallel for schedule(monotonic : dynamic, 1)
    for (int i = 0; i < n; ++i) body(i);
}

// The same where iterations may throw: all are tried, and then the exception of the first one that threw is thrown.
template <class Body>
void parallel_for_throwing(int n, const Body& body, double work = 10) {
    std::exception_ptr thrown;
    int first = n;
    parallel_for_uneven(n, [&](int i) {
        try {
            body(i);
        } catch (...) {
#pragma omp critical(almesh_first_exception)
            if (i < first) {
                first = i;
                thrown = std::current_exception();
            }
        }
    }, work);
    if (thrown) std::rethrow_exception(thrown);
}

// body() by every thread of a team, which shares out the `omp for` and `omp single` in it; by this thread alone where
// no team is asked for.
template <class Body>
void in_team([[maybe_unused]] bool wanted, const Body& body) {
#ifdef _OPENMP
    if (omp_in_parallel() || team_helps(wanted)) {  // inside a team: one of its own, of this thread
#pragma omp parallel if (wanted)
        body();
        return;
    }
#endif
    body();
}

// first() and second() at the same time, each on one thread and some `work` simple operations; an exception of the
// first goes before one of the second.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second, double work = 10.0 * parallel_work) {
    parallel_for_throwing(2, [&](int i) { i == 0 ? first() : second(); }, work);
}

// An int in an array that several threads read and change at a time, by the builtins of g++ and clang++: libc++ had no
// std::atomic_ref for long.
inline int atomic_value(const int& shared) { return __atomic_load_n(&shared, __ATOMIC_SEQ_CST); }
inline void set_atomic(int& shared, int value) { __atomic_store_n(&shared, value, __ATOMIC_SEQ_CST); }
inline int take_one_off(int& shared) { return __atomic_sub_fetch(&shared, 1, __ATOMIC_SEQ_CST); }  // what is left

// For short waits: polls, and yields the core to other threads if it takes long.
template <class Test>
void spin_wait(const Test& test) {
    constexpr int patience = 1000;
    for (int tries = 0; !test();) {
        if (tries < patience) ++tries;
        else std::this_thread::yield();
    }
}

// Sum of term(i), i in [0, n), in fixed blocks. work: simple operations that a term takes.
template <class Term>
double deterministic_sum(int n, const Term& term, double work = 10) {
    const auto block_sum = [n, &term](int b) {
        double sum = 0;
        for (int i = b * sum_block, end = std::min(n, i + sum_block); i < end; ++i) sum += term(i);
        return sum;
    };
    const int blocks = (n + sum_block - 1) / sum_block;
    if (blocks <= 1) return block_sum(0);
    // Kept between calls, so that nothing is allocated inside the Newton loop; term() must not call this function.
    thread_local std::vector<double> partial;
    partial.resize(blocks);
    double* const out = partial.data();
    parallel_for(blocks, [&](int b) { out[b] = block_sum(b); }, sum_block * work);
    double sum = 0;
    for (int b = 0; b < blocks; ++b) sum += out[b];
    return sum;
}

}  // namespace almesh
