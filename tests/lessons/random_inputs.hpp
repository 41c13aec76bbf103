// Triangles, meshes and matrices that nobody can guess, for the checks of lessons 1 to 4; and how messages show them.
#pragma once
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/small_matrix.hpp"
#include "lessons/exercise.hpp"
#include "linalg/block_csr.hpp"

namespace almesh::lessons {

using Corners = std::array<Vec<2>, 3>;

inline Mat<2> turn(double angle) {
    return {{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}}};
}

template <int n>
Vec<n> times(const Mat<n>& A, const Vec<n>& x) {
    Vec<n> y{};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) y[i] += A[i][j] * x[j];
    return y;
}

template <int n>
Mat<n> scaled(double s, const Mat<n>& A) {
    Mat<n> B = A;
    for (auto& row : B)
        for (double& entry : row) entry *= s;
    return B;
}

// A rotation about any axis by any angle.
template <int n>
Mat<n> random_rotation() {
    Random& random = random_inputs();
    if constexpr (n == 2) {
        return turn(random.uniform(-3.1, 3.1));
    } else {
        const double a = random.uniform(-3, 3), b = random.uniform(-3, 3), c = random.uniform(-3, 3);
        const Mat<3> X = {{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}}};
        const Mat<3> Y = {{{std::cos(b), 0, std::sin(b)}, {0, 1, 0}, {-std::sin(b), 0, std::cos(b)}}};
        const Mat<3> Z = {{{std::cos(c), -std::sin(c), 0}, {std::sin(c), std::cos(c), 0}, {0, 0, 1}}};
        return multiply<3>(multiply<3>(X, Y), Z);
    }
}

// U diag(s) V' with rotations U and V; its determinant has the sign of the product of s.
template <int n>
Mat<n> random_with(const Vec<n>& s) {
    Mat<n> S{};
    for (int i = 0; i < n; ++i) S[i][i] = s[i];
    return multiply<n>(multiply<n>(random_rotation<n>(), S), random_rotation<n>());
}

// Counter-clockwise. Its first edge has the length `size` and is often next to an obtuse angle; the height on it is
// size * low to size * high.
inline Corners random_triangle(double size, double low = 0.1, double high = 2) {
    Random& random = random_inputs();
    const Vec<2> origin = {random.uniform(-3, 3), random.uniform(-3, 3)};
    const Vec<2> apex = {random.uniform(-0.7, 1.7), random.scale(low, high)};
    const Mat<2> rotation = random_rotation<2>();
    Corners corners;
    for (int i = 0; i < 3; ++i) {
        const Vec<2> at = times<2>(rotation, i == 0 ? Vec<2>{0, 0} : i == 1 ? Vec<2>{1, 0} : apex);
        corners[i] = {size * (origin[0] + at[0]), size * (origin[1] + at[1])};
    }
    return corners;
}

// The edges from the first corner, as columns.
inline Mat<2> edges(const Corners& t) {
    return {{{t[1][0] - t[0][0], t[2][0] - t[0][0]}, {t[1][1] - t[0][1], t[2][1] - t[0][1]}}};
}

struct Numbered {
    int nodes;
    std::vector<std::array<int, 3>> triangles;
};

// A grid of width x height cells cut into two along any diagonal, and nodes that belong to no triangle. Nodes,
// triangles and the corners of each come in any order.
inline Numbered random_mesh(int width, int height, int alone) {
    Random& random = random_inputs();
    std::vector<int> node((width + 1) * (height + 1) + alone);
    for (std::size_t i = 0; i < node.size(); ++i) node[i] = static_cast<int>(i);
    random.shuffle(node);
    Numbered mesh = {static_cast<int>(node.size()), {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int first = y * (width + 1) + x, turned = random.integer(0, 1);
            const int corner[] = {first, first + 1, first + width + 2, first + width + 1};
            for (int half : {turned, turned + 2}) {
                std::vector<int> t = {node[corner[half]], node[corner[(half + 1) % 4]], node[corner[(half + 2) % 4]]};
                random.shuffle(t);
                mesh.triangles.push_back({t[0], t[1], t[2]});
            }
        }
    random.shuffle(mesh.triangles);
    return mesh;
}

// Its pattern, with zeros.
inline BlockCsr matrix_of(const Numbered& mesh) {
    std::vector<int> cells;
    for (const auto& triangle : mesh.triangles) cells.insert(cells.end(), triangle.begin(), triangle.end());
    return matrix_of_cells(mesh.nodes, 2, cells, 3);
}

// Six digits: SEED has the others.
inline std::string in_short(double number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", number);
    return digits;
}

template <class Numbers>
std::string listed(const Numbers& numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "" : ", ") + in_short(number);
    return text;
}

// (a, b; c, d)
template <int n>
std::string shown(const Mat<n>& A) {
    std::string text = "(";
    for (int i = 0; i < n; ++i) text += (i ? "; " : "") + listed(A[i]);
    return text + ")";
}

}  // namespace almesh::lessons
