// Sums over the quadrature points of products of two gradients of the basis, by moments.
//
// The basis of degree p in powers of the barycentric coordinates, l^a = l_0^a_0 ... l_n^a_n with |a| = p, is
// N_i = sum_a T_ai l^a, and grad l^a = sum_v a_v l^(a - e_v) grad l_v. So for n x n blocks C_kl(q) of every pair of
// directions k, l
//
//     K_ij = sum_q sum_kl dN_i/dxi_k C_kl dN_j/dxi_l = sum_ab T_ai T_bj K'_ab,
//     K'_ab = sum_vw a_v b_w D^vw_(a + b - e_v - e_w),   D^vw_c = sum_q l(q)^c grad l_v . C(q) . grad l_w,
//
// and the points are summed up for the moments D, of which there are as many as powers of degree 2 p - 2, instead of
// for all pairs of nodes (Ainsworth, Andriamaro, Davydov, SIAM J. Sci. Comput. 33, 2011). For the tetrahedra of
// degrees 2 to 4 and their rules that is a third of the operations.
#pragma once
#include <vector>

namespace almesh {

// What this takes, the same for all elements: which terms K' has and T.
struct GradientProducts {
    struct Term {
        int moment, pair;  // of D^vw_c: c, and the place of v <= w in the rows of the upper triangle
        bool transposed;   // it is D^wv that is summed up for: v > w
        double factor;     // a_v b_w
    };
    struct Entry {
        int row;
        double value;
    };

    int nodes = 0, moments = 0, pairs = 0;  // m, powers of degree 2 p - 2, (n + 1) (n + 2) / 2
    // Of K'_ab, b <= a: the terms term_start[k] .. term_start[k + 1] - 1, k = a (a + 1) / 2 + b.
    std::vector<int> term_start{0};
    std::vector<Term> term;
    // Of column i of T, but zeros: the entries entry_start[i] .. entry_start[i + 1] - 1.
    std::vector<int> entry_start{0};
    std::vector<Entry> entry;

    GradientProducts() = default;  // of cells that are no simplices: none
    // n: dimension, 2 or 3. degree: p >= 1.
    GradientProducts(int n, int degree);
};

// The place of v <= w in the rows of the upper triangle of a size x size matrix.
constexpr int upper_place(int size, int v, int w) { return v * size - v * (v + 1) / 2 + w; }

}  // namespace almesh
