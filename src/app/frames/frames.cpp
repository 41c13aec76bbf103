// A motion in time: one mesh for each of the times t that the key `frames` gives, whose motions are functions of t.
//
// Every mesh minimises the distortion relative to the same ideal mesh, so it depends on its time alone, and errors do
// not accumulate. Earlier meshes only serve as the start, or the ideal mesh if that is as near to the target. The ideal
// mesh, the functional and the symbolic part of the linear solver are made once.
//
// Written after every frame: its mesh, what frame_table.hpp tells, and the state from which a run goes on.
//
// For k = 1, 2, ...: the motions at t_k, the target, the solution, its certificates, its files, the state.
#include "app/commands.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "app/frames/coupling.hpp"
#include "deck/deck_checks.hpp"
#include "deck/frame_times.hpp"
#include "deck/make_problem.hpp"
#include "problem/frame_solver.hpp"
#include "problem/solve.hpp"
#include "report/frame_table.hpp"
#include "report/iteration_table.hpp"
#include "report/mesh_velocity.hpp"
#include "report/results.hpp"
#include "report/results_folder.hpp"
#include "report/terminal.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"

namespace almesh {
namespace {

constexpr int most_halvings = 3;  // of the time between two frames

const TextTable shown{{{"frame", 6}, {"t", 9}, {"status", -10}, {"Newton", 6}, {"max eta", 9}, {"q", 8},
                       {"certified bound", 15}, {"from", -6}, {"time", 8}}};

struct FrameRun {
    // times: none where `coupling` has them. start: the deck whose target the problem has at first.
    FrameRun(const Deck& deck, const Deck& start, const Output& out, std::vector<double> times, Coupling* coupling)
        : deck_(deck), start_(start), out_(out), times_(std::move(times)), coupling_(coupling),
          problem_((EndAtInterrupts(), make_problem(start))) {}

    const Deck &deck_, &start_;
    Output out_;
    std::optional<ResultsFolder> folder_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> log_{nullptr, std::fclose};
    std::vector<double> times_;
    Coupling* coupling_;  // null: there is none
    Problem problem_;
    FrameSolver solver_{problem_};
    FrameTable done_{deck_};
    std::size_t resumed_ = 0;  // of these, by an earlier run
    double spent_ = 0;         // seconds on the others
    FramesBefore before_;  // with a mesh
    std::vector<MeshFace> faces_;     // of the mesh, where what they sweep is written
    std::vector<std::string> files_;  // of the line that asks for the frame
    std::vector<std::string> told_;   // notes
    int between_ = 0;           // frames between the last one and this one,
    bool way_is_valid_ = true;  // for nodes that go through these

    std::string path(const char* name) const { return concat(deck_.output, "/", name); }

    // Rows of frames after the state are computed anew.
    void resume() {
        if (!deck_.resume) return;
        const int last = read_state(deck_, problem_, before_);
        if (last == 0) {
            print(out_, "note: no saved state in ", deck_.output, ": the run starts from the beginning\n");
            return;
        }
        Moment& before = before_.moments.back();
        if (last > static_cast<int>(times_.size()) || times_[last - 1] != before.t)
            throw UsageError("cannot resume: the times of the frames are not those of the run before");
        before.motions = motions_of(deck_at(deck_, before.t, last), problem_.base);
        done_.read(last);
        resumed_ = done_.size();
        print(out_, "resumes after ", frame_at(last, before.t), "\n");
    }

    // Prints each note once.
    void tell_notes() {
        for (const std::string& note : problem_.notes) {
            if (std::find(told_.begin(), told_.end(), note) != told_.end()) continue;
            print(out_, "note: ", note, "\n");
            told_.push_back(note);
        }
        problem_.notes.clear();
    }

    // Writes the files of the frame and its row of the table.
    void keep(const Deck& now, Solution& solution, FrameRow& row) {
        examine(now, problem_, solution);
        const AlIteration& last = solution.al.iterations.back();
        row.status = status_row(solution.al.status).name;
        row.newton_steps = solution.newton_steps();
        row.max_distortion = last.max_distortion;
        row.relative_quality = last.relative_quality;
        row.min_certified_bound = solution.certificate.min_certified_bound;
        row.certified = solution.injectivity.certified;
        if (row.between > 0 && !(row.has_mesh() && row.certified)) return;
        if (row.has_mesh() && folder_->is_kept()) {  // the meshes of an earlier coupled run
            folder_->empty();
            write_deck(deck_, problem_);
        }
        const Summary summary = summarise(problem_, solution);
        if (!folder_->is_kept()) write_summary(deck_, summary);
        if (!row.has_mesh() || !row.certified) {
            row.code = row.has_mesh() ? ExitCode::not_certified : ExitCode::not_converged;
            if (!folder_->is_kept()) write_results(deck_, problem_, solution);
            print_ending(out_, now, problem_, solution, 0);
        }
        if (!row.has_mesh()) return;
        FramesBefore kept = before_;
        kept.push({row.t, solution.x, problem_.motions});
        const std::vector<VtkArray> columns = velocities(deck_, problem_, kept.moments);
        row.mesh = write_frame(deck_, problem_, solution, row.file_name(), columns);
        write_velocities(deck_, problem_, kept.moments, columns, path(row.file_name().c_str()), faces_);
        before_ = std::move(kept);
        for (const Expectation& expectation : deck_.expectations) {
            const ExpectationResult result = check(expectation, summary);
            if (result.holds || row.code != ExitCode::success) continue;
            row.code = ExitCode::expectation_failed;
            row.note = result.text;
        }
    }

    // Kind of the nodes' paths from the frame before; for a repeated time step, from the frame before its first try.
    std::string path_to(const Solution& solution, double t) const {
        const Moment* const from = before_.before(t);
        if (!from || solution.al.status != Status::converged) return "";
        return solver_.is_valid_between(from->x, solution.x) ? frame_path::valid : frame_path::not_valid;
    }

    // If the paths from the frame before are not valid, frames at times between come first.
    void solve(FrameRow& row, int halvings) {
        const Deck now = deck_at(deck_, row.t, row.number, files_);
        if (row.number > 1 || coupling_) move_target(now, problem_);
        tell_notes();
        IterationTable report(out_.text, {problem_.mesh().dim, problem_.frame.length}, problem_.run_id, false);
        Solution solution = solver_.solve(now, before_, row.t, row.started_from, report.observer());
        row.history += report.rows();
        if (interrupted()) return;
        round_as_file(problem_, solution.x);
        row.path = path_to(solution, row.t);
        if (row.path == frame_path::not_valid && halvings < most_halvings && may_halve(row)) {
            const bool divided = solve_between(row, halvings + 1);
            return solve(row, divided ? halvings + 1 : most_halvings);
        }
        if (row.path == frame_path::not_valid) {
            way_is_valid_ = false;
            row.note = "the straight way of the nodes from the frame before is not valid";
        }
        if (row.between > 0) row.between = ++between_;
        else if (!way_is_valid_) row.path = frame_path::not_valid;
        else if (between_ > 0) row.path = concat("split ", between_);
        keep(now, solution, row);
    }

    // Whether motions at the time halfway exist and lead from one frame to the other.
    bool may_halve(const FrameRow& row) const try {
        for (const BoundaryMotion& boundary : deck_.boundaries)
            for (const MotionStep& step : boundary.motion.steps)
                if (coupling_ || step.file.find('%') != std::string::npos) return false;
        const Moment& before = before_.moments.back();
        const auto halfway = motions_of(deck_at(deck_, 0.5 * (before.t + row.t), row.number), problem_.base);
        return solver_.leads(deck_, before.motions, halfway) && solver_.leads(deck_, halfway, problem_.motions);
    } catch (const UsageError&) {
        return false;
    }

    // Solves the frame halfway; whether it has a mesh.
    bool solve_between(const FrameRow& row, int halvings) try {
        const Stopwatch watch;
        FrameRow between{row.number, 1, 0.5 * (before_.moments.back().t + row.t)};
        solve(between, halvings);
        if (!between.has_mesh() || !between.certified) return false;
        between.seconds = watch.seconds();
        done_.add(between);
        out_.tell("frame", between.cells(true));
        show(between);
        return true;
    } catch (const InputError&) {
        return false;  // a target that folds
    }

    void show(const FrameRow& row) {
        Fields cells = {row.label(), to_text(row.t, 4), row.status};
        std::string note;
        if (!row.started_from.empty()) {
            cells.insert(cells.end(), {row.newton_steps, to_text(row.max_distortion, 4), fixed(row.relative_quality, 6),
                                       rounded_down(row.min_certified_bound, 4), row.started_from,
                                       fixed(row.seconds, 3) + "s"});
            if (!coupling_ && row.between == 0)
                note = concat("  ", fixed(static_cast<double>(times_.size() - done_.size()) * spent_ /
                                          static_cast<double>(done_.size() - resumed_), 2), "s left");
        }
        print(out_, shown.line(cells, note + (row.note.empty() ? "" : "  ") + row.note));
        std::fflush(out_);
    }

    void answer(const FrameRow& row) {
        const bool is_valid = row.has_mesh() && row.certified;
        if (is_valid) return coupling_->tell(row.path == frame_path::not_valid ? way_not_valid : row.status, row.mesh);
        coupling_->tell(row.has_mesh() ? "not_certified" : row.status,
                        row.note.empty() ? concat(path(frames_log), " says why") : row.note);
    }

    // The frame after the last one; where a coupled run asks for the same time again, the same frame. False: there is
    // none.
    bool next(FrameRow& row) {
        row = {static_cast<int>(done_.size()) + 1};
        if (!coupling_) {
            if (done_.size() < times_.size()) row.t = times_[done_.size()];
            return done_.size() < times_.size();
        }
        const double none = -std::numeric_limits<double>::infinity();
        const double reached = before_.moments.empty() ? none : before_.moments.back().t;
        const std::optional<AskedFrame> asked = coupling_->next(reached);
        if (!asked) return false;
        row.t = asked->t;
        files_ = asked->files;
        for (std::size_t k = 0; k < done_.size(); ++k)
            if (done_[k].t == row.t) row.number = done_[k].number;
        return true;
    }

    void begin() {
        if (coupling_) {
            log_.reset(std::fopen(path(frames_log).c_str(), "w"));
            if (!log_) throw InputError("cannot write to ", path(frames_log));
            out_ = log_.get();
            identify(deck_, problem_);
        }
        print_mesh(out_, deck_, problem_);
        if (!folder_->is_kept()) write_deck(deck_, problem_);
        told_ = std::exchange(problem_.notes, {});
        print(out_, shown.heading());
    }

    ExitCode end() {
        remove_file(path(frames_state));
        const int folded = done_.count(frame_path::not_valid);
        const bool good = done_.code() == ExitCode::success;
        print(out_, counted(done_.size(), "frame"),
              good ? ", all certified valid and injective" : ", not all as wanted (see frames.csv)",
              folded > 0 ? concat(", ", folded, " without a valid straight way to it") : "",
              folder_->is_kept() ? "; the meshes of the run before are still in " : "; results in ", deck_.output,
              "\n");
        return done_.code();
    }

    ExitCode run() {
        resume();
        folder_.emplace(start_);
        begin();
        for (FrameRow row; next(row);) {
            const CatchInterrupts catching;  // not while a coupled run waits
            const Stopwatch watch;
            const std::string name = frame_at(row.number, row.t);
            between_ = 0;
            way_is_valid_ = true;
            try {
                solve(row, 0);
            } catch (const Error& error) {
                row.refuse(error);
            }
            if (row.note.empty() && interrupted()) {
                const bool is_saved = !coupling_ && !before_.moments.empty();
                print(out_, "interrupted in ", name, is_saved ? "; try resume=1, which goes on from here\n" : "\n");
                if (coupling_) coupling_->tell("interrupted", "the run has ended");
                return ExitCode::not_converged;
            }
            spent_ += row.seconds = watch.seconds();
            try {
                done_.add(row, !folder_->is_kept());
                out_.tell("frame", row.cells(true));
            } catch (const InputError& error) {  // a disk that is full
                if (!coupling_) throw;
                row.refuse(error);
            }
            const bool goes_on = row.code == ExitCode::success || row.code == ExitCode::expectation_failed;
            if (!goes_on && !deck_.keep_going && !coupling_)
                throw Error(row.code,
                            concat(name, ": ", row.note.empty() ? row.status : row.note,
                                   "\nthe frames before it are there; keep_going = yes goes on with the next"));
            show(row);
            if (coupling_) answer(row);
            else if (row.has_mesh()) save_state(deck_, problem_, before_, row.number);
        }
        return end();
    }
};

}  // namespace

ExitCode run_frames(const Deck& deck, const Output& out) {
    const TimeLimit limit(deck.max_seconds);
    set_threads(deck.threads);
    check_times(deck);
    if (is_coupled(deck.frames)) {
        if (out.objects) throw UsageError("frames = -: its answers are lines of their own: without --json");
        Coupling coupling(stdin, out, files_in_line(deck));
        return FrameRun(deck, deck_at_rest(deck), out, {}, &coupling).run();
    }
    const std::vector<double> times = frame_times(deck);
    for (std::size_t k = 0; k < times.size() && !deck.keep_going; ++k)
        deck_at(deck, times[k], static_cast<int>(k) + 1);
    return FrameRun(deck, deck_at(deck, times[0], 1), out, times, nullptr).run();
}

}  // namespace almesh
