// Solutions of the exercises of lesson 3.
#include <algorithm>
#include <cmath>
#include <set>

#include "lessons/exercises/03.hpp"

namespace almesh::lessons {

std::array<Vec<2>, 3> hat_gradients(const std::array<Vec<2>, 3>& y) {
    const Mat<2> A = {{{y[1][0] - y[0][0], y[2][0] - y[0][0]}, {y[1][1] - y[0][1], y[2][1] - y[0][1]}}};
    const Mat<2> B = inverse<2>(A);
    return {{{-B[0][0] - B[1][0], -B[0][1] - B[1][1]}, B[0], B[1]}};
}

std::array<double, 3> cotangents(const std::array<Vec<2>, 3>& gradient) {
    // A gradient is perpendicular to the opposite edge: where two edges make an angle, their gradients make 180 degrees
    // less that angle. All three pairs span the same area, as they add up to zero.
    std::array<double, 3> cot;
    for (int i = 0; i < 3; ++i) {
        const Vec<2>&u = gradient[(i + 1) % 3], &v = gradient[(i + 2) % 3];
        cot[i] = -(u[0] * v[0] + u[1] * v[1]) / std::abs(u[0] * v[1] - u[1] * v[0]);
    }
    return cot;
}

std::vector<int> row_offsets(int nodes, const Triangles& triangles) {
    std::vector<std::set<int>> neighbours(nodes);
    for (int i = 0; i < nodes; ++i) neighbours[i].insert(i);
    for (const auto& triangle : triangles)
        for (const int i : triangle) neighbours[i].insert(triangle.begin(), triangle.end());
    std::vector<int> row = {0};
    for (const auto& of_node : neighbours) row.push_back(row.back() + static_cast<int>(of_node.size()));
    return row;
}

std::vector<double> assemble(int nodes, const Triangles& triangles, const std::vector<std::array<Vec<2>, 3>>& local) {
    std::vector<double> g(2 * nodes, 0.0);
    for (std::size_t e = 0; e < triangles.size(); ++e)
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 2; ++a) g[2 * triangles[e][i] + a] += local[e][i][a];
    return g;
}

std::vector<double> assemble_tied(const std::vector<int>& leader, const Triangles& triangles,
                                  const std::vector<std::array<Vec<2>, 3>>& local) {
    Triangles of_leaders = triangles;  // what a triangle says to a node it says to the node that moves it
    for (auto& triangle : of_leaders)
        for (int& i : triangle)
            while (leader[i] != i) i = leader[i];
    return assemble(static_cast<int>(leader.size()), of_leaders, local);
}

void add_to(BlockCsr& H, const std::array<int, 3>& triangle, const std::array<std::array<double, 6>, 6>& local) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double* const block = H.block(H.find(triangle[i], triangle[j]));
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b) block[2 * a + b] += local[2 * i + a][2 * j + b];
        }
}

std::array<std::vector<double>, 4> kernel(const std::vector<double>& x) {
    std::array<std::vector<double>, 4> v;  // two translations, rotation, scaling
    v.fill(std::vector<double>(x.size(), 0.0));
    for (std::size_t i = 0; i < x.size(); i += 2) {
        v[0][i] = 1;
        v[1][i + 1] = 1;
        v[2][i] = -x[i + 1];
        v[2][i + 1] = x[i];
    }
    v[3] = x;
    return v;
}

std::vector<int> colours(const BlockCsr& H) {
    std::vector<int> colour(H.n, -1), taken(H.n, -1);  // taken[c]: the last node that must not have colour c
    for (int i = 0; i < H.n; ++i) {
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int l = H.row[H.col[k]]; l < H.row[H.col[k] + 1]; ++l)
                if (const int c = colour[H.col[l]]; c >= 0) taken[c] = i;
        int& own = colour[i] = 0;
        while (taken[own] == i) ++own;
    }
    return colour;
}

void difference_hessian(const Gradient& gradient, const std::vector<double>& x, double h, BlockCsr& H) {
    const std::vector<int> colour = colours(H);
    const int count = 1 + *std::max_element(colour.begin(), colour.end());
    for (int c = 0; c < count; ++c)
        for (int b = 0; b < 2; ++b) {
            std::vector<double> right = x, left = x;
            for (int j = 0; j < H.n; ++j)
                if (colour[j] == c) {
                    right[2 * j + b] += h;
                    left[2 * j + b] -= h;
                }
            const std::vector<double> g_right = gradient(right), g_left = gradient(left);
            for (int i = 0; i < H.n; ++i)
                for (int k = H.row[i]; k < H.row[i + 1]; ++k)  // one at most of the row's nodes has moved
                    if (colour[H.col[k]] == c)
                        for (int a = 0; a < 2; ++a)
                            H.block(k)[2 * a + b] = (g_right[2 * i + a] - g_left[2 * i + a]) / (2 * h);
        }
}

}  // namespace almesh::lessons
