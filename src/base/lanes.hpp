// SIMD arithmetic on `lanes` numbers at once, one per element of a batch, by the vector extension that g++ and clang++
// share: + - * / and the comparisons act lane by lane, and a scalar operand is broadcast to all lanes. This file adds
// loads, stores and what the extension has no operator for, and the same functions of a single double, so that a
// formula is written once for both.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace almesh {

// The registers of the machine the code is compiled for: AVX-512, AVX, or what every 64-bit processor has.
#if defined(__AVX512F__)
inline constexpr int lanes = 8;
#elif defined(__AVX__)
inline constexpr int lanes = 4;
#else
inline constexpr int lanes = 2;
#endif

typedef double Lanes __attribute__((vector_size(lanes * sizeof(double))));
typedef std::int64_t LaneBits __attribute__((vector_size(lanes * sizeof(double))));  // comparisons: all bits or none

// Four doubles, however wide the registers are: a row of a 3 x 3 block and a pad.
typedef double Four __attribute__((vector_size(4 * sizeof(double))));

// To and from memory of any alignment. Four goes by reference: not every machine can return that many in a register.
inline Lanes load(const double* from) {
    Lanes value;
    std::memcpy(&value, from, sizeof value);
    return value;
}
inline void load(const double* from, Four& to) { std::memcpy(&to, from, sizeof to); }
inline void load(const float* from, Four& to) {
    typedef float FourFloats __attribute__((vector_size(4 * sizeof(float))));
    FourFloats value;
    std::memcpy(&value, from, sizeof value);
    to = Four{value[0], value[1], value[2], value[3]};  // one instruction; __builtin_convertvector() g++ makes five of
}
inline void store(Lanes value, double* to) { std::memcpy(to, &value, sizeof value); }

inline Lanes in_all_lanes(double value) { return Lanes{} + value; }

inline Lanes select(LaneBits condition, Lanes yes, Lanes no) { return condition ? yes : no; }
inline Lanes select(LaneBits condition, Lanes yes, double no) { return select(condition, yes, in_all_lanes(no)); }
inline double select(bool condition, double yes, double no) { return condition ? yes : no; }

inline bool any(LaneBits condition) {
    std::int64_t bits = 0;
    for (int l = 0; l < lanes; ++l) bits |= condition[l];
    return bits != 0;
}

inline double sum_of_lanes(Lanes v, double sum = 0) {
    for (int l = 0; l < lanes; ++l) sum += v[l];
    return sum;
}

// Sums are taken as if there were this many lanes, so that their bits do not depend on the machine compiled for.
inline constexpr int most_lanes = 8, batches_per_row = most_lanes / lanes;

// The sum of numbers of which `lanes` come at a time, from a multiple of most_lanes on.
class SumOfBatches {
public:
    void add(Lanes values, int batch) { sum_[batch % batches_per_row] += values; }
    double total() const {
        double sum = 0;
        for (const Lanes& part : sum_) sum = sum_of_lanes(part, sum);
        return sum;
    }

private:
    Lanes sum_[batches_per_row] = {};
};

// Exchanges off-diagonal blocks of `step` lanes: a_i keeps its place where bit `step` of i is 0, and b_i where it is 1.
template <int step, int... l>
void exchange_blocks(Lanes& a, Lanes& b, std::integer_sequence<int, l...>) {
    const Lanes first = a, second = b;
#ifdef __clang__
    a = __builtin_shufflevector(first, second, (l & step ? l - step + lanes : l)...);
    b = __builtin_shufflevector(first, second, (l & step ? l + lanes : l + step)...);
#else
    a = __builtin_shuffle(first, second, LaneBits{(l & step ? l - step + lanes : l)...});
    b = __builtin_shuffle(first, second, LaneBits{(l & step ? l + lanes : l + step)...});
#endif
}

// Transposes lanes x lanes numbers: row i is rows[i]. log2(lanes) rounds of exchanges.
template <int step = lanes / 2>
void transpose_lanes(Lanes (&rows)[lanes]) {
    for (int i = 0; i < lanes; ++i)
        if (!(i & step)) exchange_blocks<step>(rows[i], rows[i + step], std::make_integer_sequence<int, lanes>());
    if constexpr (step > 1) transpose_lanes<step / 2>(rows);
}

constexpr int whole_registers(int count) { return (count + lanes - 1) / lanes * lanes; }

// `count` numbers of each lane after those of the lane before: those of lane l from l * whole_registers(count) on. Both
// arrays: whole_registers(count) registers, whose numbers from `count` on have no meaning.
inline const double* separate_lanes(const Lanes* numbers, int count, Lanes* separate) {
    const int registers = whole_registers(count) / lanes;
    for (int k = 0; k < registers; ++k) {
        Lanes rows[lanes];
        for (int r = 0; r < lanes; ++r) rows[r] = numbers[k * lanes + r];
        transpose_lanes(rows);
        for (int l = 0; l < lanes; ++l) separate[l * registers + k] = rows[l];
    }
    return reinterpret_cast<const double*>(separate);
}

inline Lanes abs(Lanes v) { return select(v < 0, -v, v); }
inline Lanes max(Lanes a, Lanes b) { return select(a < b, b, a); }

// Compiles to one instruction where the compiler need not set errno (-fno-math-errno).
inline Lanes sqrt(Lanes v) {
    Lanes root = v;
    for (int l = 0; l < lanes; ++l) root[l] = std::sqrt(v[l]);
    return root;
}
inline double sqrt(double v) { return std::sqrt(v); }

// v^{-1/3} for normal v > 0, to a few units in the last place; undefined otherwise. The bits
// of a double are nearly its logarithm: minus a third of them is the first guess, at most 3.5 % off, and two steps of
// order four for y^{-3} = v follow.
inline Lanes inverse_cbrt(Lanes v) {
    constexpr double guess = 6142611753438024704.0;  // 4/3 of the bits of 1, less what the largest error is least for
    const Lanes bits = __builtin_convertvector(reinterpret_cast<LaneBits>(v), Lanes);
    Lanes y = reinterpret_cast<Lanes>(__builtin_convertvector(guess - bits * (1.0 / 3), LaneBits));
    for (int step = 0; step < 2; ++step) {
        const Lanes h = 1 - v * y * y * y;
        y += y * h * (1.0 / 3 + h * (2.0 / 9 + h * (14.0 / 81)));
    }
    return y;
}
inline double inverse_cbrt(double v) { return 1 / std::cbrt(v); }

}  // namespace almesh
