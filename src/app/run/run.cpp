#include <algorithm>
#include <limits>
#include <memory>

#include "app/commands.hpp"
#include "problem/curving.hpp"
#include "app/improve/improve.hpp"
#include "problem/memory.hpp"
#include "problem/problem.hpp"
#include "report/report.hpp"
#include "report/results.hpp"
#include "report/results_folder.hpp"
#include "app/run/solve.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/boundary_distance.hpp"
#include "io/matrix_market.hpp"
#include "method/checkpoint.hpp"
#include "method/comparators.hpp"
#include "method/levels.hpp"
#include "method/snap.hpp"
#include "method/p_norm.hpp"

namespace almesh {
namespace {

constexpr double worth_telling = 0.5e9;  // bytes

bool starts_coarse(const Deck& deck) {
    if (sets_boundary(deck.method.moving)) return false;
    if (deck.start == Start::automatic) return deck.method.algorithm == Algorithm::adaptive;
    return deck.start == Start::coarse;
}

// Whether the identity map with a large penalty is as good a start as the solution of a lower degree, and costs
// nothing: in two dimensions, where the motion leaves the boundary's vertices where they are and curves what is between
// them, and the Hessian at the identity is not zero, as it is with Eq. 5.
bool identity_is_near(const Deck& deck, const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    if (mesh.dim != 2 || mesh.degree == 1 || !problem.target.prescribes_all()) return false;
    if (deck.distortion.objective != Objective::squared) return false;
    const double rounding = 1e-9 * std::sqrt(volume(mesh, problem.ideal()));
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.dim; ++i) {
            const double* const from = point(problem.ideal(), mesh.face(f)[i], mesh.dim);
            const double* const to = problem.target.node_of(mesh, f) + i * mesh.dim;
            if (std::hypot(to[0] - from[0], to[1] - from[1]) > rounding) return false;
        }
    return true;
}

// From coarse to fine: linear meshes refined 0, 1, ... times, then as fine as the deck's own of degree 1, 2, 4, ...;
// none where the identity is near.
std::vector<CoarserMesh> coarser_meshes(const Deck& deck, const Problem& problem) {
    std::vector<CoarserMesh> coarser;
    if (problem.is_own_ideal || identity_is_near(deck, problem)) return coarser;
    for (int refinements = 0; refinements < deck.refine; ++refinements) coarser.push_back({refinements, 1});
    // The file's own curves are known from its degree on; but where nodes slide, they find their way at lower ones.
    const int of_file = problem.target.freed.empty() ? problem.shape().degree : 1;
    for (int degree = 1; degree < problem.mesh().degree; degree = std::max(2 * degree, of_file))
        coarser.push_back({deck.refine, degree});
    return coarser;
}

bool snaps(const Deck& deck) {
    if (deck.snap == Snap::automatic) return deck.method.algorithm == Algorithm::adaptive;
    return deck.snap == Snap::yes;
}

// From the motions as the deck has them, whatever the target was made of them. Two motions of a node that both move
// may differ by rounding.
void measure_off_motion(const Problem& problem, Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const std::vector<double> x = final_positions(problem, solution.x);
    double rounding = 0;
    for (const double at : x) rounding = std::max(rounding, 4 * std::numeric_limits<double>::epsilon() * std::abs(at));
    std::vector<char> off(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const bool is_fixed = problem.target.fixed[mesh.face_boundary[f]];
        if (!is_fixed && problem.target.written_hold(mesh, f, k) != BoundaryHold::prescribed) return;
        Vec<3> way{};
        for (int a = 0; a < mesh.dim; ++a)
            way[a] = x[offset(mesh.faces[k], mesh.dim, a)] - problem.target.written[k * mesh.dim + a];
        if (way == Vec<3>{} || (!is_fixed && length(way) <= rounding)) return;
        off[mesh.faces[k]] = 1;
        solution.off_motion = std::max(solution.off_motion, length(way));
    });
    solution.nodes_off_motion = static_cast<int>(std::count(off.begin(), off.end(), 1));
    solution.moved_nodes = moved_nodes(mesh, problem.target, problem.sliding.get(), problem.node_target, x);
    for (const MovedNode& of : solution.moved_nodes)
        if (problem.target.is_freed(of.node)) solution.largest_slide = std::max(solution.largest_slide, of.distance);
}

void measure_sliding(const Problem& problem, Solution& solution) {
    if (!problem.sliding) return;
    const Mesh& mesh = problem.mesh();
    const std::vector<char>& freed = problem.target.freed;
    solution.freed_nodes = static_cast<int>(std::count(freed.begin(), freed.end(), 1));
    solution.surface_distance = distance_from_surfaces(mesh, problem.target, *problem.sliding, solution.x);
}

// Where the target was changed or is curved: of the faces from the target as the deck has it, on boundaries with a
// surface of their own.
void measure_distances(const Problem& problem, Solution& solution) {
    const BoundaryTarget& target = problem.target;
    const bool slides = !target.freed.empty() || (problem.base.degree > 1 && !target.prescribes_all());
    if (!slides && target.straight.empty()) return;
    std::vector<char> measured;
    for (std::size_t b = 0; b < problem.motions.size(); ++b) {
        const bool leaves_out = !problem.placed.empty() && !problem.placed[b].left_out.empty();
        measured.push_back(target.hold[b] != BoundaryHold::free && !leaves_out && !surface_step(problem.motions[b]));
    }
    BoundaryTarget came = target;
    came.node = problem.curved_target.empty() ? problem.node_target : problem.curved_target;
    const std::vector<double> x = final_positions(problem, solution.x);
    solution.distances = boundary_distances(problem.mesh(), at_target(problem.mesh(), came, x), x, measured);
}

AlResult minimise_objective(const Deck& deck, const Level& level, Newton& newton, const MethodParams& params,
                            std::vector<double>& x, const AlStart& start, const AlObserver& observer,
                            const StageObserver& observe_part) {
    constexpr int last_power = 64;
    if (sets_boundary(deck.method.moving))
        return move_with_boundary(level, newton, params, increments_of(deck), x, observer, observe_part);
    if (deck.distortion.objective != Objective::minimax)
        return minimise_in_increments(level, newton, params, x, start, observer, observe_part);
    return minimise_p_norm(level, newton, params, deck.power.value_or(last_power), x, start, observer, observe_part);
}

// Has the system of one Newton step written, for lesson 10. Where the Hessian of that step was weakened, the
// last one stays.
void write_system(const Deck& deck, Newton& newton, const Report& report) {
    if (deck.write_system == 0) return;
    newton.observe_systems([&deck, &report](const BlockCsr& A, const std::vector<double>& b) {
        if (report.newton_steps + 1 != deck.write_system) return;
        write_file(deck.output + "/A.mtx", matrix_market_text(A));
        write_file(deck.output + "/b.mtx", matrix_market_text(b));
    });
}

void write_iterates(const Deck& deck, const Problem& problem, Newton& newton, const std::vector<double>& start) {
    if (deck.iterates == 0 || deck.vtk == VtkOutput::none) return;
    write_iterate(deck, problem, 0, start);
    newton.observe_iterates([&deck, &problem](int step, const std::vector<double>& x) {
        if (step % deck.iterates == 0) write_iterate(deck, problem, step / deck.iterates, x);
    });
}

std::string history_of(const Deck& deck) { return deck.output + "/history.csv"; }

// Long runs can be followed, and leave a trace; one that cannot write it now goes on.
void write_history(const Deck& deck, const Report& report, std::FILE* out) try {
    write_file(history_of(deck), report.csv());
} catch (const InputError& failed) {
    std::fprintf(out, "note: %s\n", failed.what());
}

// Null where the deck wants none.
std::unique_ptr<Checkpoint> make_checkpoint(const Deck& deck, const Problem& problem, std::FILE* out) {
    if (deck.checkpoint == 0) return nullptr;
    return std::make_unique<Checkpoint>(
        checkpoint_folder(deck), concat(version(), " ", commit(), ", run ", problem.run_id), deck.checkpoint,
        deck.resume, [out](const std::string& note) { std::fprintf(out, "note: %s\n", note.c_str()); });
}

void print_resumed(std::FILE* out, const Deck& deck, const Checkpoint& checkpoint) {
    if (!deck.resume) return;
    const int saved = checkpoint.minimisations();
    const std::string folder = checkpoint_folder(deck);
    if (saved > 0)
        std::fprintf(out, "resumes from %s in %s\n", counted(saved, "minimisation").c_str(), folder.c_str());
    else
        std::fprintf(out, "note: no saved state in %s: the run starts from the beginning\n", folder.c_str());
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

// The last row then tells of the mesh that is written.
void snap(const Deck& deck, const Problem& problem, Solution& solution) {
    const bool all = snaps(deck) && solution.al.status == Status::converged;
    if (!all && (deck.snap == Snap::no || deck.method.moving != MovingMethod::augmented_lagrangian ||
                 !std::isfinite(solution.al.distortion.max_distortion) ||
                 (solution.al.status != Status::converged && deck.method.algorithm != Algorithm::adaptive)))
        return;
    Level& level = *problem.level;
    std::vector<char> fixed(level.mesh.nodes(), all);
    for_face_nodes(level.mesh, [&](int f, std::size_t k) {
        if (problem.target.fixed[level.mesh.face_boundary[f]]) fixed[level.mesh.faces[k]] = 1;
    });
    snap_to_targets(*level.energy, *level.constraint, solution.x, fixed);
    measure(*level.energy, *level.constraint, solution.x, solution.al.distortion, solution.al.iterations.back());
}

// What is certified is what will be read: far from the file's origin its numbers have fewer digits than those of the
// run.
void round_as_file(const Problem& problem, std::vector<double>& x) {
    if (problem.frame.origin == Vec<3>{}) return;
    x = final_positions(problem, x);
    problem.frame.take_to_run(x, problem.mesh().dim);
}

void examine(const Deck& deck, const Problem& problem, Solution& solution) {
    const TimeAdder adder(solution.time.certify);
    Level& level = *problem.level;
    solution.certificate = certify(level.mesh, solution.x, deck.certificate);
    solution.injectivity = certified_injective(problem, solution.x, solution.certificate);
    solution.size_skew = size_skew(level.mesh, level.ideal, solution.x);
    solution.refined_elements = level.energy->refined_elements();
    solution.max_boundary_error =
        std::max(level.constraint->max_error(solution.x), level.constraint->error_between_nodes(solution.x));
    solution.nodes_off_target = nodes_off_target(*level.constraint, solution.x);
    measure_off_motion(problem, solution);
    measure_sliding(problem, solution);
    const std::vector<char>& straight = problem.target.straight;
    solution.straight_faces = static_cast<int>(std::count(straight.begin(), straight.end(), 1));
    measure_distances(problem, solution);
    solution.diagnosis = diagnose(deck, problem, solution);
}

Solution solve(const Deck& deck, const Problem& problem, Checkpoint* checkpoint, Report& report, std::FILE* out) {
    const Stopwatch watch;
    Solution solution;
    const auto coarser = starts_coarse(deck) ? coarser_meshes(deck, problem) : std::vector<CoarserMesh>();
    const auto make_level = [&](int k) { return coarser_level(deck, problem, coarser[k]); };
    const auto add_stage = [&](const Stage& stage) {
        report.add(stage);
        solution.coarse_newton_iterations += stage.newton_iterations;
    };
    MethodParams params = {deck.method, deck.linear, deck.forcing, continuation_of(deck)};
    params.schedule.checkpoint = checkpoint;
    const CoarseSolution coarse =
        solve_coarser(static_cast<int>(coarser.size()), make_level, params, solution.time, add_stage);
    solution.time.coarse = solution.time.total;

    Level& level = *problem.level;
    set_functional(deck, problem);  // Eq. 6

    AlObserver observer;
    observer.iteration = [&](const AlIteration& row) {
        report.add(row);
        if (deck.frames.empty()) write_history(deck, report, out);
    };
    observer.newton_step = [&](int al_iteration, const NewtonStep& step) { report.add(al_iteration, step); };
    const bool from_file = !problem.start.empty();
    if (from_file) solution.x = problem.start;
    AlStart start = from_file ? AlStart::from_near(*level.constraint) : start_from(coarse, level, solution.x);
    if (starts_coarse(deck) && identity_is_near(deck, problem)) start.mu = largest_start_penalty;
    Newton newton(level.energy->hessian_pattern(), deck.linear, {.forcing = deck.forcing});
    write_system(deck, newton, report);
    write_iterates(deck, problem, newton, solution.x);
    solution.time.setup = watch.seconds() - solution.time.coarse;
    solution.al = minimise_objective(deck, level, newton, params, solution.x, start, observer,
                                     [&](const Stage& stage) { report.add(stage); });
    solution.time += newton.time;
    if (solution.al.status == Status::linear_solver_failed)
        solution.refused_bytes = newton.linear_solver().refused_bytes();
    solution.reached = report.reached;
    if (solution.al.status == Status::converged) place_inside_volumes(problem, solution.x);
    snap(deck, problem, solution);
    return solution;
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
    const std::unique_ptr<Checkpoint> checkpoint = make_checkpoint(deck, problem, out);
    const ResultsFolder folder(deck);
    const double bytes = predicted_bytes(problem.mesh(), deck.linear);
    print_mesh(out, deck, problem, bytes);
    if (checkpoint) print_resumed(out, deck, *checkpoint);
    const double setup_seconds = watch.seconds();
    write_deck(deck, problem);
    write_initial(deck, problem);
    const double write_seconds = watch.seconds() - setup_seconds;

    // 2. The solution.
    const CatchInterrupts catching;
    Report report(out, {problem.mesh().dim, problem.frame.length}, problem.run_id);
    const Stopwatch solving;
    int newton_steps = 0;  // of all solutions, parts and attempts, whatever became of them
    const Solve solve_problem = [&](const Deck& settings, const Problem& of) {
        Solution found = solve(settings, of, checkpoint.get(), report, out);
        newton_steps += found.newton_steps();
        return found;
    };
    const StageObserver add_stage = [&](const Stage& stage) {
        report.add(stage);
        newton_steps += stage.newton_iterations;
    };
    Solution solution = problem.curves_in_place   ? curve_in_place(deck, problem, solve_problem, add_stage, out)
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
    if (solution.al.status != Status::interrupted) Checkpoint::remove(checkpoint_folder(deck));
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
