#include "method/checkpoint.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "support/meshes.hpp"
#include "support/minimisation.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

struct Problem {
    const char* name;
    Mesh mesh;
    std::map<std::string, std::string> motions;
    Objective objective;
    AugmentedLagrangianParams schedule;
    LinearSolverParams linear;
};

// Of each kind of state that lives between two minimisations.
std::vector<Problem> problems() {
    AugmentedLagrangianParams paper;
    paper.algorithm = Algorithm::paper;
    LinearSolverParams failing;  // conjugate gradients, so that Cholesky takes over
    failing.cg_from_unknowns[1] = 1;
    failing.max_iterations = 2;
    const char* const wave = "expression \"x + 0.13*sin(9*y)\" \"y + 0.13*sin(9*x)\"";
    const char* const bent = "expression \"x + 0.3*sin(3*z)\" \"y\" \"z\"";
    return {{"ring", ring_mesh(16, 5, 8), {{"inner", "rotate 20; translate 3 1"}}, Objective::deviation, {}, {}},
            {"paper", ring_mesh(12, 3, 6), {{"inner", "translate 2 0"}}, Objective::squared, paper, {}},
            // Stalls: with refined quadrature the target is out of reach.
            {"quadrature", raise_degree(square_mesh(2), 3),
             {{"left", wave}, {"right", wave}, {"bottom", wave}, {"top", wave}}, Objective::squared, {}, {}},
            {"elimination", ring_mesh(16, 8, 2), {{"inner", "rotate 140"}}, Objective::squared, {}, {}},
            {"fallback", cube_mesh(3), {{"bottom", bent}, {"sides", bent}, {"top", bent}}, Objective::deviation, {},
             failing}};
}

struct Run {
    AlResult result;
    std::vector<double> x;
    std::vector<NewtonStep> steps;
    int refined_elements = 0;
};

// stop: the run is interrupted after so many steps.
Run run(const Problem& problem, Checkpoint* checkpoint, int stop = -1) {
    const Minimisation minimisation(problem.mesh, problem.motions, problem.objective);
    Run run;
    run.x = minimisation.ideal;
    Newton newton(minimisation.distortion.hessian_pattern(), problem.linear);
    AlObserver observer;
    observer.newton_step = [&](int, const NewtonStep& step) {
        run.steps.push_back(step);
        if (static_cast<int>(run.steps.size()) == stop) interrupt_flag = 1;
    };
    AugmentedLagrangianParams schedule = problem.schedule;
    schedule.checkpoint = checkpoint;
    run.result = almesh::minimise(minimisation.distortion, minimisation.constraint, newton, schedule, run.x, observer);
    run.refined_elements = minimisation.distortion.refined_elements();
    clear_interrupt();
    return run;
}

void check_same(const Run& resumed, const Run& whole) {
    CHECK(resumed.x == whole.x);
    CHECK(resumed.result.status == whole.result.status);
    CHECK(resumed.result.lambda == whole.result.lambda);
    CHECK(resumed.result.newton_iterations == whole.result.newton_iterations);
    CHECK(resumed.result.linear_iterations == whole.result.linear_iterations);
    CHECK(resumed.result.local_steps == whole.result.local_steps);
    CHECK(resumed.result.iterations.size() == whole.result.iterations.size());
    CHECK(resumed.refined_elements == whole.refined_elements);
    REQUIRE(resumed.steps.size() == whole.steps.size());
    for (std::size_t k = 0; k < whole.steps.size(); ++k) {
        CHECK(resumed.steps[k].iteration == whole.steps[k].iteration);
        CHECK(resumed.steps[k].energy == whole.steps[k].energy);
        CHECK(resumed.steps[k].gradient_norm == whole.steps[k].gradient_norm);
        CHECK(resumed.steps[k].step_length == whole.steps[k].step_length);
        CHECK(resumed.steps[k].cuts_inverted == whole.steps[k].cuts_inverted);
        CHECK(resumed.steps[k].cuts_decrease == whole.steps[k].cuts_decrease);
        CHECK(resumed.steps[k].hessian == whole.steps[k].hessian);
        CHECK(resumed.steps[k].linear_iterations == whole.steps[k].linear_iterations);
        CHECK(resumed.steps[k].solver == whole.steps[k].solver);
        CHECK(resumed.steps[k].fallback == whole.steps[k].fallback);
    }
}

struct Saved {
    TemporaryFolder results;
    std::string folder = results.path("checkpoint");
    std::vector<std::string> told = {};

    // seconds: for ever, but where the run is interrupted.
    Checkpoint checkpoint(bool resume, double seconds = 1e9, const std::string& of = "this run") {
        return Checkpoint(folder, of, seconds, resume, [this](const std::string& note) { told.push_back(note); });
    }
};

}  // namespace

TEST_CASE("a run that was interrupted after any Newton step ends with the same bits") {
    bool refined = false, fell_back = false, eliminated = false;
    for (const Problem& problem : problems()) {
        CAPTURE(problem.name);
        const Run whole = run(problem, nullptr);
        const int steps = static_cast<int>(whole.steps.size());
        for (int stop = 1; stop < steps; stop += 1 + stop / 4) {
            CAPTURE(stop);
            Saved saved;
            Checkpoint first = saved.checkpoint(false);
            const AlResult interrupted = run(problem, &first, stop).result;
            CHECK(interrupted.status == Status::interrupted);
            Checkpoint second = saved.checkpoint(true);
            const int begun = static_cast<int>(interrupted.iterations.size()) - 1;
            CHECK(second.minimisations() == begun - 1);  // all but the one that was interrupted
            check_same(run(problem, &second), whole);
            CHECK(saved.told.empty());
        }
        refined = refined || whole.refined_elements > 0;
        eliminated = eliminated || whole.result.local_steps > 0;
        for (const NewtonStep& step : whole.steps) fell_back = fell_back || step.fallback;
    }
    CHECK(refined);
    CHECK(fell_back);
    CHECK(eliminated);
}

TEST_CASE("a run of which every process comes one step further ends with the same bits") {
    for (const Problem& problem : problems()) {
        CAPTURE(problem.name);
        const Run whole = run(problem, nullptr);
        Saved saved;
        Run last;
        const int steps = static_cast<int>(whole.steps.size());
        for (int stop = 1; stop <= steps + 1; ++stop) {
            Checkpoint checkpoint = saved.checkpoint(stop > 1);
            last = run(problem, &checkpoint, stop);
        }
        check_same(last, whole);
        CHECK(saved.told.empty());
    }
}

TEST_CASE("the state is saved when it is due, and not before") {
    const Problem problem = problems().front();
    Saved often, seldom;
    Checkpoint frequent = often.checkpoint(false, 1e-9), rare = seldom.checkpoint(false, 1e9);
    run(problem, &frequent);
    run(problem, &rare);
    const int all = static_cast<int>(run(problem, nullptr).result.iterations.size()) - 1;
    CHECK(often.checkpoint(true).minimisations() == all);
    CHECK(!std::filesystem::exists(seldom.folder));
}

TEST_CASE("a state that is damaged or does not fit is not used, which is told, and the run is the same") {
    const Problem problem = problems()[1];
    const Run whole = run(problem, nullptr);
    const int all = static_cast<int>(whole.result.iterations.size()) - 1;
    REQUIRE(all > 2);
    const auto damage = [&](const std::function<void(std::string& file)>& how, const char* reason) {
        Saved saved;
        Checkpoint first = saved.checkpoint(false, 1e-9);
        run(problem, &first);
        const std::string path = saved.folder + "/0002.state";
        std::string file = text_of(path);
        how(file);
        write_file(path, file);
        Checkpoint second = saved.checkpoint(true);
        check_same(run(problem, &second), whole);
        REQUIRE(saved.told.size() == 1);
        CHECK(saved.told[0] == path + reason + ": the run computes anew from here");
    };
    const char* const is_damaged = " is damaged";
    damage([](std::string& file) { file[file.size() / 2] ^= 1; }, is_damaged);
    damage([](std::string& file) { file.back() ^= 1; }, is_damaged);
    damage([](std::string& file) { file.resize(file.size() / 2); }, is_damaged);
    damage([](std::string& file) { file.resize(30); }, is_damaged);
    damage([](std::string& file) { file.resize(1); }, is_damaged);
    damage([](std::string& file) { file += " "; }, is_damaged);

    Saved saved;
    Checkpoint first = saved.checkpoint(false, 1e-9);
    run(problem, &first);
    Problem other = problem;
    other.motions = {{"inner", "translate 2.0000001 0"}};
    Checkpoint second = saved.checkpoint(true);
    check_same(run(other, &second), run(other, nullptr));
    REQUIRE(saved.told.size() == 1);
    CHECK(saved.told[0] == saved.folder + "/0001.state was saved with other numbers, as on another machine"
                                          ": the run computes anew from here");
}

TEST_CASE("the state of another run is refused, and stays") {
    const Problem problem = problems().front();
    Saved saved;
    Checkpoint first = saved.checkpoint(false, 1e-9);
    run(problem, &first);
    const std::string before = text_of(saved.folder + "/0001.state");
    CHECK_THROWS_WITH_AS(saved.checkpoint(true, 1, "another"),
                         doctest::Contains("has the state of another run or program; without resume=1 this run starts"),
                         UsageError);
    CHECK(text_of(saved.folder + "/0001.state") == before);
    CHECK(!before.empty());
}

TEST_CASE("a state that cannot be saved is told of once, and the run goes on") {
    const Problem problem = problems().front();
    Saved saved;
    write_file(saved.folder, "no folder");
    Checkpoint checkpoint = saved.checkpoint(false, 1e-9);
    check_same(run(problem, &checkpoint), run(problem, nullptr));
    REQUIRE(saved.told.size() == 1);
    CHECK(saved.told[0].starts_with("the state of the run cannot be saved: cannot write to " + saved.folder + ": "));
}

TEST_CASE("what follows an interruption is no part of the run") {
    const Problem problem = problems().front();
    Saved saved;
    Checkpoint first = saved.checkpoint(false);
    run(problem, &first, static_cast<int>(run(problem, nullptr).steps.size()) - 1);
    const int interrupted_at = saved.checkpoint(true).minimisations();
    CHECK(interrupted_at > 0);
    interrupt_flag = 1;
    run(problem, &first);  // as a finer mesh would be begun, and ended at once
    CHECK(saved.checkpoint(true).minimisations() == interrupted_at);
}

TEST_CASE("the files of a checkpoint are removed, and nothing else") {
    const Problem problem = problems().front();
    Saved saved;
    Checkpoint first = saved.checkpoint(false, 1e-9);
    run(problem, &first);
    write_file(saved.folder + "/0003.state.part4711", "torn");
    write_file(saved.folder + "/notes.txt", "mine");
    Checkpoint::remove(saved.folder);
    int left = 0;
    for (const auto& entry : std::filesystem::directory_iterator(saved.folder)) {
        CHECK(entry.path().filename() == "notes.txt");
        ++left;
    }
    CHECK(left == 1);
    remove_file(saved.folder + "/notes.txt");
    Checkpoint::remove(saved.folder);
    CHECK(!std::filesystem::exists(saved.folder));
    Checkpoint::remove(saved.folder);  // nothing there
}
