// For k = 1, 2, ...: the motions at t_k, the target, the solution, its certificates, its files, the state.
#include "app/frames.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "app/boundaries.hpp"
#include "app/commands.hpp"
#include "app/ending.hpp"
#include "app/frame_solver.hpp"
#include "app/results_folder.hpp"
#include "app/solve.hpp"
#include "base/bytes.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"

namespace almesh {
namespace {

constexpr int most_frames = 1000000;

double number_of(const std::string& where, std::string_view text) {
    const auto value = parse_double(text);
    if (!value) throw UsageError(where, ": frames: ", in_backquotes(text), " is not a number");
    return *value;
}

// FROM : STEP : TO
std::vector<double> times_of_range(const std::string& where, std::string_view text) {
    const auto piece = split(text, ':');
    if (piece.size() != 3) throw UsageError(where, ": frames = ", text, ": expected FROM : STEP : TO");
    const double from = number_of(where, piece[0]), step = number_of(where, piece[1]), to = number_of(where, piece[2]);
    if (!(step > 0)) throw UsageError(where, ": frames = ", text, ": the step must be > 0");
    const double steps = std::floor((to - from) / step * (1 + 1e-12) + 1e-9);
    if (!(steps >= 0 && steps < most_frames))
        throw UsageError(where, ": frames = ", text, " are ", steps + 1, " times: expected 1 to ", most_frames);
    constexpr int digits = 14;  // so that 35 steps of 0.01 are 0.35
    std::vector<double> times;
    for (int k = 0; k <= steps; ++k) {
        std::string t;
        append(t, from + k * step, digits);
        times.push_back(*parse_double(t));
    }
    return times;
}

// Separated by commas, blanks or line ends.
void add_times(const std::string& where, std::string_view text, std::vector<double>& times) {
    for (const std::string_view piece : split(text, ','))
        for (const std::string_view word : words(piece)) {
            const double t = number_of(where, word);
            if (!times.empty() && t <= times.back())
                throw UsageError(where, ": frames: the times run backwards, ", t, " is after ", times.back());
            times.push_back(t);
        }
}

std::vector<double> times_of_file(const std::string& where, const std::string& path) try {
    std::vector<double> times;
    int line = 0;
    const std::string text = read_text_file(path);
    for (const std::string_view row : split(text, '\n'))
        add_times(concat(path, ":", ++line), row.substr(0, row.find('#')), times);
    if (times.empty()) throw UsageError(path, ": no times");
    return times;
} catch (const InputError& error) {
    throw UsageError(where, ": frames: ", error.what());
}

// "frame 3, t = 0.04"
std::string name_of(int number, double t) { return concat("frame ", number, ", t = ", t); }

// A frame of which something can be told.
struct Row {
    int number = 0;
    double t = 0;
    std::string status, started_from, note;
    int newton_steps = 0;
    double max_distortion = NAN, relative_quality = NAN, min_scaled_jacobian = NAN, seconds = 0;
    bool certified = false, has_mesh = false;
};

constexpr const char* heading =
    "frame,t,status,newton_steps,max_distortion,relative_quality,min_scaled_jacobian,certified,started_from,seconds,"
    "note\n";

std::string csv_of(const Row& row) {
    std::string note = row.note;
    for (char& c : note) c = c == '\n' ? ' ' : c == '"' ? '\'' : c;
    const auto number = [](double value) { return std::isnan(value) ? std::string() : to_text(value); };
    return concat(row.number, ",", row.t, ",", row.status, ",", row.newton_steps, ",", number(row.max_distortion), ",",
                  number(row.relative_quality), ",", number(row.min_scaled_jacobian), ",",
                  row.certified ? "yes" : "no", ",", row.started_from, ",", rounded_down(row.seconds, 4), ",",
                  note.empty() ? "" : with_quotes(note), "\n");
}

// What the next frame depends on, and what has been told of those before it.
struct State {
    int frames = 0;                        // done
    ExitCode worst = ExitCode::success;    // of them
    int frame_of_x = 0;                    // the last one with a mesh,
    std::vector<double> x;                 // and that, in the run's frame
    std::vector<std::pair<std::string, double>> series;  // VTK files with their times
    std::string csv = heading;
};

std::string header(const Problem& problem) {
    return concat("almesh frames 1\n", version(), " ", commit(), ", run ", problem.run_id, "\n");
}

std::string text_of(const State& state, const Problem& problem) {
    std::string text = header(problem);
    for (const auto number : {std::uint64_t(state.frames), std::uint64_t(state.worst), std::uint64_t(state.frame_of_x),
                              std::uint64_t(state.x.size()), std::uint64_t(state.series.size())})
        append_bytes(text, number, std::endian::little);
    for (const double x : state.x) append_bytes(text, x, std::endian::little);
    for (const auto& [name, t] : state.series) append_bytes(text, t, std::endian::little), text += name + "\n";
    text += state.csv;
    return text + hash_of(text);
}

// Where the file is there, and whole.
std::optional<State> read_state(const std::string& path, const Problem& problem) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::nullopt;
    const std::string text = read_file(path), expected = header(problem);
    const std::size_t end = text.size() - std::min(text.size(), hash_of("").size());
    if (!text.starts_with(expected))
        throw UsageError("cannot resume: ", path, " is of another run or program; without resume=1 this run starts "
                         "from the beginning and removes it");
    if (hash_of(std::string_view(text).substr(0, end)) != text.substr(end)) return std::nullopt;
    const char* at = text.data() + expected.size();
    const auto take = [&at]<class Number>(Number& value) {
        value = from_bytes<Number>(at, std::endian::little);
        at += sizeof value;
    };
    State state;
    std::uint64_t frames = 0, worst = 0, frame_of_x = 0, coordinates = 0, files = 0;
    take(frames), take(worst), take(frame_of_x), take(coordinates), take(files);
    state.frames = static_cast<int>(frames);
    state.worst = static_cast<ExitCode>(worst);
    state.frame_of_x = static_cast<int>(frame_of_x);
    state.x.resize(coordinates);
    for (double& x : state.x) take(x);
    state.series.resize(files);
    for (auto& [name, t] : state.series) {
        take(t);
        const char* const line_end = std::find(at, text.data() + end, '\n');
        name.assign(at, line_end);
        at = line_end + 1;
    }
    state.csv.assign(at, text.data() + end);
    return state;
}

// Success is best, then the higher code.
ExitCode worse(ExitCode a, ExitCode b) {
    if (a == ExitCode::success || b == ExitCode::success) return std::max(a, b);
    return std::min(a, b);
}

class FrameRun {
public:
    FrameRun(const Deck& deck, std::FILE* out, std::vector<double> times);
    ExitCode run();

private:
    const Deck& deck_;
    std::FILE* out_;
    std::vector<double> times_;
    Problem problem_;
    FrameSolver solver_{problem_};
    State state_;
    int first_ = 0;      // frames that were done before
    double spent_ = 0;   // seconds, on those since
    std::string told_;   // the last note

    void resume();
    void announce();
    ExitCode solve_frame(const Deck& now, Row& row);
    ExitCode keep(const Deck& now, Solution& solution, Row& row);
    void end_frame(const Row& row);
    void print(const Row& row);
    std::string state_path() const { return concat(deck_.output, "/", frames_state); }
};

FrameRun::FrameRun(const Deck& deck, std::FILE* out, std::vector<double> times)
    : deck_(deck), out_(out), times_(std::move(times)), problem_(make_problem(deck_at(deck, times_[0], 1))) {}

void FrameRun::resume() {
    if (!deck_.resume) return;
    if (auto saved = read_state(state_path(), problem_)) {
        state_ = std::move(*saved);
        first_ = state_.frames;
        std::fprintf(out_, "resumes after %s\n", name_of(first_, times_[first_ - 1]).c_str());
    } else {
        std::fprintf(out_, "note: no saved state in %s: the run starts from the beginning\n", deck_.output.c_str());
    }
}

void FrameRun::announce() {
    const Mesh& mesh = problem_.mesh();
    if (!deck_.title.empty()) std::fprintf(out_, "%s\n", deck_.title.c_str());
    std::fprintf(out_, "%s: %d nodes, %s of degree %d, %d boundary faces; %s; %s\n", deck_.mesh.c_str(), mesh.nodes(),
                 mesh.elements_text().c_str(), mesh.degree, mesh.face_count(),
                 counted(max_threads(), "thread").c_str(), counted(times_.size(), "frame").c_str());
    for (const std::string& note : problem_.notes) std::fprintf(out_, "note: %s\n", note.c_str());
    problem_.notes.clear();
}

// Files of the frame, and what of it goes into the table.
ExitCode FrameRun::keep(const Deck& now, Solution& solution, Row& row) {
    round_as_file(problem_, solution.x);
    examine(now, problem_, solution);
    row.status = status_row(solution.al.status).name;
    row.newton_steps = solution.al.newton_iterations + solution.al.earlier_newton_iterations +
                       solution.coarse_newton_iterations;
    row.max_distortion = solution.al.iterations.back().max_distortion;
    row.relative_quality = solution.al.iterations.back().relative_quality;
    row.min_scaled_jacobian = solution.certificate.min_scaled_jacobian;
    row.certified = solution.injectivity.certified;
    const Summary summary = summarise(problem_, solution);
    write_summary(deck_, summary);
    if (solution.al.status != Status::converged || !row.certified) {
        write_results(deck_, problem_, solution);
        print_ending(out_, now, problem_, solution, 0);
    }
    if (solution.al.status != Status::converged) return ExitCode::not_converged;
    write_frame(deck_, problem_, solution, row.number);
    row.has_mesh = true;
    state_.x = solution.x;
    state_.frame_of_x = row.number;
    if (!row.certified) return ExitCode::not_certified;
    for (const Expectation& expectation : deck_.expectations)
        if (const ExpectationResult result = check(expectation, summary); !result.holds) {
            row.note = result.text;
            return ExitCode::expectation_failed;
        }
    return ExitCode::success;
}

ExitCode FrameRun::solve_frame(const Deck& now, Row& row) {
    if (row.number > 1) move_target(now, problem_);
    for (const std::string& note : problem_.notes)
        if (std::exchange(told_, note) != note) std::fprintf(out_, "note: %s\n", note.c_str());
    problem_.notes.clear();
    FrameBefore before;
    if (const int n = state_.frame_of_x)
        before = {state_.x, motions_of(deck_at(deck_, times_[n - 1], n), problem_.base)};
    Solution solution = solver_.solve(now, before, row.started_from);
    if (interrupted()) return ExitCode::not_converged;
    return keep(now, solution, row);
}

void FrameRun::print(const Row& row) {
    const int done = row.number - first_, left = static_cast<int>(times_.size()) - row.number;
    std::fprintf(out_, "%6d  %9.4g  %-10s", row.number, row.t, row.status.c_str());
    if (!row.started_from.empty())
        std::fprintf(out_, "  %6d  %9.4g  %8.6f  %8s  %-6s  %7.3fs  %.2fs left", row.newton_steps, row.max_distortion,
                     row.relative_quality, rounded_down(row.min_scaled_jacobian, 4).c_str(), row.started_from.c_str(),
                     row.seconds, left * spent_ / done);
    std::fprintf(out_, "%s%s\n", row.note.empty() ? "" : "  ", row.note.c_str());
    std::fflush(out_);
}

void FrameRun::end_frame(const Row& row) {
    state_.csv += csv_of(row);
    state_.frames = row.number;
    if (row.has_mesh && deck_.vtk != VtkOutput::none) {
        state_.series.emplace_back(frame_name(row.number) + ".vtk", row.t);
        write_series(deck_.output + "/frames.vtk.series", state_.series);
    }
    write_file(deck_.output + "/frames.csv", state_.csv);
    print(row);
}

ExitCode FrameRun::run() {
    resume();
    const ResultsFolder folder(deck_);
    announce();
    write_deck(deck_, problem_);
    const CatchInterrupts catching;
    std::fprintf(out_, "%6s  %9s  %-10s  %6s  %9s  %8s  %8s  %-6s  %8s\n", "frame", "t", "status", "Newton", "max eta",
                 "q", "Jacobian", "from", "time");
    for (int k = first_; k < static_cast<int>(times_.size()); ++k) {
        const Stopwatch watch;
        Row row;
        row.number = k + 1;
        row.t = times_[k];
        ExitCode code = ExitCode::success;
        std::optional<Error> refused;
        try {
            code = solve_frame(deck_at(deck_, row.t, row.number), row);
        } catch (const Error& error) {
            refused = error;
            code = error.exit_code;
            row.status = "refused";
            row.note = error.what();
        }
        if (!refused && interrupted()) {
            std::fprintf(out_, "interrupted in %s; try resume=1, which goes on from here\n",
                         name_of(row.number, row.t).c_str());
            return ExitCode::not_converged;
        }
        spent_ += row.seconds = watch.seconds();
        const bool goes_on = code == ExitCode::success || code == ExitCode::expectation_failed || deck_.keep_going;
        end_frame(row);
        state_.worst = worse(state_.worst, code);
        if (!goes_on) {
            if (refused) throw Error(code, concat(name_of(row.number, row.t), ": ", refused->what()));
            std::fprintf(out_, "%s failed, and the run ends there; keep_going = yes goes on\n",
                         name_of(row.number, row.t).c_str());
            return code;
        }
        write_file(state_path(), text_of(state_, problem_));
    }
    remove_file(state_path());
    std::fprintf(out_, "%s%s; results in %s\n", counted(times_.size(), "frame").c_str(),
                 state_.worst == ExitCode::success ? ", all certified valid and injective"
                                                   : ", not all as wanted: see frames.csv",
                 deck_.output.c_str());
    return state_.worst;
}

}  // namespace

bool names_file(std::string_view frames) {
    return !frames.empty() && frames.find_first_of(",:") == std::string_view::npos && !parse_double(frames);
}

std::vector<double> frame_times(const Deck& deck) {
    const std::string& where = deck.given.at("frames");
    if (names_file(deck.frames)) return times_of_file(where, deck.frames);
    if (deck.frames.find(':') != std::string::npos) return times_of_range(where, deck.frames);
    std::vector<double> times;
    add_times(where, deck.frames, times);
    return times;
}

Deck deck_at(const Deck& deck, double t, int number) {
    Deck now = deck;
    for (DeckBoundary& boundary : now.boundaries) {
        const std::string where = concat(boundary.where, ": boundary ", boundary.name, ", ", name_of(number, t), ": ");
        try {
            boundary.motion = at_time(std::move(boundary.motion), t, number);
        } catch (const UsageError& error) {
            throw UsageError(where, error.what());
        }
        for (const MotionStep& step : boundary.motion.steps)
            if (std::error_code error; !step.file.empty() && !std::filesystem::exists(step.file, error))
                throw UsageError(where, "no such file: ", step.file);
    }
    return now;
}

ExitCode run_frames(const Deck& deck, std::FILE* out) {
    const HandleSignal write_without_reader(SIGPIPE, SIG_IGN);
    const TimeLimit limit(deck.max_seconds);
    set_threads(deck.threads);
    const std::vector<double> times = frame_times(deck);
    for (std::size_t k = 0; k < times.size() && !deck.keep_going; ++k)
        deck_at(deck, times[k], static_cast<int>(k) + 1);
    return FrameRun(deck, out, times).run();
}

}  // namespace almesh
