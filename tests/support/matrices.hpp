// Matrices for the tests of linalg/, built in code, and a dense Cholesky to compare with.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "linalg/block_csr.hpp"

namespace almesh {

using Edges = std::vector<std::pair<int, int>>;

// Symmetric positive definite: random d x d blocks on the edges, diagonal blocks that dominate them by `excess`.
inline BlockCsr random_spd(int n, int d, const Edges& edges, double excess = 0.1, unsigned seed = 1) {
    std::vector<int> cells;
    for (const auto& [i, j] : edges) {
        cells.push_back(i);
        cells.push_back(j);
    }
    BlockCsr A = matrix_of_cells(n, d, cells, 2);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const auto& [i, j] : edges)
        for (int r = 0; r < d; ++r)
            for (int c = 0; c < d; ++c) {
                const double v = uniform(random);
                A.block(A.find(i, j))[r * d + c] = A.block(A.find(j, i))[c * d + r] = v;
            }
    for (int i = 0; i < n; ++i)
        for (int r = 0; r < d; ++r)
            for (int c = 0; c < r; ++c) {
                double* const block = A.block(A.find(i, i));
                block[r * d + c] = block[c * d + r] = uniform(random);
            }
    for (int i = 0; i < n; ++i)
        for (int r = 0; r < d; ++r) {
            double sum = excess;
            for (int k = A.row[i]; k < A.row[i + 1]; ++k)
                for (int c = 0; c < d; ++c)
                    if (A.col[k] != i || c != r) sum += std::abs(A.block(k)[r * d + c]);
            A.block(A.find(i, i))[r * d + r] = sum;
        }
    return A;
}

inline Edges path(int n) {
    Edges edges;
    for (int i = 0; i + 1 < n; ++i) edges.push_back({i, i + 1});
    return edges;
}

inline Edges star(int n) {  // the arrow matrix: vertex 0 next to all others
    Edges edges;
    for (int i = 1; i < n; ++i) edges.push_back({0, i});
    return edges;
}

inline Edges complete(int n) {
    Edges edges;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) edges.push_back({i, j});
    return edges;
}

// Triangulated grid: 6 neighbours.
inline Edges grid(int nx, int ny) {
    Edges edges;
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            const int v = y * nx + x;
            if (x + 1 < nx) edges.push_back({v, v + 1});
            if (y + 1 < ny) edges.push_back({v, v + nx});
            if (x + 1 < nx && y + 1 < ny) edges.push_back({v, v + nx + 1});
        }
    return edges;
}

inline Edges grid_3d(int m) {
    Edges edges;
    for (int z = 0; z < m; ++z)
        for (int y = 0; y < m; ++y)
            for (int x = 0; x < m; ++x) {
                const int v = (z * m + y) * m + x;
                if (x + 1 < m) edges.push_back({v, v + 1});
                if (y + 1 < m) edges.push_back({v, v + m});
                if (z + 1 < m) edges.push_back({v, v + m * m});
                if (x + 1 < m && y + 1 < m && z + 1 < m) edges.push_back({v, v + 1 + m + m * m});
            }
    return edges;
}

inline Edges random_edges(int n, int count, unsigned seed) {
    std::mt19937 random(seed);
    Edges edges;
    while (static_cast<int>(edges.size()) < count) {
        const int i = static_cast<int>(random() % n), j = static_cast<int>(random() % n);
        if (i != j) edges.push_back({i, j});
    }
    return edges;
}

// Cells of a triangulated grid of degree 4: 15 nodes each, on a lattice of (4 nx + 1) x (4 ny + 1) nodes.
inline std::vector<int> quartic_cells(int nx, int ny) {
    std::vector<int> cells;
    const int width = 4 * nx + 1;
    for (int y = 0; y < 4 * ny; y += 4)
        for (int x = 0; x < 4 * nx; x += 4)
            for (int upper = 0; upper < 2; ++upper)
                for (int j = 0; j <= 4; ++j)
                    for (int i = 0; i + j <= 4; ++i)
                        cells.push_back(upper ? (y + 4 - j) * width + x + 4 - i : (y + j) * width + x + i);
    return cells;
}

inline std::vector<double> random_vector(int n, unsigned seed = 3) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<double> x(n);
    for (double& v : x) v = uniform(random);
    return x;
}

struct Dense {
    int n = 0;
    std::vector<double> value;
    double& operator()(int i, int j) { return value[static_cast<std::size_t>(i) * n + j]; }
    double operator()(int i, int j) const { return value[static_cast<std::size_t>(i) * n + j]; }
};

// order[new] = old, of the block rows; empty for the natural one.
inline Dense to_dense(const BlockCsr& A, const std::vector<int>& order = {}) {
    std::vector<int> position(A.n);
    for (int i = 0; i < A.n; ++i) position[order.empty() ? i : order[i]] = i;
    Dense M{A.size(), std::vector<double>(static_cast<std::size_t>(A.size()) * A.size(), 0.0)};
    for (int i = 0; i < A.n; ++i)
        for (int k = A.row[i]; k < A.row[i + 1]; ++k)
            for (int r = 0; r < A.d; ++r)
                for (int c = 0; c < A.d; ++c)
                    M(position[i] * A.d + r, position[A.col[k]] * A.d + c) = A.block(k)[r * A.d + c];
    return M;
}

// Overwrites the lower triangle by L; returns the first column whose pivot is not positive, or -1.
inline int dense_cholesky(Dense& M) {
    for (int j = 0; j < M.n; ++j) {
        for (int k = 0; k < j; ++k)
            for (int i = j; i < M.n; ++i) M(i, j) -= M(i, k) * M(j, k);
        if (!(M(j, j) > 0)) return j;
        const double root = std::sqrt(M(j, j));
        for (int i = j; i < M.n; ++i) M(i, j) /= root;
    }
    return -1;
}

inline std::vector<double> dense_solve(const Dense& L, std::vector<double> x) {
    for (int j = 0; j < L.n; ++j) {
        x[j] /= L(j, j);
        for (int i = j + 1; i < L.n; ++i) x[i] -= L(i, j) * x[j];
    }
    for (int j = L.n - 1; j >= 0; --j) {
        for (int i = j + 1; i < L.n; ++i) x[j] -= L(i, j) * x[i];
        x[j] /= L(j, j);
    }
    return x;
}

inline double max_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

inline bool is_permutation(const std::vector<int>& order) {
    std::vector<char> seen(order.size(), 0);
    for (int v : order) {
        if (v < 0 || v >= static_cast<int>(order.size()) || seen[v]) return false;
        seen[v] = 1;
    }
    return true;
}

}  // namespace almesh
