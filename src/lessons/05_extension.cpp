// Lesson 5: the boundary is set on its target, and the displacement of the nodes inside is a harmonic function,
//
//     Laplace u = 0 inside,  u = g - x on the boundary,     K_ij = sum over triangles of |e| grad N_i . grad N_j,
//
// at once or in increments, each on the mesh as moved so far. How far can the inner circle of the ring go before a
// triangle is inverted?
//
//   05_extension                            tables of translations and rotations
//   05_extension "translate 4 0" 10         one motion, in increments
//   05_extension stiffness                  how far translations get if triangles have the stiffness |e|^-q
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/text.hpp"
#include "energy/densities.hpp"
#include "io/vtk.hpp"
#include "lessons/circle.hpp"
#include "linalg/linear_solver.hpp"

using namespace almesh;
using namespace almesh::lessons;

namespace {

const Mesh mesh = ring();
BlockCsr K = matrix_of_cells(mesh.nodes(), 1, mesh.elements, 3);
LinearSolver solver(2, {.kind = SolverKind::cholesky});
double q = 0;  // the stiffness of a triangle is |e|^-q

// On the mesh at x. Rows and columns of boundary nodes are those of the unit matrix; what the others have there goes to
// the right-hand side b with the displacement u of the boundary, one coordinate of it.
void assemble(const Vector& x, const std::vector<char>& boundary, const Vector& u, Vector& b) {
    std::fill(K.value.begin(), K.value.end(), 0.0);
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* const node = mesh.element(e);
        const Mat<2> A = straight_jacobian<2>(node, x), B = inverse<2>(A);
        const Vec<2> grad[3] = {{-B[0][0] - B[1][0], -B[0][1] - B[1][1]}, B[0], B[1]};
        const double area = determinant(A) / 2, stiffness = std::pow(area, -q);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const double k = stiffness * area * (grad[i][0] * grad[j][0] + grad[i][1] * grad[j][1]);
                if (boundary[node[i]]) continue;
                if (boundary[node[j]]) b[node[i]] -= k * u[node[j]];
                else *K.block(K.find(node[i], node[j])) += k;
            }
    }
    for (int i = 0; i < K.n; ++i)
        if (boundary[i]) *K.block(K.find(i, i)) = 1, b[i] = u[i];
}

// x with the boundary at its target and the others displaced harmonically: one linear system for each coordinate.
Vector extended(const Vector& x, const BoundaryTarget& target) {
    std::vector<char> boundary(mesh.nodes(), 0);
    for (const int node : mesh.faces) boundary[node] = 1;
    const Vector there = at_target(mesh, target, x);
    Vector moved = there;
    for (int a = 0; a < 2; ++a) {
        Vector u(mesh.nodes()), b(mesh.nodes(), 0.0), solution;
        for (int i = 0; i < mesh.nodes(); ++i) u[i] = there[2 * i + a] - x[2 * i + a];
        assemble(x, boundary, u, b);
        solver.solve(K, b, solution);
        for (int i = 0; i < mesh.nodes(); ++i)
            if (!boundary[i]) moved[2 * i + a] = x[2 * i + a] + solution[i];
    }
    return moved;
}

struct Judged {
    int inverted = 0;
    double largest_eta = 1;
};

Judged judged(const Vector& x) {
    Judged judgement;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Mat<2> F = multiply<2>(straight_jacobian<2>(mesh.element(e), x),
                                     inverse<2>(straight_jacobian<2>(mesh.element(e), mesh.x)));
        judgement.inverted += determinant(F) <= 0;
        judgement.largest_eta = std::max(judgement.largest_eta, distortion<2>(F, 0.0));
    }
    return judgement;
}

// In equal parts of the motion, up to the first that inverts a triangle.
Vector extended_in_parts(const std::string& motion, int increments) {
    Vector x = mesh.x;
    for (int k = 1; k <= increments && judged(x).inverted == 0; ++k)
        x = extended(x, inner_circle_by(mesh, motion, static_cast<double>(k) / increments));
    return x;
}

std::string translation(double by) { return concat("translate ", by, " 0"); }
std::string rotation(double by) { return concat("rotate ", by, " about 0 0"); }

// The largest motion without an inverted triangle, by bisection.
double reach(std::string (*motion)(double), double high, int increments) {
    double low = 0;
    while (high - low > 3e-3 * high) {
        const double middle = (low + high) / 2;
        (judged(extended_in_parts(motion(middle), increments)).inverted ? high : low) = middle;
    }
    return low;
}

void print(const std::string& motion, int increments) {
    const Vector x = extended_in_parts(motion, increments);
    const Judged judgement = judged(x);
    std::printf("%-20s  %10d  %8d  %8.3f\n", motion.c_str(), increments, judgement.inverted, judgement.largest_eta);
    const std::string name = concat("outputs/lessons/05-extension/", motion, " in ", increments, ".vtk");
    write_vtk(name, {motion, 2, 1, x, mesh.elements, 2, {}, {}, {}});
}

void print_stiffness() {
    std::printf("   q  translation up to\n");
    for (const double exponent : {0.0, 0.2, 0.3, 0.4, 0.5, 0.75, 1.0}) {
        q = exponent;
        std::printf("%4.2f  %17.2f\n", q, reach(translation, 20, 1));
    }
}

}  // namespace

int main(int count, char** argument) {
    std::filesystem::create_directories("outputs/lessons/05-extension");
    if (count == 2) return print_stiffness(), 0;
    std::printf("motion                increments  inverted   max eta\n");
    if (count > 2) return print(argument[1], std::atoi(argument[2])), 0;
    for (const double by : {1.0, 2.0, 3.0, 4.0, 8.0}) print(translation(by), 1);
    for (const double by : {20.0, 40.0, 55.0, 65.0}) print(rotation(by), 1);

    std::FILE* const csv = std::fopen("outputs/lessons/05-extension/reach.csv", "w");
    std::fprintf(csv, "increments,translation,rotation\n");
    std::printf("\nincrements  translation  rotation up to\n");
    for (const int increments : {1, 2, 4, 8}) {
        const double far = reach(translation, 20, increments), turn = reach(rotation, 90.0 * increments, increments);
        std::printf("%10d  %11.2f  %14.1f\n", increments, far, turn);
        std::fprintf(csv, "%d,%.4f,%.3f\n", increments, far, turn);
    }
    std::fclose(csv);
}
