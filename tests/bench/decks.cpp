#include "bench/decks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bench/deck_run.hpp"
#include "bench/newton_system.hpp"
#include "bench/timing.hpp"
#include "linalg/linear_solver.hpp"

namespace almesh::bench {
namespace {

struct BenchDeck {
    const char* name;
    bool cheap;
};

// aircraft-squared is left out: its many steps are those of aircraft over again. cells/circle has the nodes of circle,
// or nearly, in quadrilaterals, cells/sphere those of sphere-layers-degree-2 with prisms.
constexpr std::array<BenchDeck, 18> decks = {{{"circle", true},
                                              {"circle-refined-1", true},
                                              {"circle-refined-2", true},
                                              {"circle-refined-3", false},
                                              {"circle-refined-4", false},
                                              {"circle-printed", true},
                                              {"circle-literal", true},
                                              {"curving", true},
                                              {"curving-printed", true},
                                              {"channel-bump", true},
                                              {"sphere-shell", true},
                                              {"cells/circle", true},
                                              {"cells/twist-90", true},
                                              {"cells/body-30", true},
                                              {"gauntlet/sphere-layers-degree-2", false},
                                              {"cells/sphere", false},
                                              {"aircraft", false},
                                              {"aircraft-weighted", false}}};

constexpr int least_pairs = 3, most_pairs = 11, most_runs = 5;
constexpr double pairs_budget = 30, runs_budget = 6;  // seconds for the repetitions of one deck

std::string threads_setting(int threads) { return "threads=" + std::to_string(threads); }

// The median run by wall time, by which the runs are sorted afterwards.
const DeckRun& median_run(std::vector<DeckRun>& runs) {
    std::sort(runs.begin(), runs.end(), [](const DeckRun& a, const DeckRun& b) { return a.wall < b.wall; });
    return runs[runs.size() / 2];
}

// Every time_<stage> of the summary as a share of the whole run; time_total, time_run and time_coarse sum up others.
// What no stage owns is setting up, writing files and ending.
void add_split(Table& table, const std::string& name, int threads, const DeckRun& run) {
    double rest = run.wall;
    for (const auto& [key, seconds] : run.summary) {
        if (!key.starts_with("time_") || key == "time_total" || key == "time_run" || key == "time_coarse") continue;
        table.add("split", name, threads, key.substr(5), 100 * seconds / run.wall, "%");
        rest -= seconds;
    }
    table.add("split", name, threads, "rest", 100 * rest / run.wall, "%");
    table.add("split", name, threads, "whole run", run.wall, "s");
}

void add_deck(Table& table, const std::string& name, int threads, const DeckRun& run) {
    table.add("deck", name, threads, "Newton", run.summary.at("newton_iterations"));
    table.add("deck", name, threads, "linear", run.summary.at("linear_iterations"));
    table.add("deck", name, threads, "minimisation", run.summary.at("time_total"), "s");
    table.add("deck", name, threads, "whole run", run.wall, "s");
    table.add("deck", name, threads, "peak memory", run.peak_memory / 1e6, "MB");
}

// Runs with 1 and with all threads take turns, so that other work on the machine meets both alike. The median of the
// ratios tells what threads gain on the machine as it is, that of the best runs what they can gain.
void measure_deck(const std::string& name, const Machine& machine, Table& table) {
    std::vector<std::vector<DeckRun>> runs(machine.threads.size());
    std::vector<double> ratios;
    for (const Stopwatch all;
         ratios.size() < least_pairs || (ratios.size() < most_pairs && all.seconds() < pairs_budget);) {
        for (std::size_t t = 0; t < runs.size(); ++t)
            runs[t].push_back(run_deck(name, {threads_setting(machine.threads[t])}));
        ratios.push_back(runs.front().back().wall / runs.back().back().wall);
    }
    for (std::size_t t = 0; t < runs.size(); ++t) {
        const DeckRun& run = median_run(runs[t]);
        add_deck(table, name, machine.threads[t], run);
        add_split(table, name, machine.threads[t], run);
    }
    table.add("deck", name, machine.threads.back(), "speed-up", median(ratios));
    table.add("deck", name, machine.threads.back(), "of best runs", runs.front()[0].wall / runs.back()[0].wall);
}

// Table 1 of the paper: nodes, seconds.
const std::vector<double> paper_nodes = {841, 3324, 13216, 52704, 210816};
const std::vector<double> paper_times = {1.11, 3.56, 14.29, 101.94, 546.66};

// Exponent of the straight line through the points on logarithmic axes.
double fitted_exponent(const std::vector<double>& x, const std::vector<double>& y) {
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += std::log(x[i]) / static_cast<double>(x.size());
        mean_y += std::log(y[i]) / static_cast<double>(x.size());
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += std::pow(std::log(x[i]) - mean_x, 2);
        xy += (std::log(x[i]) - mean_x) * (std::log(y[i]) - mean_y);
    }
    return xy / xx;
}

// Runs whose number of unknowns grows.
struct Family {
    const char *name, *deck, *key;  // the key that grows from `first` to `last`, or to `quick_last`
    int first, last, quick_last, dimension;
    std::vector<std::string> settings;
};

const Family families[] = {{"circle level", "circle", "refine", 0, 5, 3, 2, {}},
                           {"aircraft refined", "aircraft", "refine", 0, 2, 1, 3, {"algorithm=adaptive"}},
                           {"aircraft degree", "aircraft", "degree", 1, 4, 2, 3, {"algorithm=adaptive"}}};

// Seconds of one solve of stiffened linear elasticity on the same mesh with the motion on its boundary, by conjugate
// gradients to 1e-8, analysis included: what the simplest mesh motion costs.
double elasticity_seconds(const Family& family, const std::vector<std::string>& settings) {
    const NewtonSystem system(family.deck, settings);
    const Stopwatch watch;
    LinearSolver solver(family.dimension, {.kind = SolverKind::cg, .tolerance = 1e-8, .fallback = false});
    std::vector<double> x;
    solver.solve(system.A, system.b, x);
    return watch.seconds();
}

void measure_family(const Family& family, bool quick, Table& table) {
    std::vector<double> unknowns, seconds, memory;
    for (int k = family.first; k <= (quick ? family.quick_last : family.last); ++k) {
        std::vector<std::string> settings = family.settings;
        settings.push_back(std::string(family.key) + "=" + std::to_string(k));
        const bool level = std::string(family.name) == "circle level";  // counted from 1
        const std::string name = std::string(family.name) + " " + std::to_string(level ? k + 1 : k);
        std::vector<DeckRun> runs;
        for (const Stopwatch all; runs.empty() || (runs.size() < most_runs && all.seconds() < runs_budget);)
            runs.push_back(run_deck(family.deck, settings));
        const DeckRun& run = median_run(runs);
        const int threads = static_cast<int>(run.summary.at("threads"));
        unknowns.push_back(family.dimension * run.summary.at("nodes"));
        seconds.push_back(run.wall);
        memory.push_back(run.peak_memory);
        table.add("scaling", name, threads, "unknowns", unknowns.back());
        table.add("scaling", name, threads, "elements", run.summary.at("elements"));
        table.add("scaling", name, threads, "Newton", run.summary.at("newton_iterations"));
        table.add("scaling", name, threads, "minimisation", run.summary.at("time_total"), "s");
        table.add("scaling", name, threads, "elasticity",
                  run.summary.at("time_total") / elasticity_seconds(family, settings));
        table.add("scaling", name, threads, "time", run.wall, "s");
        table.add("scaling", name, threads, "time per unknown", 1e6 * run.wall / unknowns.back(), "us");
        table.add("scaling", name, threads, "peak memory", run.peak_memory / 1e6, "MB");
    }
    const double time = fitted_exponent(unknowns, seconds), space = fitted_exponent(unknowns, memory);
    table.add("exponent", family.name, 0, "time", time);
    table.add("exponent", family.name, 0, "memory", space);
    std::printf("%s: time grows as n^%.3f, memory as n^%.3f\n", family.name, time, space);
    std::fflush(stdout);
}

// A motion by about one edge of the moved boundary per frame.
struct Motion {
    const char *deck, *boundary;
    int frames;
    bool cheap;
};

const Motion motions[] = {{"circle", "inner=translate \"0.8*sin(t/4)\" 0", 100, true},
                          {"aircraft", "aircraft=translate \"0.6*sin(t/20)\" 0 0", 10, false}};

// A frame that starts from those before: what the others take longer than the first three.
double warm_frame_seconds(const Motion& motion, int threads) {
    constexpr int first = 3, repetitions = 3;
    const auto best = [&](int frames) {
        std::vector<double> seconds;
        for (int k = 0; k < repetitions; ++k)
            seconds.push_back(run_deck(motion.deck, {"boundary " + std::string(motion.boundary), "algorithm=adaptive",
                                                     "frames=1 : 1 : " + std::to_string(frames), "vtk=none",
                                                     threads_setting(threads)}).wall);
        return *std::min_element(seconds.begin(), seconds.end());
    };
    return (best(first + motion.frames) - best(first)) / motion.frames;
}

}  // namespace

void measure_frames(const Machine& machine, bool quick, Table& table) {
    for (const Motion& motion : motions)
        for (const int threads : machine.threads)
            if (motion.cheap || !quick)
                table.add("frames", motion.deck, threads, "warm frame", 1e3 * warm_frame_seconds(motion, threads),
                          "ms");
    table.print("frames", "Motions by an edge per frame: a frame with its certificates and files, best of runs");
}

void measure_decks(const Machine& machine, bool quick, Table& table) {
    for (const BenchDeck& deck : decks)
        if (deck.cheap || !quick) measure_deck(deck.name, machine, table);
    table.print("deck",
                "Decks, each a process of its own; speed-up: one thread over all, runs taking turns, median of pairs");
    table.print("split", "Shares of the whole run");
}

void measure_scaling(bool quick, Table& table) {
    for (const Family& family : families) measure_family(family, quick, table);
    table.print("scaling", "Growth: the circle refined, the aircraft refined, and of higher degree; in times of one "
                           "elasticity solve, see README");
    const double paper = fitted_exponent(paper_nodes, paper_times);
    table.add("exponent", "paper", 0, "time", paper);
    std::printf("the paper's times grow as n^%.3f\n", paper);
}

}  // namespace almesh::bench
