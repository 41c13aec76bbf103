// Lesson 3: the energy of a mesh, its gradient and its Hessian, one triangle after the other:
//
//     E(x) = sum over triangles e of  |e| W(F_e),   W = eta^2,   F_e = sum_i x_i (grad N_i)^T
//
// on the unit square, with what a Hessian should be checked for: slopes, symmetry, kernel, another assembly.
//
//   03_assembly [refinements] [transposed]      transposed: with a mistake in the Hessian
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "io/vtk.hpp"
#include "lessons/eta_squared.hpp"
#include "lessons/matrix_market.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/square.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

bool transposed = false;

struct Triangle {
    int node[3];
    double area;     // of the ideal triangle
    Vec<2> grad[3];  // of the hat functions on it
};

// grad N_1 and grad N_2 are the rows of A^{-1}, A = (y_1 - y_0, y_2 - y_0); the three add up to 0.
Triangle triangle(const Mesh& mesh, int e) {
    const int* const node = mesh.element(e);
    const Mat<2> A = straight_jacobian<2>(node, mesh.x), B = inverse<2>(A);
    return {{node[0], node[1], node[2]}, determinant(A) / 2, {{-B[0][0] - B[1][0], -B[0][1] - B[1][1]}, B[0], B[1]}};
}

Mat<2> jacobian(const Triangle& t, const Vector& x) {
    Mat<2> F{};
    for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 2; ++a)
            for (int k = 0; k < 2; ++k) F[a][k] += x[2 * t.node[i] + a] * t.grad[i][k];
    return F;
}

double energy(const Mesh& mesh, const Vector& x) {
    double E = 0;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Triangle t = triangle(mesh, e);
        E += t.area * W(jacobian(t, x));
    }
    return E;
}

Vector gradient(const Mesh& mesh, const Vector& x) {
    Vector g(x.size(), 0.0);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Triangle t = triangle(mesh, e);
        const Mat<2> P = W_F(jacobian(t, x));
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 2; ++a)
                for (int k = 0; k < 2; ++k) g[2 * t.node[i] + a] += t.area * P[a][k] * t.grad[i][k];
    }
    return g;
}

// Row a, column b of block (i, j): how entry a of the gradient at node i changes with coordinate b of node j, which
// changes F along H = e_b (grad N_j)^T.
BlockCsr hessian(const Mesh& mesh, const Vector& x) {
    BlockCsr K = matrix_of_cells(mesh.nodes(), 2, mesh.elements, 3);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Triangle t = triangle(mesh, e);
        for (int j = 0; j < 3; ++j)
            for (int b = 0; b < 2; ++b) {
                Mat<2> H{};
                H[b] = t.grad[j];
                const Mat<2> Q = W_FF(jacobian(t, x), H);
                for (int i = 0; i < 3; ++i)
                    for (int a = 0; a < 2; ++a)
                        for (int k = 0; k < 2; ++k)
                            K.block(K.find(t.node[i], t.node[j]))[transposed ? 2 * b + a : 2 * a + b] +=
                                t.area * Q[a][k] * t.grad[i][k];
            }
    }
    return K;
}

// Errors of the Taylor polynomials of E along v, and the orders that halving h shows.
void slope_test(const Mesh& mesh, const Vector& x, const Vector& v) {
    const double E = energy(mesh, x), first = dot(gradient(mesh, x), v), second = dot(v, product(hessian(mesh, x), v));
    const auto errors = [&](double h) -> Vec<2> {
        const double change = energy(mesh, sum(x, h, v)) - E;
        return {std::abs(change - h * first), std::abs(change - h * first - 0.5 * h * h * second)};
    };
    std::printf("\n        h   degree 1  order   degree 2  order\n");
    for (double h = 0.1; h > 2e-3; h /= 2) {
        const Vec<2> now = errors(h), next = errors(h / 2);
        std::printf("%9.3e %10.3e %6.2f %10.3e %6.2f\n", h, now[0], std::log2(now[0] / next[0]), now[1],
                    std::log2(now[1] / next[1]));
    }
}

// t: a translation; J turns by 90 degrees, so J x is the start of a rotation of the mesh, and x of a scaling.
void symmetry_and_kernel(const char* name, const Mesh& mesh, const Vector& x, const Vector& v) {
    const BlockCsr K = hessian(mesh, x);
    const Vector g = gradient(mesh, x), t(x.size(), 1.0), Jx = turned(x), Jv = turned(v);
    std::printf("%-8s %12.1e", name, std::abs(dot(v, product(K, Jv)) - dot(Jv, product(K, v))) / norm_inf(K));
    for (const Vector& r :
         {product(K, t), product(K, Jx), product(K, x), sum(product(K, Jx), -1, turned(g)), sum(product(K, x), 1, g)})
        std::printf(" %9.1e", norm_inf(r) / norm_inf(K));
    std::printf("\n");
}

}  // namespace

int main(int count, char** argument) {
    int refinements = 1;
    for (int i = 1; i < count; ++i)
        if (std::string(argument[i]) == "transposed") transposed = true;
        else refinements = std::atoi(argument[i]);
    const Mesh mesh = unit_square(refinements);
    Vector x = mesh.x, v = mesh.x;  // positions, and a direction in which they move
    for (int i = 0; i < mesh.nodes(); ++i) {
        const double X = mesh.x[2 * i], Y = mesh.x[2 * i + 1];
        x[2 * i] = X + 0.2 * std::sin(3 * Y), x[2 * i + 1] = Y + 0.1 * std::sin(4 * X);
        v[2 * i] = X * Y, v[2 * i + 1] = std::cos(3 * X) - Y * Y;
    }
    const BlockCsr K = hessian(mesh, x);
    std::printf("%d triangles, %d nodes: %d blocks of 2 x 2, %.1f in a row, %.2f %% of the full matrix\n",
                mesh.element_count(), K.n, K.blocks(), 1.0 * K.blocks() / K.n, 100.0 * K.blocks() / K.n / K.n);
    slope_test(mesh, x, v);
    std::printf("\n         v.KJv-Jv.Kv       K t      K Jx       K x   K Jx-Jg     K x+g\n");
    symmetry_and_kernel("ideal", mesh, mesh.x, v);
    symmetry_and_kernel("deformed", mesh, x, v);

    PlainEnergy plain(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr of_plain = plain.hessian_pattern();
    plain.add_hessian(x, HessianKind::full, of_plain);
    std::printf("E = %.6f, by the program %.6f; relative difference of K v %.1e\n", energy(mesh, x), plain.energy(x),
                norm_inf(sum(product(K, v), -1, product(of_plain, v))) / norm_inf(product(K, v)));

    if (count > 1) return 0;
    std::filesystem::create_directories("outputs/lessons/03-assembly");
    write_vtk("outputs/lessons/03-assembly/square.vtk", {"square", 2, 1, x, mesh.elements, 2, {}, {}, {}});
    write_file("outputs/lessons/03-assembly/hessian.mtx", matrix_text(K));
}
