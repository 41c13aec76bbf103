#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "app/commands.hpp"
#include "problem/curving.hpp"
#include "problem/improve.hpp"
#include "problem/memory.hpp"
#include "problem/problem.hpp"
#include "problem/so_far.hpp"
#include "report/iteration_table.hpp"
#include "report/results.hpp"
#include "report/results_folder.hpp"
#include "app/run/solve.hpp"
#include "problem/solve.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "check/boundary_distance.hpp"

namespace almesh {
namespace {

constexpr double worth_telling = 0.5e9;  // bytes

void observe_iterates(const Deck& deck, const Problem& problem, Newton& newton, const std::vector<double>& start,
                      MeshSoFar* so_far) {
    const bool writes = deck.iterates > 0 && deck.vtk != VtkOutput::none;
    if (writes) write_iterate(deck, problem, 0, start);
    newton.observe_iterates([&deck, &problem, writes, so_far](int step, const std::vector<double>& x) {
        if (writes && step % deck.iterates == 0) write_iterate(deck, problem, step / deck.iterates, x);
        if (so_far) so_far->keep(*problem.level, x);
    });
}

std::string history_of(const Deck& deck) { return deck.output + "/history.csv"; }

// Long runs can be followed, and leave a trace; one that cannot write it now goes on.
void write_history(const Deck& deck, const IterationTable& report, std::FILE* out) try {
    write_file(history_of(deck), report.csv());
} catch (const InputError& failed) {
    std::fprintf(out, "note: %s\n", failed.what());
}

SolveObserver observer_of(const Deck& deck, const Problem& problem, IterationTable& report, std::FILE* out,
                          MeshSoFar* so_far) {
    SolveObserver observer;
    observer.iteration = [&deck, &report, out](const AlIteration& row) {
        report.add(row);
        write_history(deck, report, out);
    };
    observer.newton_step = [&report](int al_iteration, const NewtonStep& step) { report.add(al_iteration, step); };
    observer.stage = [&report](const Stage& stage) { report.add(stage); };
    observer.begins = [&deck, &problem, so_far](Newton& newton, const std::vector<double>& start) {
        observe_iterates(deck, problem, newton, start, so_far);
    };
    return observer;
}

bool expectations_hold(std::FILE* out, const Deck& deck, const Summary& summary) {
    bool hold = true;
    for (const Expectation& expectation : deck.expectations) {
        const ExpectationResult result = check(expectation, summary);
        if (!result.holds) std::fprintf(out, "%s: %s\n", expectation.where.c_str(), result.text.c_str());
        hold = hold && result.holds;
    }
    if (hold && !deck.expectations.empty())
        std::fprintf(out, "all %zu expectations of the deck hold\n", deck.expectations.size());
    return hold;
}

// Of a solution that converged, before it is rounded. Returns why that failed, "" where it did not.
std::string use(const RunHooks& hooks, const Problem& problem, Solution& solution) try {
    if (hooks.solved && solution.al.status == Status::converged) hooks.solved(problem, solution);
    return "";
} catch (const Error& error) {
    return error.what();
}

}  // namespace

void print_mesh(std::FILE* out, const Deck& deck, const Problem& problem, double bytes) {
    const Mesh& mesh = problem.mesh();
    if (!deck.title.empty()) std::fprintf(out, "%s\n", deck.title.c_str());
    std::fprintf(out, "%s: %d nodes, %s of degree %d, %d boundary faces; %d thread%s\n", deck.mesh.c_str(),
                 mesh.nodes(), mesh.elements_text().c_str(), mesh.degree,
                 mesh.face_count(), max_threads(), max_threads() == 1 ? "" : "s");
    for (const std::string& note : problem.notes) std::fprintf(out, "note: %s\n", note.c_str());
    if (!deck.sweeps.empty()) std::fprintf(out, "note: one run, without the lines `sweep`: almesh sweep runs all\n");
    if (bytes > worth_telling) std::fprintf(out, "about %.2g GB of memory will be needed\n", bytes / 1e9);
    std::fflush(out);
}

ExitCode run(const Deck& deck, std::FILE* out, const RunHooks& hooks) {
    if (!deck.frames.empty()) return run_frames(deck, out);
    // 1. Mesh, target and everything that can be wrong with them; the folder for the results.
    const EndAtInterrupts ending;
    const Stopwatch watch;
    const TimeLimit limit(deck.max_seconds);
    set_threads(deck.threads);
    Problem problem = make_problem(deck);
    if (hooks.begins) hooks.begins(problem);
    const ResultsFolder folder(deck);
    const double bytes = predicted_bytes(problem.mesh(), deck.linear);
    print_mesh(out, deck, problem, bytes);
    MeshSoFar so_far(deck, problem, hooks.seconds_between_meshes, hooks.stepped, out);
    bool goes_on = problem.standing && !is_improved(deck.ideal);
    if (problem.standing) std::fprintf(out, "goes on from %s\n", deck.start_file.c_str());
    if (goes_on) *so_far.standing = *problem.standing;
    goes_on = goes_on && problem.standing->attempt < 0;  // the first solution, which is of the whole mesh
    const double setup_seconds = watch.seconds();
    write_deck(deck, problem);
    write_initial(deck, problem);
    const double write_seconds = watch.seconds() - setup_seconds;

    // 2. The solution.
    const CatchInterrupts catching;
    IterationTable report(out, {problem.mesh().dim, problem.frame.length}, problem.run_id);
    const Stopwatch solving;
    int newton_steps = 0;  // of all solutions, parts and attempts, whatever became of them
    const Solve solve_problem = [&](const ProblemOptions& settings, const Problem& of) {
        const bool is_kept = so_far.standing->attempt < 0 && &of == &problem;
        MeshSoFar* const kept = is_kept ? &so_far : nullptr;
        const SolveObserver observer = observer_of(deck, of, report, out, kept);
        Solution found = solve(settings, of, observer, kept, std::exchange(goes_on, false));
        found.reached = report.reached;
        newton_steps += found.newton_steps();
        return found;
    };
    const StageObserver add_stage = [&](const Stage& stage) {
        report.add(stage);
        newton_steps += stage.newton_iterations;
    };
    Solution solution = problem.curves_in_place   ? curve_in_place(deck, problem, solve_problem, add_stage, so_far, out)
                        : is_improved(deck.ideal) ? improve(deck, problem, solve_problem, newton_steps, out)
                                                  : solve_problem(deck, problem);
    solution.al.earlier_newton_iterations += newton_steps - solution.newton_steps();
    if (problem.curves_in_place || is_improved(deck.ideal)) solution.time.total = solving.seconds();
    solution.predicted_bytes = bytes;
    solution.time.setup += setup_seconds;
    solution.time.write += write_seconds;

    const std::string failed = use(hooks, problem, solution);

    // 3. What was reached: certificates, files.
    round_as_file(problem, solution.x);
    examine(deck, problem, solution);
    {
        const TimeAdder adder(solution.time.write);
        write_results(deck, problem, solution);
        write_file(history_of(deck), report.csv());
    }
    solution.time.run = watch.seconds();
    const Summary summary = summarise(problem, solution);
    write_summary(deck, summary);
    if (solution.al.status != Status::interrupted) remove_file(path_so_far(deck));
    print_uncertified(out, problem.mesh(), final_positions(problem, solution.x), solution.certificate, deck.output,
                      problem.infeasible);
    print_ending(out, deck, problem, solution, report.fallbacks);
    print_volumes(out, deck, problem, solution);

    const bool expected = expectations_hold(out, deck, summary);
    if (solution.al.status != Status::converged) return ExitCode::not_converged;
    if (!failed.empty()) throw Error(ExitCode::not_converged, failed);
    if (!solution.injectivity.certified) return ExitCode::not_certified;
    return expected ? ExitCode::success : ExitCode::expectation_failed;
}

}  // namespace almesh
