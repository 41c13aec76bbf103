// Exercises of lesson 11. Answers go into 11.cpp and inputs/lessons/11-cost/exercises/; `make check-lesson-11` says
// which hold.
#pragma once
#include <vector>

namespace almesh::lessons {

// 11.1 alpha, where a cost t grows as n^alpha from (n_1, t_1) to (n_2, t_2).
double growth_exponent(double n_1, double t_1, double n_2, double t_2);

// 11.2 nnz(L) at n unknowns from what it is at n_1 and at n_2. The laws of nested dissection are those of large n;
// before, a term proportional to n counts, too: a n log n + b n in 2D, a n^{4/3} + b n in 3D, a and b not known.
double predicted_entries(int dim, double n_1, double entries_1, double n_2, double entries_2, double n);

// 11.3 The sum of v that has the same bits for any number of threads, of which each may take any part of the work.
// Pieces of `block` >= 1 values (the last may be shorter) are added up, each from its first value to its last. Then the
// sums of neighbours are added in pairs, the first to the second, the third to the fourth, ..., and what comes out
// again, until one number is left; where their number is odd the last one goes on to the next round as it is. 0 where v
// is empty.
double sum_in_pieces(const std::vector<double>& v, int block);

// 11.4 In 3D Cholesky takes a n^2 operations for the factor, and then c n^{4/3} for each right-hand side; conjugate
// gradients take, for each right-hand side, b n in each of n^{1/3} iterations (twice as many on a mesh with half the
// edge length). The n from which conjugate gradients take fewer for `count` right-hand sides of one matrix; 0 where
// they do for every n.
double crossover(double a, double b, double c, int count);

// 11.5 exercises/inexact.deck: the same mesh with at most 80 iterations of conjugate gradients.

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
