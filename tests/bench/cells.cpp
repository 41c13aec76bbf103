// The kernels of a Newton step on cells of one type, on a grid of about as many nodes of each type and degree: what a
// node takes, and how many times that of a node of simplices.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/parallel.hpp"
#include "bench/kernels.hpp"
#include "bench/timing.hpp"
#include "check/certificate.hpp"
#include "energy/distortion_energy.hpp"
#include "mesh/build.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh::bench {
namespace {

constexpr double budget = 0.3;  // seconds per kernel

// How a square or a cube is split; corners are numbered by their coordinates, x fastest, and 8 is the centre.
struct Split {
    const CellType& cell;
    std::vector<std::vector<int>> corners;
};

std::vector<Split> splits() {
    const std::vector<int> hexahedron_corners = {0, 1, 3, 2, 4, 5, 7, 6};
    const std::vector<std::vector<int>> tetrahedra = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                                      {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    const std::vector<std::vector<int>> pyramids = {{0, 1, 3, 2, 8}, {4, 6, 7, 5, 8}, {0, 4, 5, 1, 8},
                                                    {2, 3, 7, 6, 8}, {0, 2, 6, 4, 8}, {1, 5, 7, 3, 8}};
    return {{simplex(2), {{0, 1, 3}, {0, 3, 2}}},
            {quadrilateral(), {{0, 1, 3, 2}}},
            {simplex(3), tetrahedra},
            {hexahedron(), {hexahedron_corners}},
            {prism(), {{0, 1, 3, 4, 5, 7}, {0, 3, 2, 4, 7, 6}}},
            {pyramid(), pyramids}};
}

// k^dim squares or cubes of the unit square or cube, slightly bent.
Mesh grid(const Split& split, int k, int degree) {
    const int dim = split.cell.dim, layers = dim == 3 ? k : 0, side = k + 1, vertices = side * side * (layers + 1);
    RawMesh raw;
    const auto add_node = [&raw, k](double i, double j, double l) {
        const double bend = 0.02 * std::sin(3 * (i + 2 * j + l) / k);
        raw.nodes.push_back({static_cast<long long>(raw.nodes.size()) + 1, {i / k + bend, j / k - bend, l / k}, 0});
    };
    for (int n = 0; n < vertices; ++n) add_node(n % side, n / side % side, n / side / side);
    for (int l = 0; l < std::max(layers, 1); ++l)
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < k; ++i) {
                const int centre = static_cast<int>(raw.nodes.size());
                if (split.cell.is_collapsed) add_node(i + 0.5, j + 0.5, l + 0.5);
                for (const std::vector<int>& corners : split.corners) {
                    const long long id = static_cast<long long>(raw.elements.size()) + 1;
                    raw.elements.push_back({id, raw.element_nodes.size(), 0, dim, 1, 0, 0, &split.cell});
                    for (const int c : corners)
                        raw.element_nodes.push_back(
                            c == 8 ? centre : i + c % 2 + side * (j + c / 2 % 2 + side * (l + c / 4)));
                }
            }
    std::vector<std::string> notes;
    return raise_degree(build_mesh(raw, notes), degree);
}

using Times = std::vector<double>;

Times measure(const Mesh& mesh, const std::string& name, int threads, const Times& of_simplices, Table& table) {
    const std::vector<double> ideal = straight_sided(mesh);
    std::vector<double> x = ideal, g(x.size()), to;
    for (int i = 0; i < mesh.nodes(); ++i) x[offset(i, mesh.dim)] += 0.01 * std::sin(7 * x[offset(i, mesh.dim, 1)]);
    to = x;
    for (int i = 0; i < mesh.nodes(); ++i) to[offset(i, mesh.dim, 1)] += 1e-3 * std::sin(5 * x[offset(i, mesh.dim)]);
    const auto energy = make_energy(mesh, ideal, {});
    energy->refine_quadrature(x);
    BlockCsr H = energy->hessian_pattern();
    Times times;
    double sum = 0;
    const auto add = [&](const std::string& what, const auto& body) {
        times.push_back(1e9 * best_seconds(budget, body) / mesh.nodes());
        table.add("cells", name, threads, what, times.back(), "ns/node");
        if (!of_simplices.empty())
            table.add("cells", name, threads, what + " ratio", times.back() / of_simplices[times.size() - 1]);
    };
    add("trial", [&] { sum += energy->valid_fraction(x, to) + energy->energy(to); });
    add("gradient", [&] { energy->add_gradient(x, g); });
    add("full Hessian", [&] { energy->add_hessian(x, HessianKind::full, H); });
    add("projected", [&] { energy->add_hessian(x, HessianKind::projected, H); });
    add("certificate", [&] { sum += certify(mesh, x).min_certified_bound; });
    table.add("cells", name, threads, "entries", static_cast<double>(H.value.size()) / mesh.nodes(), "per node");
    if (!std::isfinite(sum)) std::printf("%s: not valid\n", name.c_str());
    return times;
}

}  // namespace

void measure_cells(const Machine& machine, bool quick, Table& table) {
    for (const int threads : machine.threads)
        for (int degree = 1; degree <= (quick ? 2 : 4); ++degree) {
            Times of_simplices;
            for (const Split& split : splits()) {
                set_threads(threads);
                const int nodes = quick ? 4000 : 30000, of_cell = split.cell.is_collapsed ? 2 : 1;
                const double side = std::pow(1.0 * nodes / of_cell, 1.0 / split.cell.dim) / degree;
                const Mesh mesh = grid(split, std::max(2, static_cast<int>(side)), degree);
                const bool is_simplex = split.cell.is_simplex();
                const std::string name = std::string(split.cell.plural) + " P" + std::to_string(degree);
                const Times times = measure(mesh, name, threads, is_simplex ? Times() : of_simplices, table);
                if (is_simplex) of_simplices = times;
            }
        }
    table.print("cells", "Cells by type and degree, per node; ratio: over simplices of that degree. trial: of a step");
}

}  // namespace almesh::bench
