// Lesson 10: the linear system of one Newton step, A d = b, solved in the two ways there are.
//
// Direct: the factor L of A = L L^T has many more entries than A, and how many depends on the order of the unknowns
// alone; they are counted here without computing one. Iterative: conjugate gradients take a number of steps that
// depends on the preconditioner: none, the diagonal, or an incomplete factorisation with no fill, ILU(0).
//
// Argument: a folder with A.mtx and b.mtx, as 10_system writes them.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lessons/matrix_market.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/ordering/ordering.hpp"

using namespace almesh;

namespace {

using Vector = std::vector<double>;
constexpr int cells = 100;            // of the picture of L, in each direction
constexpr int most_iterations = 500;  // of conjugate gradients

// Every row i of L is a part of the elimination tree: from the j < i with A_ij != 0 upwards to i (Liu 1990). Walking
// each path until it meets one already walked visits every entry of L once.
void count_fill(const BlockCsr& A, Ordering ordering, std::FILE* pattern) {
    std::vector<int> parent(A.n, -1), walked(A.n, -1), in_column(A.n, 1), picture(cells * cells);
    for (int i = 0; i < A.n; ++i) {
        walked[i] = i;
        for (int k = A.row[i]; k < A.row[i + 1] && A.col[k] < i; ++k)
            for (int j = A.col[k]; walked[j] != i; j = parent[j]) {
                if (parent[j] < 0) parent[j] = i;
                walked[j] = i;
                ++in_column[j];  // L_ij
                ++picture[static_cast<long>(i) * cells / A.n * cells + static_cast<long>(j) * cells / A.n];
            }
    }
    double entries = 0, flops = 0;
    for (const double of_column : in_column) entries += of_column, flops += of_column * of_column;
    const double fill = entries / (0.5 * (A.blocks() + A.n));  // over the lower triangle of A
    std::printf("%-18s %9.0f %13.1f %10.2e\n", to_string(ordering), entries, fill, flops);
    for (int c = 0; c < cells * cells; ++c)
        if (picture[c]) std::fprintf(pattern, "%s,%d,%d,%d\n", to_string(ordering), c / cells, c % cells, picture[c]);
}

double dot_product(const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

// Gaussian elimination that drops every entry outside the pattern of A. L (unit diagonal) and U overwrite it. Row of a
// pivot that is not positive, or -1.
int ilu0(BlockCsr& A) {
    for (int i = 0; i < A.n; ++i) {
        for (int k = A.row[i]; A.col[k] < i; ++k) {
            const int j = A.col[k];
            A.value[k] /= A.value[A.find(j, j)];
            for (int m = A.find(j, j) + 1; m < A.row[j + 1]; ++m)
                if (const int fill = A.find(i, A.col[m]); fill >= 0) A.value[fill] -= A.value[k] * A.value[m];
        }
        if (A.value[A.find(i, i)] <= 0) return i;
    }
    return -1;
}

// z = U^{-1} L^{-1} r.
Vector solve(const BlockCsr& LU, Vector z) {
    for (int i = 0; i < LU.n; ++i)
        for (int k = LU.row[i]; LU.col[k] < i; ++k) z[i] -= LU.value[k] * z[LU.col[k]];
    for (int i = LU.n - 1; i >= 0; --i) {
        const int diagonal = LU.find(i, i);
        for (int k = diagonal + 1; k < LU.row[i + 1]; ++k) z[i] -= LU.value[k] * z[LU.col[k]];
        z[i] /= LU.value[diagonal];
    }
    return z;
}

// Hestenes & Stiefel 1952; Saad 2003, algorithm 9.1. Until |r| <= 1e-8 |b|.
void conjugate_gradients(const BlockCsr& A, const Vector& b, const auto& M, const char* name, std::FILE* history) {
    Vector x(b.size()), r = b, z = M(r), p = z, Ap(b.size());
    double rz = dot_product(r, z);
    const double target = 1e-8 * std::sqrt(dot_product(b, b));
    int iterations = 0;
    while (std::sqrt(dot_product(r, r)) > target && iterations < most_iterations) {
        std::fprintf(history, "%s,%d,%.4g\n", name, iterations, 1e-8 * std::sqrt(dot_product(r, r)) / target);
        multiply(A, p.data(), Ap.data());
        const double alpha = rz / dot_product(p, Ap), rz_before = rz;
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] += alpha * p[i];
            r[i] -= alpha * Ap[i];
        }
        z = M(r);
        rz = dot_product(r, z);
        for (std::size_t i = 0; i < x.size(); ++i) p[i] = z[i] + rz / rz_before * p[i];
        ++iterations;
    }
    if (iterations == most_iterations) return (void)std::printf("%-26s more than %d iterations\n", name, iterations);
    const double factor = std::pow(1e-8, 1.0 / iterations);
    std::printf("%-26s %3d iterations, |b - A x| falls by a factor %.3g each\n", name, iterations, factor);
}

void precondition_in(const BlockCsr& A, const Vector& b, const char* name, std::FILE* history) {
    BlockCsr LU = A;
    if (const int bad = ilu0(LU); bad >= 0) std::printf("%-26s pivot %d is not positive\n", name, bad);
    else
        conjugate_gradients(
            A, b, [&LU](const Vector& r) { return solve(LU, r); }, name, history);
}

}  // namespace

int main(int count, char** argument) {
    const std::string folder = count > 1 ? argument[1] : "outputs/lessons/10-solvers/soft";
    const BlockCsr A = lessons::read_matrix(folder + "/A.mtx", 1);
    const Vector b = lessons::read_vector(folder + "/b.mtx", A.n);
    const std::string results = "outputs/lessons/10-solvers/" + std::filesystem::path(folder).filename().string();
    std::filesystem::create_directories(results);
    std::FILE* const pattern = std::fopen((results + "/pattern.csv").c_str(), "w");
    std::FILE* const history = std::fopen((results + "/residuals.csv").c_str(), "w");
    std::fprintf(pattern, "ordering,row,column,entries\n");
    std::fprintf(history, "method,iteration,residual\n");
    std::printf("%d unknowns, %d entries in A\n", A.n, A.blocks());
    std::printf("ordering              nnz(L)  times tril(A)      flops\n");
    using enum Ordering;
    for (const Ordering ordering : {natural, reverse_cuthill_mckee, minimum_degree, nested_dissection})
        count_fill(reordered(A, row_order(order_vertices(graph_of(A), ordering))), ordering, pattern);
    const auto divide_by_diagonal = [&A](Vector r) {
        for (int i = 0; i < A.n; ++i) r[i] /= A.value[A.find(i, i)];
        return r;
    };
    conjugate_gradients(A, b, std::identity(), "CG", history);
    conjugate_gradients(A, b, divide_by_diagonal, "CG with the diagonal", history);
    precondition_in(A, b, "CG with ILU(0)", history);
    const std::vector<int> band = almesh::reverse_cuthill_mckee(graph_of(A));
    Vector b_in_band(b.size());
    for (int i = 0; i < A.n; ++i) b_in_band[i] = b[band[i]];
    precondition_in(reordered(A, row_order(band)), b_in_band, "CG with ILU(0) in rcm", history);
    std::fclose(pattern);
    std::fclose(history);
}
