#include "library/session.hpp"

#include <cstdint>
#include <cstdlib>
#include <limits>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "deck/frame_times.hpp"
#include "mesh/build.hpp"
#include "method/derivative.hpp"
#include "problem/curving.hpp"
#include "report/terminal.hpp"

namespace almesh {
namespace {

// What is printed, as a text.
class Printed {
public:
    std::FILE* const file;

    Printed() : file(open_memstream(&text_, &length_)) {
        if (!file) throw std::bad_alloc();
    }
    ~Printed() {
        std::fclose(file);
        std::free(text_);
    }
    Printed(const Printed&) = delete;

    std::string text() const {
        std::fflush(file);
        return {text_, length_};
    }

private:
    char* text_ = nullptr;
    std::size_t length_ = 0;
};

struct Unkept : MeshSoFar {
    void keep(const Level&, const std::vector<double>&) override {}
    void write(const Level&, const std::vector<double>&) override {}
};

std::string notes_of(const std::vector<std::string>& notes) {
    std::string text;
    for (const std::string& note : notes) text += concat("note: ", note, "\n");
    return text;
}

// notes: on return, of what was corrected.
Mesh read_base(const MeshSource& source, std::string& notes) {
    std::vector<std::string> told;
    Mesh mesh = build_mesh(source.raw, told, Folds::keep);
    notes = notes_of(told);
    return mesh;
}

SolveObserver observer_of(const Observer& observe, const Problem& problem) {
    SolveObserver observer;
    const Units units = {problem.mesh().dim, problem.frame.length};
    if (!observe) return observer;
    observer.iteration = [&observe, units](const AlIteration& row) {
        const AlIteration in = units.of(row);
        observe({in.iteration, 0, in.energy, in.gradient_norm, 1, in.constraint_norm});
    };
    observer.newton_step = [&observe, units](int iteration, const NewtonStep& step) {
        const NewtonStep in = units.of(step);
        observe({iteration, in.iteration, in.energy, in.gradient_norm, in.step_length, 0});
    };
    return observer;
}

std::string way_of(Deck deck) {
    std::string forms;
    for (const BoundaryMotion& line : deck.boundaries) {
        forms += concat(line.name, line.is_volume ? " volume\n" : "\n");
        for (const MotionStep& step : line.motion.steps)
            forms += concat(reinterpret_cast<std::uintptr_t>(step.form), step.places ? " given\n" : "\n");
    }
    deck.boundaries.clear();
    return resolved(deck) + forms;
}

}  // namespace

// While a run lasts: its threads, its time and who may end it, all of this thread; what it prints.
struct Session::Running {
    const int threads_before = max_threads();
    const TimeLimit limit;
    const Printed out;
    const Stopwatch watch;

    Running(const Session& session, const Deck& deck) : limit(deck.max_seconds) {
        set_threads(deck.threads);
        if (session.stops) caller_stops = &session.stops;
    }
    ~Running() {
        caller_stops = nullptr;
        set_threads(threads_before);
    }
    Running(const Running&) = delete;
};

Session::Session(MeshSource mesh, std::string name, SessionSettings given)
    : settings(std::move(given)), source(std::move(mesh)), base(read_base(source, notes)), name_(std::move(name)) {
    if (!name_.empty()) settings.path = name_;
    view = MeshView(base, source.raw, base, base.x);
}

Session Session::of_deck(const std::string& path) {
    return {read_source(read_deck(path)), "", {read_file(path), path, {}, {}}};
}

Deck Session::deck(double t, const std::string& more) const {
    std::vector<std::string> lines;
    if (!name_.empty()) lines.push_back("mesh=" + quoted_where_needed(name_, "#\""));
    for (const auto& [key, value] : settings.lines) lines.push_back(concat(key, "=", value));
    Deck deck = parse_deck(concat(settings.text, "\n", more), settings.path, lines);
    if (!deck.given.contains("output")) deck.output.clear();
    for (const auto& [boundary, motion_at] : settings.motions) {
        BoundaryMotion* const line = find_row(deck.boundaries, boundary);
        if (line) line->motion = motion_at(t);
        else deck.boundaries.push_back({boundary, motion_at(t), "boundary " + with_quotes(boundary)});
    }
    return deck;
}

ExitCode Session::move(const Deck& deck) {
    if (!deck.frames.empty()) throw UsageError("frames: a motion in time is moved frame by frame");
    const Running running(*this, deck);
    auto made = std::make_unique<Problem>(make_problem(deck, &source));
    Unkept so_far;
    const auto observe_one = [&](const Problem& of, MeshSoFar*) { return observer_of(observe, of); };
    Solution found = solve_as_needed(deck, *made, {observe_one, [](const Stage&) {}}, so_far, running.out.file);
    solver_.reset();
    before = {};
    problem = std::move(made);
    return keep(deck, std::move(found), running);
}

Deck Session::set_time(double t) {
    Deck now = deck(t);
    if (now.frames.empty()) now = deck(t, "frames = 0\n");
    if (files_in_line(now) > 0) throw UsageError("a step `file -` takes the name of a file from standard input");
    const std::string way = way_of(now);
    const bool is_new = !solver_ || way != way_;
    now = deck_at(now, t, (is_new ? 0 : frames_) + 1);
    if (!is_new) {
        is_at_solution = false;
        problem->notes.clear();
        move_target(now, *problem);
        return now;
    }
    auto made = std::make_unique<Problem>(make_problem(now, &source));
    solver_ = std::make_unique<FrameSolver>(*made);
    problem = std::move(made);
    before = {};
    frames_ = 0;
    way_ = way;
    return now;
}

ExitCode Session::frame(double t) {
    const Running running(*this, deck(t));
    const Deck now = set_time(t);
    const SolveObserver observer = observer_of(observe, *problem);
    std::string started_from;
    Solution found = solver_->solve(now, before, t, started_from, observer, observer);
    const ExitCode code = keep(now, std::move(found), running);
    ++frames_;
    if (solution.al.status == Status::converged) before.push({t, solution.x, problem->motions});
    return code;
}

ExitCode Session::keep(const Deck& deck, Solution found, const Running& running) {
    round_as_file(*problem, found.x);
    examine(deck, *problem, found);
    found.time.run = running.watch.seconds();
    summary = summarise(*problem, found);
    notes = notes_of(problem->notes) + running.out.text();
    const Printed end;
    run = deck;
    run.vtk = VtkOutput::none;
    print_ending(end.file, run, *problem, found, 0);
    ending = end.text();
    bool as_expected = true;
    for (const Expectation& expectation : deck.expectations)
        if (const ExpectationResult result = check(expectation, summary); !result.holds) {
            ending += concat(expectation.where, ": ", result.text, "\n");
            as_expected = false;
        }
    view = MeshView(problem->mesh(), source.raw, base, problem->file_x);
    view.put(final_positions(*problem, found.x), view.dim, view.node, view.x);
    solution = std::move(found);
    is_at_solution = true;
    return exit_code(solution, as_expected);
}

void Session::set_solution(double t, std::vector<double> x) {
    run = set_time(t);
    problem->frame.take_to_run(x, view.dim);
    if (run.distortion.objective != Objective::minimax) set_functional(run, *problem);
    solution.x = std::move(x);
    is_at_solution = true;
}

void Session::set_start(double t, std::vector<double> x) {
    set_time(t);
    problem->frame.take_to_run(x, view.dim);
    before = {{{t, std::move(x), problem->motions}}};
}

std::pair<Certificate, Injectivity> Session::certify(std::vector<double> x) const {
    if (problem) problem->frame.take_to_run(x, view.dim);
    Certificate certificate = almesh::certify(mesh(), x);
    Injectivity injectivity = problem ? certified_injective(*problem, x, certificate)
                                      : certify_injective(mesh(), x, certificate);
    return {std::move(certificate), std::move(injectivity)};
}

std::string Session::reason(const Certificate& certificate, const Injectivity& injectivity) const {
    if (!certificate.valid) return counts_of(certificate);
    return injectivity.certified ? "" : overlap_text(mesh(), injectivity, problem ? problem->frame : Frame());
}

std::vector<double> Session::differentiate(bool adjoint, const double* values) {
    if (solution.al.status != Status::converged)
        throw Error(ExitCode::not_converged, "no derivative: the mesh has not converged");
    if (problem->curves_in_place || is_improved(run.ideal))
        throw Error(ExitCode::not_converged,
                    "no derivative: the mesh was made valid by parts, and is no minimum of one functional");
    if (run.method.moving != MovingMethod::augmented_lagrangian)
        throw UsageError("only meshes of method = augmented_lagrangian have derivatives");
    const Running running(*this, run);
    const Level& level = *problem->level;
    LinearSolverParams linear = run.linear;
    linear.half_from_blocks = std::numeric_limits<double>::infinity();  // the Hessian takes part in products
    Derivative derivative(level.mesh, *level.energy, *level.constraint, linear);
    Solution polished = solution;
    derivative.polish(polished.x);
    measure(*level.energy, *level.constraint, polished.x, polished.al.distortion, polished.al.iterations.back());
    const std::vector<double> given = view.to_mesh(values), zero(given.size(), 0.0);
    std::vector<double> result(view.x.size(), 0.0);
    MeshView::put(adjoint ? derivative.adjoint(given).shift : derivative.tangent({given, zero}), view.dim, view.node,
                  result);
    keep(run, std::move(polished), running);
    return result;
}

}  // namespace almesh
