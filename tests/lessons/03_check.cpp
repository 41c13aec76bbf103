#include "lessons/exercises/03.hpp"

#include "energy/plain_energy.hpp"
#include "lessons/exercise.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {
namespace {

// Three triangles around node 1; node 4 belongs to none.
const Triangles fan = {{0, 1, 2}, {2, 1, 3}, {3, 1, 5}};

EXERCISE("3.1", "the gradients of hat functions") {
    const std::array<Vec<2>, 3> y = {{{0.5, 1}, {2, 1.2}, {1, 3}}};
    const std::array<Vec<2>, 3> gradient = hat_gradients(y);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int k = (i + 1) % 3;  // from y_k, where N_i is 0, to y_j, where it is 0 or 1
            const double rise = gradient[i][0] * (y[j][0] - y[k][0]) + gradient[i][1] * (y[j][1] - y[k][1]);
            expect_close(
                concat("N_", i, " at vertex ", j), rise, i == j, 1e-12,
                "grad N_1 and grad N_2 are the rows, not the columns, of the inverse of (y_1 - y_0, y_2 - y_0)");
        }
}

EXERCISE("3.2", "the rows of the CSR pattern") {
    const std::vector<int> row = row_offsets(6, fan);
    expect(row.size() == 7, "there are ", row.size(), " offsets, expected nodes + 1 = 7");
    const int expected[] = {3, 5, 4, 4, 1, 3};
    for (int i = 0; i < 6; ++i)
        expect(row[i + 1] - row[i] == expected[i], "row ", i, " of the fan has ", row[i + 1] - row[i],
               " blocks, expected ", expected[i],
               row[i + 1] - row[i] > expected[i] ? ": an edge of two triangles is one block"
               : row[i + 1] - row[i] < expected[i]
                   ? ": does every node have a block with itself, also one without triangles?"
                   : "");
    const Mesh mesh = unit_square(0);
    Triangles triangles;
    for (int e = 0; e < mesh.element_count(); ++e)
        triangles.push_back({mesh.element(e)[0], mesh.element(e)[1], mesh.element(e)[2]});
    expect(row_offsets(mesh.nodes(), triangles) == matrix_of_cells(mesh.nodes(), 2, mesh.elements, 3).row,
           "on inputs/meshes/square.msh the offsets differ from the library's");
}

EXERCISE("3.3", "the gradient, triangle by triangle") {
    std::vector<std::array<Vec<2>, 3>> local;
    for (int e = 0; e < 3; ++e) local.push_back({{{1.0 + e, 0.1}, {10.0 + e, 0.2}, {100.0 + e, 0.3 + e}}});
    const std::vector<double> g = assemble(6, fan, local);
    expect(g.size() == 12, "the gradient has ", g.size(), " entries, expected 2 for each of 6 nodes");
    const double expected[] = {1, 0.1, 33, 0.6, 102, 0.4, 104, 1.4, 0, 0, 102, 2.3};
    for (int i = 0; i < 12; ++i)
        expect_close(concat("entry ", i % 2 ? "y" : "x", " of node ", i / 2), g[i], expected[i], 1e-12,
                     i / 2 == 1 ? "node 1 is in three triangles: their gradients add up" : "");
}

EXERCISE("3.4", "the Hessian of a triangle in that of the mesh") {
    std::array<std::array<double, 6>, 6> local;  // not symmetric, so that nothing hides
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) local[i][j] = 10 * (i + 1) + j + 1;
    BlockCsr H = matrix_of_cells(6, 2, {0, 1, 2, 2, 1, 3, 3, 1, 5}, 3);
    add_to(H, {2, 1, 3}, local);
    const double* const off = H.block(H.find(1, 3));
    expect_close(
        "block (1, 3), entry 1 1,", off[0], 35, 1e-12,
        off[0] == 53
            ? "53 belongs to block (3, 1): rows and columns are exchanged"
            : "node 1 is vertex 1 of the triangle, node 3 its vertex 2: rows 2 and 3, columns 4 and 5 of `local`");
    expect_close("block (1, 3), entry 1 2,", off[1], 36, 1e-12, "45 would be the transposed block");
    const double* const mirrored = H.block(H.find(3, 1));
    expect_close("block (3, 1), entry 1 2,", mirrored[1], 54, 1e-12,
                 "each pair (i, j) and (j, i) has a block of its own");
    add_to(H, {3, 1, 5}, local);
    const double* const shared = H.block(H.find(1, 1));
    expect_close("block (1, 1) after two triangles, entry 2 1,", shared[2], 86, 1e-12, "triangles add up");
    double sum = 0;
    for (const double entry : H.value) sum += entry;
    expect_close("the sum of all entries after two triangles", sum, 2 * 1386, 1e-12, "each entry has one place");
}

EXERCISE("3.5", "the kernel of the Hessian") {
    Mesh mesh = unit_square(0);
    for (std::size_t i = 0; i < mesh.x.size(); ++i) mesh.x[i] += 0.02 * std::sin(3.0 * static_cast<double>(i));
    PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr H = energy.hessian_pattern();
    energy.add_hessian(mesh.x, HessianKind::full, H);
    const auto v = kernel(mesh.x);
    std::vector<double> products(16), Hv(mesh.x.size());
    for (int k = 0; k < 4; ++k) {
        expect(v[k].size() == mesh.x.size(), "vector ", k, " has ", v[k].size(), " entries, expected ", mesh.x.size());
        multiply(H, v[k].data(), Hv.data());
        double largest = 0, size = 0;
        for (std::size_t i = 0; i < Hv.size(); ++i) {
            largest = std::max(largest, std::abs(Hv[i]));
            size = std::max(size, std::abs(v[k][i]));
        }
        expect(largest < 1e-12 * norm_inf(H) * size, "H times vector ", k, " has an entry ", largest,
               ", expected 0: which motions change no shape?");
        for (int l = 0; l < 4; ++l)
            for (std::size_t i = 0; i < Hv.size(); ++i) products[4 * k + l] += v[k][i] * v[l][i];
    }
    std::vector<double> solution;
    expect(solve_dense(products, {1, 1, 1, 1}, solution, 1e-8),
           "the four vectors are in the kernel, but they are not linearly independent");
}

}  // namespace
}  // namespace almesh::lessons
