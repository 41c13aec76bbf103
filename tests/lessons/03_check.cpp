#include "lessons/exercises/03.hpp"

#include "lessons/exercise.hpp"
#include "lessons/plain_energy.hpp"
#include "lessons/random_inputs.hpp"
#include "lessons/square.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(hat_gradients, cotangents, row_offsets, assemble, assemble_tied, add_to, kernel, colours, difference_hessian);

// Three triangles around node 1; node 4 belongs to none.
const Triangles fan = {{0, 1, 2}, {2, 1, 3}, {3, 1, 5}};

// Triangles of any three nodes: an edge may have three of them, one may be there twice.
Numbered random_heap(int nodes, int count) {
    Numbered heap = {nodes, {}};
    std::vector<int> node(nodes);
    for (int i = 0; i < nodes; ++i) node[i] = i;
    while (static_cast<int>(heap.triangles.size()) < count) {
        random_inputs().shuffle(node);
        heap.triangles.push_back({node[0], node[1], node[2]});
    }
    return heap;
}

std::string shown(const Triangles& triangles) {
    std::string text;
    for (const auto& triangle : triangles) text += concat(text.empty() ? "(" : ", (", listed(triangle), ")");
    return text;
}

EXERCISE("3.1", "the gradients of hat functions") {
    Random& random = random_inputs();
    for (int k = 0; k < 12; ++k) {
        const double size = k < 4 ? 1 : k == 4 ? 1e-7 : k == 5 ? 1e7 : random.scale(1e-7, 1e7);
        Corners y = k == 0 ? Corners{{{0.5, 1}, {2, 1.2}, {1, 3}}} : random_triangle(size, 0.01);
        if (k % 2) std::swap(y[1], y[2]);
        const std::array<Vec<2>, 3> gradient = hat_gradients(y);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const int from = (i + 1) % 3;  // there N_i is 0
                const double rise = gradient[i][0] * (y[j][0] - y[from][0]) + gradient[i][1] * (y[j][1] - y[from][1]);
                expect_close(concat("on the triangle (", listed(y[0]), "), (", listed(y[1]), "), (", listed(y[2]),
                                    ") N_", i, " at vertex ", j),
                             rise, i == j, 1e-9,
                             k ? "" : "are grad N_1 and grad N_2 rows or columns of (y_1 - y_0, y_2 - y_0)^-1?");
            }
        const double twice_the_area = std::abs(determinant(edges(y)));
        const std::array<double, 3> found = cotangents(gradient);
        for (int i = 0; i < 3; ++i) {
            const Vec<2>&at = y[i], &next = y[(i + 1) % 3], &last = y[(i + 2) % 3];
            const double cosine = (next[0] - at[0]) * (last[0] - at[0]) + (next[1] - at[1]) * (last[1] - at[1]);
            expect_close(concat("the cotangent of the angle at (", listed(at), "), the others being (", listed(next),
                                "), (", listed(last), "),"),
                         found[i], cosine / twice_the_area, 1e-8,
                         "a gradient is perpendicular to the edge opposite to its vertex: which angle do two of them "
                         "make?");
        }
    }
}

void check_rows(const Numbered& mesh, const std::string& which) {
    const std::vector<int> row = row_offsets(mesh.nodes, mesh.triangles), expected = matrix_of(mesh).row;
    expect(row.size() == expected.size(), "of ", which, " there are ", row.size(), " offsets, expected nodes + 1 = ",
           expected.size());
    expect(row[0] == 0, "row[0] of ", which, " is ", row[0], ", expected 0: nothing comes before row 0");
    for (int i = 0; i < mesh.nodes; ++i) {
        const int found = row[i + 1] - row[i], blocks = expected[i + 1] - expected[i];
        expect(found == blocks, "row ", i, " of ", which, " has ", found, " blocks, expected ", blocks,
               found > blocks ? ": an edge of two triangles is one block"
                              : ": does every node have a block with itself, also one without triangles?");
    }
}

// Triangles around node 0, which has them all.
Numbered star(int count) {
    Numbered mesh = {count + 1, {}};
    for (int i = 0; i < count; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
    random_inputs().shuffle(mesh.triangles);
    return mesh;
}

EXERCISE("3.2", "the rows of the CSR pattern") {
    check_rows({6, fan}, "the fan " + shown(fan));
    check_rows({3, {}}, "three nodes without a triangle");
    check_rows({5, {{0, 1, 2}, {2, 3, 4}}}, "two triangles that share node 2, (0, 1, 2), (2, 3, 4),");
    for (int k = 0; k < 4; ++k) {
        const Numbered heap = random_heap(random_inputs().integer(5, 8), random_inputs().integer(2, 7));
        check_rows(heap, concat("the triangles ", shown(heap.triangles), " of ", heap.nodes, " nodes"));
    }
    for (int k = 0; k < 4; ++k) {
        const int width = random_inputs().integer(2, 12), height = random_inputs().integer(2, 12);
        check_rows(random_mesh(width, height, k), concat("a square of 2 x ", width, " x ", height, " triangles"));
    }
    check_rows(star(random_inputs().integer(20, 90)), "a star of many triangles around a node");
    const Numbered large = random_mesh(300, 200, 3);
    expect_soon("a mesh of 120000 triangles takes too long: does the time grow with the square of their number? It has "
                "to grow as the number does");
    check_rows(large, "a mesh of 120000 triangles");
    expect_soon("a star of 100000 triangles around a node takes too long: does the time grow with the square of the "
                "number of a node's neighbours?");
    check_rows(star(100000), "a star of 100000 triangles around a node");
}

// Whole numbers, whose sums are exact in any order.
std::vector<Corners> random_gradients(const Numbered& mesh) {
    std::vector<Corners> local(mesh.triangles.size());
    for (auto& of_triangle : local)
        for (auto& of_vertex : of_triangle)
            for (double& entry : of_vertex) entry = random_inputs().integer(-1000, 1000);
    return local;
}

// Of the mesh; moves_with: the node that each node moves with in the end.
void compare_gradient(const std::string& which, const std::vector<double>& found, const Numbered& mesh,
                      const std::vector<Corners>& local, const std::vector<int>& moves_with, const char* hint) {
    std::vector<double> expected(2 * mesh.nodes, 0.0);
    for (std::size_t e = 0; e < local.size(); ++e)
        for (int i = 0; i < 6; ++i)
            expected[2 * moves_with[mesh.triangles[e][i / 2]] + i % 2] += local[e][i / 2][i % 2];
    expect(found.size() == expected.size(), which, " has ", found.size(), " entries, expected 2 for each of ",
           mesh.nodes, " nodes");
    for (int i = 0; i < 2 * mesh.nodes; ++i)
        expect(found[i] == expected[i], which, ", ", i % 2 ? "y" : "x", " of node ", i / 2, ", is ", found[i],
               ", expected ", expected[i], ": ", hint);
}

EXERCISE("3.3", "the gradient, triangle by triangle") {
    Random& random = random_inputs();
    for (int k = 0; k < 8; ++k) {
        const Numbered mesh = k == 0  ? Numbered{6, fan}
                              : k < 5 ? random_heap(random.integer(5, 9), random.integer(3, 9))
                                      : random_mesh(random.integer(k == 7 ? 8 : 1, 9), random.integer(2, 9), 2);
        const std::vector<Corners> local = random_gradients(mesh);
        const std::string of = k < 5 ? concat(" of the triangles ", shown(mesh.triangles)) : " of a square";
        std::vector<int> leader(mesh.nodes), order(mesh.nodes);
        for (int i = 0; i < mesh.nodes; ++i) leader[i] = order[i] = i;
        compare_gradient("the gradient" + of, assemble(mesh.nodes, mesh.triangles, local), mesh, local, leader,
                         "what the triangles around a node say adds up");
        random.shuffle(order);  // a node follows one that is before it in this order
        std::vector<int> moves_with = leader;
        for (int i = 1; i < mesh.nodes; ++i)
            if (k == 7 || random.integer(0, 1)) {  // k = 7: one chain
                leader[order[i]] = order[k == 7 ? i - 1 : random.integer(0, i - 1)];
                moves_with[order[i]] = moves_with[leader[order[i]]];
            }
        compare_gradient(concat("the gradient", of, " with the leaders ", k < 5 ? listed(leader) : "of many nodes"),
                         assemble_tied(leader, mesh.triangles, local), mesh, local, moves_with,
                         "x_i = x_leader + a constant: which nodes does the one that moves by itself take along, and "
                         "their followers?");
    }
}

EXERCISE("3.4", "the Hessian of a triangle in that of the mesh") {
    std::array<std::array<double, 6>, 6> local;  // not symmetric, so that nothing hides
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) local[i][j] = 10 * (i + 1) + j + 1;
    BlockCsr H = matrix_of({6, fan});
    add_to(H, {2, 1, 3}, local);
    const double* const off = H.block(H.find(1, 3));
    expect_close(
        "block (1, 3), entry 1 1,", off[0], 35, 1e-12,
        off[0] == 53
            ? "53 belongs to block (3, 1): rows and columns are exchanged"
            : "node 1 is vertex 1 of the triangle, node 3 its vertex 2: rows 2 and 3, columns 4 and 5 of `local`");
    expect_close("block (1, 3), entry 1 2,", off[1], 36, 1e-12, "45 would be the transposed block");
    for (int k = 0; k < 8; ++k) {
        const Numbered mesh = k < 4 ? random_heap(random_inputs().integer(4, 9), 5) : random_mesh(4, 3, 1);
        BlockCsr expected = matrix_of(mesh);
        for (double& entry : expected.value) entry = random_inputs().integer(-1000, 1000);
        BlockCsr found = expected;
        const auto triangle = mesh.triangles[random_inputs().integer(0, static_cast<int>(mesh.triangles.size()) - 1)];
        for (auto& row : local)
            for (double& entry : row) entry = random_inputs().integer(-1000, 1000);
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 6; ++j)
                expected.block(expected.find(triangle[i / 2], triangle[j / 2]))[i % 2 * 2 + j % 2] += local[i][j];
        add_to(found, triangle, local);
        expect(found.row == expected.row && found.col == expected.col, "the pattern of H has changed");
        for (int i = 0; i < found.n; ++i)
            for (int b = found.row[i]; b < found.row[i + 1]; ++b)
                for (int ab = 0; ab < 4; ++ab)
                    expect(found.block(b)[ab] == expected.block(b)[ab], "with the triangle (", listed(triangle),
                           ") entry ", ab / 2 + 1, " ", ab % 2 + 1, " of the block (", i, ", ", found.col[b], ") is ",
                           found.block(b)[ab], ", expected ", expected.block(b)[ab],
                           ": what was in H stays, and nine blocks get more");
    }
}

EXERCISE("3.5", "the kernel of the Hessian") {
    Random& random = random_inputs();
    for (int k = 0; k < 4; ++k) {
        Mesh mesh = unit_square(k == 3);
        const Mat<2> F = scaled<2>(k == 0 ? 1 : random.scale(1e-3, 1e3), random_with<2>({1, random.uniform(0.5, 2)}));
        const Vec<2> origin = {random.uniform(-1, 1), random.uniform(-1, 1)};
        for (std::size_t i = 0; i < mesh.x.size(); i += 2) {
            Vec<2> at = {mesh.x[i] + origin[0], mesh.x[i + 1] + origin[1]};
            for (double& coordinate : at) coordinate += random.uniform(-0.02, 0.02);
            for (int a = 0; a < 2; ++a) mesh.x[i + a] = F[a][0] * at[0] + F[a][1] * at[1];
        }
        PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
        BlockCsr H = energy.hessian_pattern();
        energy.add_hessian(mesh.x, HessianKind::full, H);
        auto v = kernel(mesh.x);
        std::vector<double> products(16), Hv(mesh.x.size());
        for (int i = 0; i < 4; ++i) {
            expect(v[i].size() == mesh.x.size(), "vector ", i, " has ", v[i].size(), " entries, expected ",
                   mesh.x.size());
            double size = 0, largest = 0;
            for (const double entry : v[i]) size = std::max(size, std::abs(entry));
            expect(size > 0 && std::isfinite(size), "the largest entry of vector ", i, " is ", size);
            for (double& entry : v[i]) entry /= size;
            multiply(H, v[i].data(), Hv.data());
            for (const double entry : Hv) largest = std::max(largest, std::abs(entry));
            expect(largest < 1e-12 * norm_inf(H), "H times vector ", i, ", which has entries up to 1 for this, has an ",
                   "entry ", largest, ", expected 0: which motions change no shape?");
            for (int j = 0; j <= i; ++j) products[4 * i + j] = products[4 * j + i] = dot(v[i], v[j]);
        }
        std::vector<double> solution;
        expect(solve_dense(products, {1, 1, 1, 1}, solution, 1e-8),
               "the four vectors are in the kernel, but they are not linearly independent");
    }
}

// The first colour that no earlier node has with which this one shares a row.
std::vector<int> greedy_colours(const BlockCsr& H) {
    std::vector<int> colour(H.n);
    for (int i = 0; i < H.n; ++i) {
        std::vector<char> taken(H.n + 1, 0);
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int l = H.row[H.col[k]]; l < H.row[H.col[k] + 1]; ++l)
                if (H.col[l] < i) taken[colour[H.col[l]]] = 1;
        while (taken[colour[i]]) ++colour[i];
    }
    return colour;
}

// Returns how many there are.
int check_colours(const std::string& mesh, const BlockCsr& H) {
    const std::vector<int> colour = colours(H), greedy = greedy_colours(H);
    expect(static_cast<int>(colour.size()) == H.n, mesh, " gets ", colour.size(), " entries, expected one for each of ",
           H.n, " nodes");
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            expect(colour[j] >= 0, "node ", j, " of ", mesh, " has the colour ", colour[j]);
            for (int l = H.row[i]; l < k; ++l)
                expect(colour[j] != colour[H.col[l]], "nodes ", H.col[l], " and ", j, " of ", mesh,
                       " have one colour, ", colour[j], ", and both have a block in row ", i,
                       ": the gradient at node ", i, " cannot tell which of them has moved");
        }
    for (int i = 0; i < H.n; ++i)
        expect(colour[i] == greedy[i], "node ", i, " of ", mesh, " has the colour ", colour[i], ", expected ",
               greedy[i], ": the first that no earlier node has with which it shares a row");
    return 1 + *std::max_element(greedy.begin(), greedy.end());
}

// Differences of a linear function give its matrix, whose blocks are not symmetric here.
void check_linear(const Numbered& mesh) {
    Random& random = random_inputs();
    BlockCsr A = matrix_of(mesh), H = A;
    for (double& entry : A.value) entry = random.uniform(-1, 1);
    for (double& entry : H.value) entry = random.uniform(-1, 1);
    Vector x(2 * mesh.nodes);
    for (double& entry : x) entry = random.uniform(-1, 1);
    const double h = random.scale(1e-3, 10);
    difference_hessian([&](const Vector& y) { return product(A, y); }, x, h, H);
    for (int i = 0; i < H.n; ++i)
        for (int k = H.row[i]; k < H.row[i + 1]; ++k)
            for (int ab = 0; ab < 4; ++ab) {
                const double found = H.block(k)[ab], mirrored = A.block(k)[ab == 1 ? 2 : ab == 2 ? 1 : ab];
                expect_close(concat("g is linear, h = ", in_short(h), ", and entry ", ab / 2 + 1, " ", ab % 2 + 1,
                                    " of the block (", i, ", ", H.col[k], ")"),
                             found, A.block(k)[ab], 1e-9,
                             std::abs(found - mirrored) > 1e-9 ? ""
                                                               : "the block is transposed: its rows belong to the "
                                                                 "gradient, its columns to what moves");
            }
}

void check_step(const Numbered& mesh) {
    BlockCsr H = matrix_of(mesh);
    const Vector x(2 * mesh.nodes, 1.0);
    const double h = random_inputs().scale(1e-3, 10);
    Shared<double> step = h;  // the one that is farthest from h
    const auto gradient = [&](const Vector& y) {
        double largest = 0;
        for (std::size_t i = 0; i < y.size(); ++i) largest = std::max(largest, std::abs(y[i] - x[i]));
        if (std::abs(largest - h) > std::abs(step - h)) step = largest;
        return y;
    };
    difference_hessian(gradient, x, h, H);
    expect(std::abs(step - h) <= 1e-9 * h, "the gradient is called at a distance of ", step, " from x, and h is ", h);
}

EXERCISE("3.6", "an hour: the Hessian from a few gradients") {
    const Numbered star = {7, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 1}}};
    check_colours("a star of six triangles around node 0", matrix_of(star));
    for (int k = 0; k < 4; ++k) {
        const Numbered mesh = random_mesh(random_inputs().integer(2, 9), random_inputs().integer(2, 9), k);
        check_colours("a square of " + counted(mesh.triangles.size(), "triangle"), matrix_of(mesh));
        check_linear(mesh);
    }
    const Mesh mesh = unit_square(1);
    PlainEnergy energy(mesh, mesh.x, {.objective = Objective::squared});
    BlockCsr H = energy.hessian_pattern();
    const int count = check_colours("square.msh, refined,", H);

    const Vector x = swirled(mesh, 30, true);
    Shared<long> calls;
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
    check_step(random_mesh(3, 3, 1));
}

}  // namespace
}  // namespace almesh::lessons
