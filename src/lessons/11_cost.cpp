// Lesson 11: what a run costs and how that grows. The factor of Cholesky's method on meshes refined again and again, in
// two and in three dimensions; and why a sum must be cut in the same pieces whatever the number of threads is, if it is
// to have the same bits.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <set>
#include <vector>

#include "base/parallel.hpp"
#include "io/mesh_format.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/build.hpp"

using namespace almesh;

namespace {

Mesh mesh_of(const char* path) {
    std::vector<std::string> notes;
    return build_mesh(read_mesh(path), notes);
}

BlockCsr hessian_pattern(const Mesh& mesh) {
    return matrix_of_cells(mesh.nodes(), mesh.dim, mesh.elements, mesh.element_nodes());
}

struct Size {
    double unknowns, matrix, factor, flops;
};

// The analysis knows what the factor will have, before a number of it is computed.
Size analyse(const Mesh& mesh) {
    const BlockCsr A = hessian_pattern(mesh);
    LinearSolverParams params;
    params.kind = SolverKind::cholesky;
    LinearSolver solver(mesh.dim, params);
    solver.analyse(A);
    return {1.0 * A.size(), 1.0 * A.blocks() * A.d * A.d, solver.factor_entries(), solver.factor_flops()};
}

// alpha where y grows as n^alpha from one mesh to the next.
double exponent(double n_before, double y_before, double n, double y) {
    return std::log(y / y_before) / std::log(n / n_before);
}

void tabulate_growth(const char* name, int levels, std::FILE* csv) {
    const Mesh base = mesh_of((std::string("inputs/meshes/") + name + ".msh").c_str());
    std::printf("%s, %dD\nrefined  unknowns    nnz(A)     nnz(L)     flops  exponents of nnz(L), flops\n", name,
                base.dim);
    Size before{};
    for (int level = 0; level <= levels; ++level) {
        const Size size = analyse(level ? refine(base, level) : base);
        std::printf("%7d %9.0f %9.0f %10.3e %9.2e", level, size.unknowns, size.matrix, size.factor, size.flops);
        std::fprintf(csv, "%s,%.0f,%.0f,%.0f,%.6g\n", name, size.unknowns, size.matrix, size.factor, size.flops);
        if (level)
            std::printf("  %.2f %.2f", exponent(before.unknowns, before.factor, size.unknowns, size.factor),
                        exponent(before.unknowns, before.flops, size.unknowns, size.flops));
        std::printf("\n");
        before = size;
    }
}

double sum(const double* first, const double* last) { return std::accumulate(first, last, 0.0); }

// As `shares` threads would: each sums its share, the sums of the shares are added.
double sum_of_shares(const std::vector<double>& v, int shares) {
    double total = 0;
    for (int s = 0; s < shares; ++s)
        total += sum(v.data() + v.size() * s / shares, v.data() + v.size() * (s + 1) / shares);
    return total;
}

// The pieces are the same for any number of threads: it does not matter who sums which.
double sum_of_blocks(const std::vector<double>& v) {
    std::vector<double> partial((v.size() + 511) / 512);
    parallel_for(static_cast<int>(partial.size()), [&](int b) {
        partial[b] = sum(v.data() + 512 * b, v.data() + std::min<std::size_t>(v.size(), 512 * (b + 1)));
    });
    return sum(partial.data(), partial.data() + partial.size());
}

void count_different_sums() {
    std::vector<double> v(100000);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = 1.0 / (i + 1);
    std::set<std::uint64_t> of_shares, of_blocks;
    const int threads = max_threads();
    for (int count = 1; count <= 8; ++count) {
        set_threads(count);
        of_shares.insert(std::bit_cast<std::uint64_t>(sum_of_shares(v, count)));
        of_blocks.insert(std::bit_cast<std::uint64_t>(sum_of_blocks(v)));
    }
    set_threads(threads);
    std::printf("1 + 1/2 + ... + 1/100000 with 1 to 8 threads: %zu results by shares, %zu by blocks\n",
                of_shares.size(), of_blocks.size());
}

}  // namespace

int main() {
    std::filesystem::create_directories("outputs/lessons/11-cost");
    std::FILE* const csv = std::fopen("outputs/lessons/11-cost/growth.csv", "w");
    std::fprintf(csv, "mesh,unknowns,matrix,factor,flops\n");
    tabulate_growth("circle", 4, csv);
    tabulate_growth("sphere-shell", 2, csv);
    std::fclose(csv);
    count_different_sums();
}
