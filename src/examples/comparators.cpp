// The methods that the paper argues against, on the mesh and the motion of a deck: the boundary is set on its target,
// at once or in load increments, and the nodes inside
//
//   harmonic, elasticity   follow by linear_extension.hpp
//   set                    are where the distortion is least (method/set_boundary.hpp)
//   untangle               follow, and the distortion is minimised with the regularised determinant of Eq. 3, which
//                          inverted elements may have, for delta = 0.3, 0.1, 0.03, ... until the mesh is valid; then
//                          without (Escobar and others, Comput. Methods Appl. Mech. Eng. 192, 2003)
//
//   build/examples/comparators METHOD INCREMENTS DECK [key=value ...]
//
// Writes the results of a run. Exit code 0: a certified mesh, 3: not.
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "deck/make_problem.hpp"
#include "examples/linear_extension.hpp"
#include "linalg/vector_ops.hpp"
#include "method/functional.hpp"
#include "method/set_boundary.hpp"
#include "problem/solve.hpp"
#include "report/results.hpp"
#include "report/results_folder.hpp"

using namespace almesh;

namespace {

struct Mover {
    const Deck& deck;
    Level& level;
    Newton newton{level.energy->hessian_pattern(), deck.linear, {.forcing = deck.forcing}};
    AugmentedFunctional E{*level.energy, *level.constraint, std::vector<double>(level.constraint->multipliers()), 0,
                          level.on_boundary()};
    AlResult result = {};
    double reached = 0;  // fraction of the motion with a valid mesh

    std::vector<double> extended(StiffnessAt stiffness, const std::vector<double>& targets,
                                 const std::vector<double>& x) {
        std::vector<double> moved = level.with_boundary(targets, x), u(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) u[i] = moved[i] - x[i];
        ++result.newton_iterations;
        const BlockCsr pattern = level.energy->hessian_pattern();
        const SolveResult solved = extend_displacement(level.mesh, pattern, stiffness, deck.linear, x, E.fixed, u);
        if (solved.status != SolveStatus::success) return moved;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (!E.fixed[i / level.mesh.dim]) moved[i] = x[i] + u[i];
        return moved;
    }
    void move_by(StiffnessAt stiffness, int increments, std::vector<double>& x) {
        for (int k = 1; k <= increments && result.status == Status::converged; ++k) {
            x = extended(stiffness, targets_at(level, static_cast<double>(k) / increments), x);
            if (!level.is_valid(x)) result.status = Status::inverted;
            else reached = static_cast<double>(k) / increments;
        }
    }
    void minimise(const NewtonParams& params, std::vector<double>& x) {
        const NewtonResult solved = newton.minimise(E, params, x);
        add_counts(solved, result);
        result.status = solved.status == Status::attainable_accuracy ? Status::converged : solved.status;
    }
    std::ptrdiff_t inverted(const std::vector<double>& x) const {
        const std::vector<double> eta = level.energy->statistics(x).element_max;
        return std::count_if(eta.begin(), eta.end(), [](double of_element) { return !std::isfinite(of_element); });
    }
    void untangle(std::vector<double>& x) {
        const std::vector<double> targets = targets_at(level, 1), from = x;
        x = level.with_boundary(targets, from);
        for (const StiffnessAt stiffness : {harmonic_stiffness, elastic_stiffness})
            if (auto start = extended(stiffness, targets, from); inverted(start) <= inverted(x)) x = std::move(start);
        for (double delta = 0.3; delta >= 1e-6 && !level.is_valid(x); delta /= 3) {
            level.energy->set_delta(delta);
            minimise({.reduction = 0.01, .omega_star = deck.method.omega_star, .max_iterations = 30}, x);
            level.energy->set_delta(0);
        }
        if (level.is_valid(x)) minimise({.omega = deck.method.omega_star}, x);
        else result.status = Status::inverted;
    }
};

int run(const std::string& method, int increments, const Deck& deck) {
    const Stopwatch watch;
    set_threads(deck.threads);
    Problem problem = make_problem(deck);
    if (!problem.target.prescribes_all()) throw UsageError("a boundary that slides or is free cannot be set");
    const ResultsFolder folder(deck);
    set_functional(deck, problem);
    Solution solution;
    solution.x = problem.ideal();
    Mover mover{deck, *problem.level};
    if (method == "set")
        mover.result = minimise_with_boundary_set(*problem.level, mover.newton,
                                                  {deck.method, deck.linear, deck.forcing}, increments, solution.x);
    else if (method == "untangle") mover.untangle(solution.x);
    else if (method == "harmonic") mover.move_by(harmonic_stiffness, increments, solution.x);
    else if (method == "elasticity") mover.move_by(elastic_stiffness, increments, solution.x);
    else throw UsageError("the methods are harmonic, elasticity, set and untangle, not ", in_backquotes(method));
    if (mover.result.status == Status::converged) mover.reached = 1;
    solution.al = std::move(mover.result);
    solution.al.iterations.emplace_back();
    measure(*problem.level->energy, *problem.level->constraint, solution.x, solution.al.distortion,
            solution.al.iterations.emplace_back());
    solution.al.lambda.assign(problem.level->constraint->multipliers(), 0.0);
    round_as_file(problem, solution.x);
    examine(deck, problem, solution);
    write_results(deck, problem, solution);
    solution.time.run = solution.time.total = watch.seconds();
    write_summary(deck, summarise(problem, solution));
    std::printf("%s: %d linear solves and Newton steps; %.3g of the motion\n", to_string(solution.al.status),
                solution.al.newton_iterations, mover.reached);
    return solution.injectivity.certified && solution.al.status == Status::converged ? 0 : 3;
}

}  // namespace

int main(int count, char** argument) try {
    if (count < 4) throw UsageError("arguments: METHOD INCREMENTS DECK [key=value ...]");
    const auto increments = parse_int(argument[2], 1, 100000);
    if (!increments) throw UsageError("the number of increments is an integer from 1 on");
    Deck deck = read_deck(argument[3], {argument + 4, argument + count});
    deck.linear.half_from_blocks = std::numeric_limits<double>::infinity();  // other matrices have that pattern too
    return run(argument[1], *increments, deck);
} catch (const Error& error) {
    std::fprintf(stderr, "comparators: %s\n", error.what());
    return static_cast<int>(error.exit_code);
}
