#include "app/commands.hpp"

#include <filesystem>

#include "deck/make_problem.hpp"
#include "deck/so_far.hpp"
#include "problem/solve.hpp"
#include "report/iteration_table.hpp"
#include "report/results.hpp"
#include "report/results_folder.hpp"
#include "report/terminal.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"

namespace almesh {
namespace {

std::string history_of(const Deck& deck) { return deck.output + "/history.csv"; }

SolveObserver observer_of(const Deck& deck, const Problem& problem, IterationTable& report, std::FILE* out,
                          MeshSoFar* so_far) {
    SolveObserver observer = report.observer();
    observer.iteration = [&deck, &report, out](const AlIteration& row) {
        report.add(row);
        try {  // long runs can be followed, and leave a trace; one that cannot write it now goes on
            write_file(history_of(deck), report.csv());
        } catch (const InputError& failed) {
            print(out, "note: ", failed.what(), "\n");
        }
    };
    observer.begins = [&deck, &problem, so_far](Newton& newton, const std::vector<double>& start) {
        const bool writes = deck.iterates > 0 && deck.vtk != VtkOutput::none;
        if (writes) write_iterate(deck, problem, 0, start);
        newton.observe_iterates([&deck, &problem, writes, so_far](int step, const std::vector<double>& x) {
            if (writes && step % deck.iterates == 0) write_iterate(deck, problem, step / deck.iterates, x);
            if (so_far) so_far->keep(*problem.level, x);
        });
    };
    return observer;
}

bool expectations_hold(std::FILE* out, const Deck& deck, const Summary& summary) {
    bool hold = true;
    for (const Expectation& expectation : deck.expectations) {
        const ExpectationResult result = check(expectation, summary);
        if (!result.holds) print(out, expectation.where, ": ", result.text, "\n");
        hold = hold && result.holds;
    }
    if (hold && !deck.expectations.empty())
        print(out, "all ", deck.expectations.size(), " expectations of the deck hold\n");
    return hold;
}

// Of a solution that converged, before it is rounded. Returns why that failed, "" where it did not.
std::string use(const RunHooks& hooks, const Problem& problem, Solution& solution) try {
    if (hooks.solved && solution.al.status == Status::converged) hooks.solved(problem, solution);
    return "";
} catch (const Error& error) {
    return error.what();
}

ExitCode code_of(const Solution& solution, const std::string& failed, bool as_expected) {
    const ExitCode code = exit_code(solution, as_expected);
    if (code != ExitCode::not_converged && !failed.empty()) throw Error(ExitCode::not_converged, failed);
    return code;
}

}  // namespace

ExitCode run(const Deck& deck, const Output& out, const RunHooks& hooks) {
    out.add({{"output", deck.output}});
    if (!deck.frames.empty()) return run_frames(deck, out);
    // 1. Mesh, target and everything that can be wrong with them; the folder for the results.
    const EndAtInterrupts ending;
    const Stopwatch watch;
    const TimeLimit limit(deck.max_seconds);
    set_threads(deck.threads);
    Problem problem = make_problem(deck);
    if (hooks.begins) hooks.begins(problem);
    const ResultsFolder folder(deck);
    print_mesh(out, deck, problem);
    if (problem.standing) print(out, "goes on from ", deck.start_file, "\n");
    const double setup_seconds = watch.seconds();
    write_deck(deck, problem);
    write_initial(deck, problem);
    const double write_seconds = watch.seconds() - setup_seconds;

    // 2. The solution.
    const CatchInterrupts catching;
    WrittenMeshSoFar so_far(deck, problem, hooks.seconds_between_meshes, hooks.stepped, out);
    IterationTable report(out, {problem.mesh().dim, problem.frame.length}, problem.run_id,
                          deck.needs_objective || !may_stay(deck, problem.motions));
    const auto observe = [&](const Problem& of, MeshSoFar* kept) { return observer_of(deck, of, report, out, kept); };
    const auto add_part = [&](const Stage& part) { report.add(part); };
    Solution solution = solve_as_needed(deck, problem, {observe, add_part}, so_far, out);
    if (is_improved(deck.ideal)) report_improvement(out, deck, problem, solution);
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
    out.add(summary);
    if (const std::string proof = deck.output + "/final.proof"; deck.proof)
        out.add({{"proof", std::filesystem::exists(proof) ? proof : "none"}});
    if (solution.al.status != Status::interrupted) remove_file(path_so_far(deck));
    print_uncertified(out, problem.mesh(), final_positions(problem, solution.x), solution.certificate, deck.output,
                      problem.infeasible);
    print_ending(out, deck, problem, solution, report.fallbacks);
    print_volumes(out, deck, problem, solution);
    return code_of(solution, failed, expectations_hold(out, deck, summary));
}

}  // namespace almesh
