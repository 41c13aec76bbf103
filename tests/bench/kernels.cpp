#include "bench/kernels.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "base/parallel.hpp"
#include "bench/newton_system.hpp"
#include "bench/timing.hpp"
#include "check/certificate.hpp"
#include "lessons/plain_energy.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/krylov/krylov.hpp"
#include "linalg/krylov/deflated.hpp"
#include "linalg/ordering/ordering.hpp"
#include "linalg/ordering/graph.hpp"
#include "linalg/krylov/ilu0.hpp"
#include "method/derivative.hpp"

namespace almesh::bench {
namespace {

constexpr double budget = 0.4;  // seconds per kernel

// A rate, and its share of the machine's limit.
void add_rate(Table& table, const std::string& group, const std::string& name, int threads, const std::string& quantity,
              double rate, const char* unit, double limit) {
    table.add(group, name, threads, quantity, rate / 1e9, unit);
    table.add(group, name, threads, quantity + " of limit", 100 * rate / limit, "%");
}

// ------------------------------------------------------------------------------------------------------- dense fronts

// Diagonally dominant, so that no pivot fails.
void fill(std::vector<double>& panel, const Front& front) {
    std::uint32_t state = 1;
    for (int j = 0; j < front.k; ++j)
        for (int i = 0; i < front.m; ++i) {
            state = state * 1664525u + 1013904223u;
            panel[static_cast<std::size_t>(j) * front_ld(front.m) + i] = i == j ? front.m : state * 0x1p-32 - 0.5;
        }
}

// Multiplications and additions of the first k columns of a Cholesky factorisation of order m.
double flops_of_front(int m, int k) {
    double flops = 0;
    for (int j = 0; j < k; ++j) flops += static_cast<double>(m - j) * (m - j);
    return flops;
}

void measure_front(int m, int k, const Machine& machine, Table& table) {
    std::vector<double> panel(panel_size(m, k)), update(update_size(m, k)), smallest(k, 0.0);
    const Front front = {m, k, panel.data(), update.data()};
    const std::string name = "front " + std::to_string(m) + " x " + std::to_string(k);
    for (std::size_t t = 0; t < machine.threads.size(); ++t) {
        set_threads(machine.threads[t]);
        const double seconds = best_seconds(
            budget, [&] { fill(panel, front); }, [&] { factor_front(front, smallest.data(), machine.threads[t] > 1); });
        add_rate(table, "dense", name, machine.threads[t], "factor", flops_of_front(m, k) / seconds, "GF/s",
                 machine.peak[t]);
    }
}

// ---------------------------------------------------------------------------------------------------- sparse matrices

void measure_cholesky(const std::string& name, const NewtonSystem& system, const Machine& machine, Table& table) {
    std::vector<double> x(system.b.size());
    for (std::size_t t = 0; t < machine.threads.size(); ++t) {
        const int threads = machine.threads[t];
        set_threads(threads);
        const Stopwatch analysis;
        Cholesky cholesky(system.A);
        table.add("cholesky", name, threads, "n", system.A.size());
        table.add("cholesky", name, threads, "nnz(L)", cholesky.factor_entries());
        table.add("cholesky", name, threads, "analysis", analysis.seconds(), "s");
        cholesky.factor(system.A);  // allocates
        const double factor = best_seconds(budget, [&] { cholesky.factor(system.A); });
        const double solve = best_seconds(budget, [&] { cholesky.solve(system.b.data(), x.data()); });
        table.add("cholesky", name, threads, "factor time", factor, "s");
        add_rate(table, "cholesky", name, threads, "factor", cholesky.flops() / factor, "GF/s", machine.peak[t]);
        table.add("cholesky", name, threads, "solve time", solve, "s");
        const double bytes = 2 * 8 * cholesky.factor_entries();  // L is read twice, forward and backward
        add_rate(table, "cholesky", name, threads, "solve", bytes / solve, "GB/s", machine.bandwidth[t]);
    }
}

double bytes_of_product(const BlockCsr& A) {
    return 8.0 * static_cast<double>(A.value.size()) + 4.0 * (A.blocks() + A.n) + 16.0 * A.size();
}

// One pass over L forward and one back: single precision below the diagonal, double on it, and the vectors.
double bytes_of_sweeps(const BlockCsr& A) {
    const double lower = 0.5 * (A.blocks() - A.n), block = A.d * A.d;
    return 2 * ((4 * block + 4) * lower + 8 * block * A.n + 16.0 * A.size());
}

void measure_products(const std::string& name, const NewtonSystem& system, const Machine& machine, Table& table) {
    const BlockCsr A = reordered(system.A, cut_into_domains(graph_of(system.A)));
    std::vector<double> x(A.size(), 1.0), y(A.size()), b;
    to_rows(A, system.b, b);
    auto made = make_ilu0(A, A.order->start);
    Preconditioner& ilu = *made;
    Deflated deflated(std::move(made), std::make_unique<CoarseSpace>(A));
    for (std::size_t t = 0; t < machine.threads.size(); ++t) {
        const int threads = machine.threads[t];
        set_threads(threads);
        const double product = best_seconds(budget, [&] { multiply(A, x.data(), y.data()); });
        add_rate(table, "sparse", name, threads, "A x", bytes_of_product(A) / product, "GB/s", machine.bandwidth[t]);
        if (ilu.factor(A).status != SolveStatus::success) continue;  // stretched elements: a matter for Cholesky
        table.add("sparse", name, threads, "ILU(0) factor", best_seconds(budget, [&] { ilu.factor(A); }), "s");
        const double solve = best_seconds(budget, [&] {
#pragma omp parallel
            ilu.apply(x.data(), y.data());
        });
        add_rate(table, "sparse", name, threads, "ILU(0) solve", bytes_of_sweeps(A) / solve, "GB/s",
                 machine.bandwidth[t]);
        if (deflated.factor(A).status != SolveStatus::success) continue;
        table.add("sparse", name, threads, "ILU(0), coarse", best_seconds(budget, [&] { deflated.factor(A); }), "s");
        ConjugateGradients cg(A.size(), {.tolerance = 1e-8});
        KrylovResult solved{};
        const double seconds = best_seconds(budget, [&] {
            solved = cg.solve(A, deflated, b.data(), y.data());
        });
        if (solved.status != SolveStatus::success) continue;
        table.add("sparse", name, threads, "CG to 1e-8", solved.iterations, "iterations");
        table.add("sparse", name, threads, "CG", 1e3 * seconds / solved.iterations, "ms/iteration");
    }
}

// ----------------------------------------------------------------------------------------------------------- assembly

// Energy, gradient and Hessians: ns per element. Compared with those of
// `faster`, if given, by how many times.
using Times = std::vector<double>;

Times time_assembly(const std::string& name, DistortionEnergy& distortion, NewtonSystem& system, int threads,
                    Table& table, const Times& faster = {}) {
    const std::vector<double>& x = system.problem.ideal();
    const double elements = system.problem.mesh().element_count();
    std::vector<double> g(x.size());
    double energy = 0;
    Times times;
    const auto add = [&](const std::string& what, const auto& body) {
        times.push_back(1e9 * best_seconds(budget, body) / elements);
        table.add("assembly", name, threads, what, times.back(), "ns/element");
        const double of_node = times.back() * elements / system.problem.mesh().nodes();
        table.add("assembly", name, threads, what + ", nodes", of_node, "ns/node");
        if (!faster.empty())
            table.add("assembly", name, threads, what + " ratio", times.back() / faster[times.size() - 1]);
    };
    add("energy", [&] { energy += distortion.energy(x); });
    add("gradient", [&] { distortion.add_gradient(x, g); });
    add("full Hessian", [&] { distortion.add_hessian(x, HessianKind::full, system.A); });
    add("projected", [&] { distortion.add_hessian(x, HessianKind::projected, system.A); });
    if (!std::isfinite(energy)) std::printf("%s: the energy of the ideal mesh is not finite\n", name.c_str());
    return times;
}

void measure_assembly(const std::string& name, NewtonSystem& system, const Machine& machine, Table& table) {
    const double elements = system.problem.mesh().element_count();
    Times serial;
    for (int threads : machine.threads) {
        set_threads(threads);
        const Times times = time_assembly(name, system.distortion(), system, threads, table);
        if (threads == 1) serial = times;
        const double statistics = best_seconds(budget, [&] { system.distortion().statistics(system.problem.ideal()); });
        table.add("assembly", name, threads, "statistics", 1e9 * statistics / elements, "ns/element");
    }
    if (elements > 1e5) return;  // would take half a minute
    PlainEnergy plain(system.problem.mesh(), system.problem.ideal(), system.params);
    time_assembly(name + " plain", plain, system, 1, table, serial);
}

// -------------------------------------------------------------------------------------------------------- derivatives

// At the minimum that is near the ideal mesh: a function's adjoint, for which the Hessian is assembled and factored,
// and that of each further one, beside a Newton step there: gradient, Hessian, direction, a trial of the line search.
void measure_derivatives(const std::string& name, const std::vector<std::string>& settings, const Machine& machine,
                         Table& table) {
    NewtonSystem system(name, settings);
    const Problem& problem = system.problem;
    DistortionEnergy& energy = system.distortion();
    std::vector<double> x = problem.ideal(), d(x.size()), g(x.size());
    Derivative polished(problem.mesh(), energy, *problem.level->constraint, {});
    polished.polish(x);
    for (const int threads : machine.threads) {
        set_threads(threads);
        LinearSolver solver(problem.mesh().dim, {});
        const auto step = [&] {
            std::fill(g.begin(), g.end(), 0.0);
            energy.add_gradient(x, g);
            std::fill(system.A.value.begin(), system.A.value.end(), 0.0);
            energy.add_hessian(x, HessianKind::full, system.A);
            problem.level->constraint->add_hessian(x, std::vector<double>(problem.level->constraint->multipliers()),
                                                   1e7, false, system.A);
            if (solver.solve(system.A, system.b, d).status != SolveStatus::success) std::printf("no Newton step\n");
            if (!std::isfinite(energy.energy(x)) || energy.valid_fraction(x, x) < 1) std::printf("no valid mesh\n");
        };
        step();  // analyses and allocates
        const double of_step = best_seconds(budget, step);
        const double of_first =
            best_seconds(budget, [&] { polished.polish(x); }, [&] { polished.adjoint(system.b); });
        const double of_next = best_seconds(budget, [&] { polished.adjoint(system.b); });
        table.add("derivative", name, threads, "Newton step", of_step, "s");
        table.add("derivative", name, threads, "first function", of_first / of_step, "steps");
        table.add("derivative", name, threads, "each further one", of_next / of_step, "steps");
    }
}

// -------------------------------------------------------------------------------------------------------- certificate

// k x k x k hexahedra, none of them a parallelepiped.
Mesh hexahedra(int k) {
    Mesh mesh;
    mesh.dim = 3;
    const auto node = [k](int i, int j, int l) { return i + (k + 1) * (j + (k + 1) * l); };
    for (int n = 0; n < node(0, 0, k + 1); ++n) {
        const double place[] = {1.0 * (n % (k + 1)), 1.0 * (n / (k + 1) % (k + 1)), 1.0 * (n / (k + 1) / (k + 1))};
        for (int a = 0; a < 3; ++a) mesh.x.push_back((place[a] + 0.1 * std::sin(n * (a + 1.3))) / k);
    }
    for (int l = 0; l < k; ++l)
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < k; ++i)
                for (const int up : {0, 1})
                    mesh.elements.insert(mesh.elements.end(), {node(i, j, l + up), node(i + 1, j, l + up),
                                                               node(i + 1, j + 1, l + up), node(i, j + 1, l + up)});
    mesh.groups = groups_of(std::vector<const CellType*>(mesh.elements.size() / 8, &hexahedron()), 1);
    return mesh;
}

void measure_certificate(const Machine& machine, Table& table) {
    const Mesh mesh = hexahedra(100);
    for (const int threads : machine.threads) {
        set_threads(threads);
        const double seconds = best_seconds(budget, [&] {
            if (!certify(mesh, mesh.x).valid) std::printf("the hexahedra are not valid\n");
        });
        table.add("certificate", "linear hexahedra", threads, "elements", mesh.element_count() / seconds / 1e6, "M/s");
    }
    table.print("certificate", "Certificate of elements that are all plainly valid");
}

struct Case {
    const char *name, *deck;
    std::vector<std::string> settings;
    bool cheap;
};

}  // namespace

void measure_kernels(const Machine& machine, bool quick, Table& table) {
    for (const auto& [m, k] : {std::pair{256, 256}, {2048, 256}, {2048, 2048}}) measure_front(m, k, machine, table);
    table.print("dense", "Dense fronts, against the peak");

    measure_certificate(machine, table);

    const std::vector<Case> cases = {{"circle level 3", "circle", {"refine=2"}, true},
                                     {"circle level 5", "circle", {"refine=4"}, false},
                                     {"curving P4", "curving", {}, true},
                                     {"shell P3", "sphere-shell", {}, true},
                                     {"quadrilaterals", "cells/circle", {"refine=2"}, true},
                                     {"quadrilaterals P3", "cells/circle", {"degree=3"}, true},
                                     {"hexahedra", "cells/twist-90", {"refine=1"}, true},
                                     {"hexahedra P3", "cells/twist-90", {"degree=3"}, false},
                                     {"four types of cells", "cells/body-30", {}, true},
                                     {"aircraft", "aircraft", {}, false}};
    for (const Case& chosen : cases) {
        if (quick && !chosen.cheap) continue;
        NewtonSystem system(chosen.deck, chosen.settings);
        measure_cholesky(chosen.name, system, machine, table);
        measure_products(chosen.name, system, machine, table);
        measure_assembly(chosen.name, system, machine, table);
    }
    const std::vector<std::string> step = {"objective=squared", "boundary inner=translate 0.01 0"};
    measure_derivatives(quick ? "circle-refined-2" : "circle-refined-4", step, machine, table);
    if (!quick)
        measure_derivatives("aircraft", {"objective=squared", "boundary aircraft=translate 1e-3 0 0"}, machine, table);
    table.print("derivative", "Derivatives of functions of the mesh, in Newton steps");
    table.print("cholesky",
                "Sparse Cholesky of the first Newton matrix: factor against the peak, solve against the bandwidth");
    table.print("sparse",
                "Passes over the matrix, against the bandwidth (of memory: small matrices stay in the caches)");
    table.print("assembly",
                "Assembly of the distortion; plain: one element after the other, dense; ratio: times the fast one");
}

}  // namespace almesh::bench
