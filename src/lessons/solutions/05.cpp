// Solutions of the exercises of lesson 5.
#include "lessons/exercises/05.hpp"

#include <algorithm>
#include <cmath>

namespace almesh::lessons {

Mat<3> laplacian_of_triangle(const std::array<Vec<2>, 3>& vertex) {
    // The edge opposite to vertex i, turned by 90 degrees, is 2 |e| grad N_i.
    Vec<2> edge[3];
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a) edge[i][a] = vertex[(i + 2) % 3][a] - vertex[(i + 1) % 3][a];
    const double area = (edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0]) / 2;
    Mat<3> K{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K[i][j] = (edge[i][0] * edge[j][0] + edge[i][1] * edge[j][1]) / (4 * area);
    return K;
}

double reach_of_translation(double r, double R) { return r * std::log(R / r); }

double determinant_of_turn(double theta, double R, double r) {
    const double s = (R * R / (r * r) - 1) / (R * R - 1), slope = -2 * R * R / (r * r * r) / (R * R - 1);
    const double c = std::cos(theta) - 1, q = std::sin(theta);  // Q - I = (c, -q; q, c)
    const double along = s + r * slope;                         // at (r, 0): F e_1 = e_1 + along (Q - I) e_1,
    return (1 + along * c) * (1 + s * c) + along * q * s * q;   // and F e_2 = e_2 + s (Q - I) e_2
}

double turn_of_profile(double slope) {
    return slope <= -0.5 ? std::acos(1 + 1 / slope) : INFINITY;  // det F = 1 + slope (1 - cos theta)
}

double reach_with_stiffness(double p, double R) {
    // u' = -d r^(p-1) / integral of r^(p-1): the steepest at r = 1 if p < 1, at r = R if p > 1.
    const double integral = p == 0 ? std::log(R) : std::expm1(p * std::log(R)) / p;
    return integral / std::max(1.0, std::pow(R, p - 1));
}

namespace {

struct Triangle {
    double area;
    Vec<2> grad[3];  // of the hat functions
};

Triangle triangle(const Extension& mesh, const std::array<int, 3>& node) {
    const Vec<2>&a = mesh.x[node[0]], &b = mesh.x[node[1]], &c = mesh.x[node[2]];
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return {twice / 2,
            {{(b[1] - c[1]) / twice, (c[0] - b[0]) / twice},
             {(c[1] - a[1]) / twice, (a[0] - c[0]) / twice},
             {(a[1] - b[1]) / twice, (b[0] - a[0]) / twice}}};
}

}  // namespace

double reach_of_mesh(const Extension& mesh) {
    const std::size_t n = mesh.x.size();
    std::vector<double> K(n * n, 0.0), b(n, 0.0), u;  // u: of a motion by 1
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e) {
        const std::array<int, 3>& node = mesh.triangles[e];
        const auto [area, grad] = triangle(mesh, node);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                if (!mesh.moved[node[i]] && !mesh.held[node[i]])
                    K[node[i] * n + node[j]] +=
                        mesh.stiffness[e] * area * (grad[i][0] * grad[j][0] + grad[i][1] * grad[j][1]);
    }
    for (std::size_t i = 0; i < n; ++i)
        if (mesh.moved[i] || mesh.held[i]) K[i * n + i] = 1, b[i] = mesh.moved[i] ? 1 : 0;
    solve_dense(K, b, u);

    double reach = INFINITY;  // det F = 1 + d du/dx on each triangle
    for (const auto& node : mesh.triangles) {
        double slope = 0;
        for (int i = 0; i < 3; ++i) slope += u[node[i]] * triangle(mesh, node).grad[i][0];
        if (slope < 0) reach = std::min(reach, -1 / slope);
    }
    return reach;
}

}  // namespace almesh::lessons
