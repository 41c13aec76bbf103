// Lesson 10: the linear system of a Newton step of a deck's functional, A d = b with A = hess E and b = -grad E at the
// ideal mesh, lambda = 0 and mu = mu0 |1|^2. The programs 10_solvers and 10_linsolve read it.
//
//   build/lessons/10_system FOLDER DECK [key=value ...]      writes FOLDER/A.mtx and FOLDER/b.mtx
#include <cstdio>
#include <filesystem>

#include "base/error.hpp"
#include "lessons/matrix_market.hpp"
#include "method/functional.hpp"
#include "deck/make_problem.hpp"

using namespace almesh;

int main(int count, char** argument) try {
    if (count < 3) throw UsageError("arguments: FOLDER DECK [key=value ...]");
    const std::string folder = argument[1];
    const Deck deck = read_deck(argument[2], {argument + 3, argument + count});
    const Problem problem = make_problem(deck);
    set_functional(deck, problem);
    Level& level = *problem.level;
    const std::vector<double>& x = problem.start.empty() ? level.ideal : problem.start;

    const double one = level.constraint->norm_of_one(), mu = deck.method.mu0 * one * one;
    const std::vector<double> lambda(level.constraint->multipliers());
    const AugmentedFunctional E(*level.energy, *level.constraint, lambda, mu);
    BlockCsr A = level.energy->hessian_pattern();
    E.hessian(x, HessianKind::projected, A);
    std::vector<double> b = E.gradient(x);
    for (double& value : b) value = -value;

    std::filesystem::create_directories(folder);
    write_file(folder + "/A.mtx", lessons::matrix_text(A));
    write_file(folder + "/b.mtx", lessons::vector_text(b));
    std::printf("%s: %d nodes, mu = %.4g\n", folder.c_str(), A.n, mu);
} catch (const Error& error) {
    std::fprintf(stderr, "10_system: %s\n", error.what());
    return static_cast<int>(error.exit_code);
}
