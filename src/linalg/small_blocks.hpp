// Products of d x d blocks with vectors, in registers of four numbers: a row of a 3 x 3 block and one number beside it,
// which is made to meet a zero. Sums of many such products keep one partial sum per column of the blocks, so that no
// addition waits for the one before it.
#pragma once

namespace almesh {

typedef double Four __attribute__((vector_size(4 * sizeof(double))));
typedef double FourDoublesInMemory __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));
typedef float FourFloatsInMemory __attribute__((vector_size(4 * sizeof(float)), aligned(sizeof(float)), may_alias));

// Four numbers that begin anywhere. By reference: not every machine can pass so many in a register.
inline const FourDoublesInMemory& four(const double* p) { return *reinterpret_cast<const FourDoublesInMemory*>(p); }
inline const FourFloatsInMemory& four(const float* p) { return *reinterpret_cast<const FourFloatsInMemory*>(p); }

// The sum over k of B_k x_k, B_k d x d row-major.
template <int d>
class SumOfProducts {
public:
    void add(const double* B, const double* x) {
        for (int r = 0; r < d; ++r)
            for (int c = 0; c < d; ++c) sum_[r][c] += B[r * d + c] * x[c];
    }
    double entry(int r) const {
        double sum = 0;
        for (int c = 0; c < d; ++c) sum += sum_[r][c];
        return sum;
    }

private:
    double sum_[d][d] = {};
};

// Rows 0 and 1 with the number after, row 2 with the number before it, so that nothing outside B is read.
template <>
class SumOfProducts<3> {
public:
    void add(const double* B, const double* x) {
        const Four first = {x[0], x[1], x[2], 0}, last = {0, x[0], x[1], x[2]};
        sum_[0] += four(B) * first;
        sum_[1] += four(B + 3) * first;
        sum_[2] += four(B + 5) * last;
    }
    double entry(int r) const { return sum_[r][r / 2] + sum_[r][r / 2 + 1] + sum_[r][r / 2 + 2]; }

private:
    Four sum_[3] = {};
};

}  // namespace almesh
