// Dense kernels of the multifrontal method: partial Cholesky factorisation of a front and the triangular solves with
// its columns.
//
// A front has m scalar rows, of which the first k are eliminated. Its panel holds the k columns of L, column-major
// with leading dimension front_ld(m): rows m .. ld-1 are zero, and entries above the diagonal are undefined. Its
// update matrix -L21 L21' has m - k columns and rows k .. m-1; it starts at row update_row(k), so that rows are aligned
// with the panel's, and only its lower triangle is set.
//
// Everything works on tiles of 8-row packs x 8 columns that stay in registers. The operations on an entry and their
// order depend on its place alone, so results do not depend on the number of threads.
#pragma once
#include <cstddef>

namespace almesh {

struct Front {
    int m = 0, k = 0;
    double* panel = nullptr;   // front_ld(m) x k
    double* update = nullptr;  // update_ld(m, k) x (m - k); nothing is read if m == k
};

constexpr int front_ld(int m) { return (m + 7) / 8 * 8; }
constexpr int update_row(int k) { return k / 8 * 8; }
constexpr int update_ld(int m, int k) { return front_ld(m) - update_row(k); }
constexpr std::size_t panel_size(int m, int k) { return static_cast<std::size_t>(front_ld(m)) * k; }
constexpr std::size_t update_size(int m, int k) { return static_cast<std::size_t>(update_ld(m, k)) * (m - k); }

// Overwrites the assembled panel by the columns of L and writes the update matrix. smallest[j]: pivot j must be larger
// than this. Returns -1, or the first column whose pivot is not; the front is then unusable. parallel: may use a team
// of threads of its own (not to be called so from inside one).
int factor_front(const Front& front, const double* smallest, bool parallel);

// w (length m): w1 <- L11^{-1} w1, w2 <- w2 - L21 w1. parallel: as above.
void solve_forward(const Front& front, double* w, bool parallel);

// w1 <- L11^{-T} (w1 - L21' w2).
void solve_backward(const Front& front, double* w, bool parallel);

}  // namespace almesh
