#include "lessons/exercises/03.hpp"

#include "lessons/exercise.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(hat_gradients, row_offsets, assemble, add_to, kernel, colours, difference_hessian);

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

// The colours are valid and few. Returns how many.
int check_colours(const char* mesh, const BlockCsr& H) {
    const std::vector<int> colour = colours(H);
    expect(static_cast<int>(colour.size()) == H.n, mesh, " gets ", colour.size(), " entries, expected one for each of ",
           H.n, " nodes");
    int most = 0, count = 0;
    for (int i = 0; i < H.n; ++i) {
        std::vector<int> seen;  // columns of this row
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            expect(colour[j] >= 0, "node ", j, " of ", mesh, " has the colour ", colour[j]);
            for (const int other : seen)
                expect(colour[j] != colour[other], "nodes ", other, " and ", j, " of ", mesh, " have one colour, ",
                       colour[j], ", and both have a block in row ", i, ": the gradient at node ", i,
                       " cannot tell which of them has moved");
            seen.push_back(j);
        }
        most = std::max(most, static_cast<int>(seen.size()) - 1);
        count = std::max(count, colour[i] + 1);
    }
    expect(count <= most * most + 1, mesh, " gets ", count, " colours, where ", most * most + 1,
           " are enough, as no node has more than ", most, " neighbours: take the first colour that is not taken");
    return count;
}

// Differences of a linear function give its matrix, whose blocks are not symmetric here.
void check_linear(const Mesh& mesh, BlockCsr H) {
    BlockCsr A = H;
    for (std::size_t k = 0; k < A.value.size(); ++k) A.value[k] = std::sin(1.7 * static_cast<double>(k));
    difference_hessian([&](const Vector& y) { return product(A, y); }, mesh.x, 0.5, H);
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int ab = 0; ab < 4; ++ab) {
                const double found = H.block(k)[ab], mirrored = A.block(k)[ab == 1 ? 2 : ab == 2 ? 1 : ab];
                expect_close(concat("g is linear, and entry ", ab / 2 + 1, " ", ab % 2 + 1, " of the block (", i, ", ",
                                    H.col[k], ")"),
                             found, A.block(k)[ab], 1e-9,
                             std::abs(found - mirrored) > 1e-9 ? ""
                                                               : "the block is transposed: its rows belong to the "
                                                                 "gradient, its columns to what moves");
            }
}

EXERCISE("3.6", "an hour: the Hessian from a few gradients") {
    check_colours("a star of six triangles",
                  matrix_of_cells(7, 2, {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 1}, 3));
    const Mesh coarse = unit_square(0), mesh = unit_square(1);
    check_colours("inputs/meshes/square.msh", matrix_of_cells(coarse.nodes(), 2, coarse.elements, 3));
    PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr H = energy.hessian_pattern();
    const int count = check_colours("square.msh, refined,", H);
    check_linear(mesh, H);

    const Vector x = swirled(mesh, 30, true);
    Shared<int> calls;
    const auto gradient = [&](const Vector& y) {
        ++calls;
        Vector g(y.size(), 0.0);
        energy.add_gradient(y, g);
        return g;
    };
    BlockCsr exact = H;
    energy.add_hessian(x, HessianKind::full, exact);
    const auto error = [&](double h) {
        difference_hessian(gradient, x, h, H);
        double largest = 0;
        for (std::size_t k = 0; k < H.value.size(); ++k)
            largest = std::max(largest, std::abs(H.value[k] - exact.value[k]));
        return largest / norm_inf(exact);
    };
    const double small = error(1e-6);
    expect(calls <= 4 * count, "the gradient is called ", calls, " times, where ", 4 * count,
           " are enough: four for each colour");
    const double order = order_of(error, 1e-3, 4);
    expect(order > 1.8, "the error falls as h^", order, ", expected h^2: central differences go to both sides of x");
    expect(small < 1e-7, "with h = 1e-6 the largest error of the Hessian of a mesh is ", small, " times its norm");
}

}  // namespace
}  // namespace almesh::lessons
