// Exercises of lesson 11. Answers go into 11.cpp and inputs/lessons/11-cost/exercises/; `make check-lesson-11` says
// which hold.
#pragma once
#include <vector>

namespace almesh::lessons {

// 11.1 alpha, where a cost t grows as n^alpha from (n_1, t_1) to (n_2, t_2).
double growth_exponent(double n_1, double t_1, double n_2, double t_2);

// 11.2 nnz(L) at n unknowns from what it is at n_0, with the laws of nested dissection: proportional to n log n in 2D
// and to n^{4/3} in 3D.
double predicted_entries(int dim, double n_0, double entries_0, double n);

// 11.3 The sum of v that has the same bits for any number of threads: that of pieces of `block` values (the last may be
// shorter), each from its first value to its last, added in their order.
double sum_in_pieces(const std::vector<double>& v, int block);

// 11.4 In 3D Cholesky takes a n^2 operations, conjugate gradients b n for each of n^{1/3} iterations (twice as many on
// a mesh with half the edge length). The n from which conjugate gradients take fewer.
double crossover(double a, double b);

// 11.5 exercises/inexact.deck: the same mesh with at most half of the conjugate gradients' iterations.

// 11.6 y = A x, row by row, from memory through a cache. How many lines of x are loaded: line k of it has the entries
// 8 k to 8 k + 7, `columns` are the entries in the order of their use, and the cache, empty at first, keeps the
// `capacity` lines that were used last.
long lines_loaded(const std::vector<int>& columns, int capacity);

// The flops per second of that product, no more than `peak`, and no more than the bytes allow that come and go in a
// second (`bandwidth`): of A 8 for each number, 4 for the column of each block and the beginning of each row of
// blocks; 64 for each line of x; 8 for each number of y, which is written only.
struct SparseProduct {
    double rows, blocks;  // rows of blocks, and blocks, of block x block numbers each
    int block;
    double lines;         // of x that are loaded
};
double product_rate(const SparseProduct& product, double peak, double bandwidth);

}  // namespace almesh::lessons
