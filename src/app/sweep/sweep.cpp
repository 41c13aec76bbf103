// Many runs of one deck: one for each combination of the values of its lines
//
//   sweep KEY = VALUES            # any key of the deck or `let` constant; the last line varies fastest
//
// VALUES: separated by commas, FROM : STEP : TO for all of a range. Each run is the one of `almesh DECK KEY=VALUE ...`,
// to the last bit, in a folder of its own named by its values: outputs/circle/mu0=10,refine=1. A run that has come to
// its end, whatever that was, leaves the file sweep.row there, and is not done again while deck, its files and program
// are the same; runs that were killed have none. The runs of a sweep that is killed are killed with it.
//
// Every run is a process of its own: one that crashes or is killed takes none of the others with it.
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "app/commands.hpp"
#include "base/version.hpp"
#include "deck/deck.hpp"
#include "deck/frame_times.hpp"
#include "deck/make_problem.hpp"
#include "report/results_folder.hpp"
#include "base/files.hpp"
#include "base/interrupt.hpp"
#include "base/stopwatch.hpp"
#include "base/table.hpp"

namespace almesh {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_runs = 100000;

struct Run {
    int number = 0;    // from 1
    std::string name;  // of its folder: mu0=10,refine=1
    Fields values;      // by the names of what they are of
    Deck deck;
    std::string id;   // what sweep.row begins with: of program, deck and its files
    std::string row;  // of sweep.csv, "" where the run has not ended
};

// The name of a folder that no shell takes apart.
std::string as_name(std::string text) {
    constexpr std::string_view plain = "=+-._";
    const auto is_plain = [&](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || plain.find(c) != plain.npos;
    };
    for (char& c : text) c = is_plain(c) ? c : '_';
    return text;
}

std::string in_shell_quotes(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

// Whether the run has ended. The row that it has left, unless it was another one, is read, and told in JSON, once.
bool has_ended(Run& run, const Output& out) {
    const std::string file = run.deck.output + "/" + sweep_row;
    std::error_code error;
    if (!run.row.empty() || !fs::exists(file, error)) return !run.row.empty();
    const std::string text = read_file(file);
    if (!text.starts_with(run.id)) return false;
    const std::size_t begin = run.id.size(), end = text.find('\n', begin) + 1;
    run.row = text.substr(begin, end - begin);
    out.tell("run", {{"number", run.number}, {"output", run.deck.output},
                     {{"results", "", "JSON"}, std::string(trim(std::string_view(text).substr(end)))}});
    return true;
}

// Number, exit code, values, the quantities of summary.txt, and a note.
std::string heading(const Deck& deck) {
    Fields cells = {"number", "exit_code"};
    for (const Sweep& sweep : deck.sweeps) cells.emplace_back(sweep.name);
    for (const Named& quantity : summary_quantities()) cells.emplace_back(quantity.name);
    cells.emplace_back("note");
    return csv_row(cells);
}

// All but its number, and the same in JSON on a line of its own.
std::string row_of(const Run& run, ExitCode code, const std::string& note) {
    const bool is_refused = code == ExitCode::usage || code == ExitCode::input;
    std::map<std::string, std::string, std::less<>> summary;
    const std::string text = note.empty() ? read_file(run.deck.output + "/summary.txt")
                                          : concat("status = ", is_refused ? "refused" : "failed");
    for (const std::string_view line : split(text, '\n'))
        if (const auto at = line.find(" = "); at != std::string_view::npos)
            summary.emplace(line.substr(0, at), line.substr(at + 3));
    Fields cells = {{"exit_code", static_cast<int>(code)}, {"values", json(run.values)}};
    for (const Named& quantity : summary_quantities()) cells.emplace_back(quantity, summary[quantity.name]);
    cells.emplace_back("note", note);
    const std::string line = json(cells).text + "\n";
    cells.insert(cells.erase(cells.begin() + 1), run.values.begin(), run.values.end());
    return csv_row(cells) + line;
}

std::string status_of(const Run& run) { return std::string(split(run.row, ',')[run.values.size() + 1]); }

// In this process; what it prints goes to log.txt. It leaves a row but where it was interrupted.
ExitCode run_one(const Run& run) {
    make_folder(run.deck.output);
    const std::string log = run.deck.output + "/log.txt";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(log.c_str(), "w"), std::fclose);
    if (!file) throw InputError("cannot write to ", log, ": ", std::strerror(errno));
    ExitCode code = ExitCode::success;
    std::string note;
    try {
        code = almesh::run(run.deck, file.get());
    } catch (const Error& error) {
        code = error.exit_code;
        note = error.what();
        print(file.get(), "almesh: ", error.what(), "\n");
    }
    if (interrupt_flag == 0) write_file(run.deck.output + "/" + sweep_row, run.id + row_of(run, code, note));
    return code;
}

// Its exit code is that of the run. It does not outlive a sweep that is killed, where the system is Linux.
pid_t start_process(const Run& run) {
    std::fflush(nullptr);  // else the child has what is not yet written, too
    const pid_t sweep = getpid(), child = fork();
    if (child < 0) throw InputError("cannot start a process: ", std::strerror(errno));
    if (child > 0) return child;
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != sweep) raise(SIGKILL);  // it was killed before
    ExitCode code = ExitCode::input;
    try {
        code = run_one(run);
    } catch (const std::exception& error) {
        print(stderr, "almesh: ", run.name, ": ", error.what(), "\n");
    }
    std::_Exit(static_cast<int>(code));
}

struct SweepRun {
    struct Child {
        Run* run;
        Stopwatch watch;
    };

    std::string path_;
    std::vector<std::string> settings_;
    Output out_;
    Deck deck_;
    std::vector<Run> runs_;
    std::set<std::string> names_;
    FileHashes hash_;  // of the files that decks name
    std::map<pid_t, Child> children_;
    int done_ = 0, done_before_ = 0;
    Stopwatch watch_;

    std::string path(const char* name) const { return concat(deck_.output, "/", name); }

    // All decks are read before the first run starts.
    SweepRun(const std::string& path, const std::vector<std::string>& settings, const Output& out)
        : path_(path), settings_(settings), out_(out), deck_(read_deck(path, settings)) {
        const std::vector<Sweep>& sweeps = deck_.sweeps;
        if (sweeps.empty()) throw UsageError(path, ": there is no line `sweep KEY = VALUES`; one run is almesh ", path);
        std::size_t count = 1;
        for (const Sweep& sweep : sweeps)
            if ((count *= sweep.values.size()) > most_runs)
                throw UsageError(sweep.where, ": these are more than ", most_runs, " runs");
        for (std::size_t k = 0; k < count; ++k) {
            std::vector<std::string> values(sweeps.size());
            std::size_t rest = k;
            for (std::size_t s = values.size(); s-- > 0; rest /= sweeps[s].values.size())
                values[s] = sweeps[s].values[rest % sweeps[s].values.size()];
            add_run(values);
        }
    }

    void add_run(const std::vector<std::string>& values) {
        Run run;
        run.number = static_cast<int>(runs_.size()) + 1;
        std::vector<std::string> settings = settings_;
        for (std::size_t s = 0; s < values.size(); ++s) {
            const std::string& key = deck_.sweeps[s].name;
            const std::string name = find_row(deck_keys(), key) ? key : "let " + key;
            std::erase_if(settings, [&](const std::string& earlier) { return split(earlier, '=')[0] == name; });
            settings.push_back(concat(name, "=", values[s]));
            run.values.emplace_back(key, values[s]);
            run.name += (s == 0 ? "" : ",") + as_name(concat(key, "=", values[s]));
        }
        if (!names_.insert(run.name).second) run.name += concat("-", run.number);
        try {
            run.deck = read_deck(path_, settings);
        } catch (const UsageError& error) {
            throw UsageError(deck_.sweeps.front().where, ": the run ", run.name, ": ", error.what());
        }
        if (is_coupled(run.deck.frames))
            throw UsageError(run.name, ": frames = - has no end that a sweep can wait for");
        run.deck.sweeps.clear();
        run.deck.output = deck_.output + "/" + run.name;
        if (run.deck.threads == 0) run.deck.threads = 1;
        if (run.deck.frames.empty()) run.deck.resume = 0;  // it goes on by runs
        run.id = concat("# ", version(), ", commit ", commit(), ", run ", run_id(run.deck, hash_), "\n");
        runs_.push_back(std::move(run));
    }

    void read_rows() {
        for (Run& run : runs_) done_ += has_ended(run, out_);
        done_before_ = done_;
        if (done_ > 0) print(out_, done_, " of ", counted(runs_.size(), "run"), " done before\n");
    }

    // A run's process has ended.
    void end(pid_t process, int status) {
        const Child child = children_.at(process);
        children_.erase(process);
        Run& run = *child.run;
        done_ += has_ended(run, out_);
        std::string how = run.row.empty() ? concat("no result, exit code ", WEXITSTATUS(status)) : status_of(run);
        if (WIFSIGNALED(status)) how = concat("killed by signal ", WTERMSIG(status));
        const double left = watch_.seconds() / std::max(1, done_ - done_before_) *
                            static_cast<double>(static_cast<int>(runs_.size()) - done_);
        print(out_, padded(concat(done_), 5), " of ", runs_.size(), "  ", padded(run.name, -30), "  ", padded(how, -14),
              "  ", padded(fixed(child.watch.seconds(), 3), 8), "s  ", fixed(left, 2), "s left\n");
        std::fflush(out_);
    }

    ExitCode run_here() {
        make_folder(deck_.output);
        const FolderLock lock(deck_.output);  // held by the runs' processes too
        read_rows();
        const CatchInterrupts catching;
        const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        bool told = false;
        for (auto next = runs_.begin(); next != runs_.end() || !children_.empty();) {
            int threads = 0;
            for (const auto& child : children_) threads += child.second.run->deck.threads;
            if (interrupted()) {
                next = runs_.end();
                for (const auto& child : children_)
                    if (!told) kill(child.first, SIGTERM);
                told = true;
            }
            if (next != runs_.end() && !next->row.empty()) {
                ++next;
            } else if (next != runs_.end() && (threads == 0 || threads + next->deck.threads <= cores)) {
                children_.emplace(start_process(*next), Child{&*next, {}});
                ++next;
            } else if (int status = 0; const pid_t ended = waitpid(-1, &status, WNOHANG)) {
                if (ended > 0) end(ended, status);
            } else {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        }
        return collect();
    }

    // In this process, one after the other.
    ExitCode run_task(int first, int step) {
        read_rows();
        const CatchInterrupts catching;
        for (std::size_t k = first - 1; k < runs_.size() && !interrupted(); k += step) {
            if (!runs_[k].row.empty()) continue;
            print(out_, runs_[k].name, "\n");
            std::fflush(out_);
            run_one(runs_[k]);
            has_ended(runs_[k], out_);
        }
        return interrupted() ? ExitCode::not_converged : ExitCode::success;
    }

    // Rows of what has ended, in the order of the runs; which have failed, and which are missing.
    ExitCode collect() {
        std::string table = heading(deck_);
        std::map<ExitCode, int> ended;
        int missing = 0;
        for (Run& run : runs_) {
            if (!has_ended(run, out_)) {
                print(out_, "no result: ", run.name, "\n");
                ++missing;
                continue;
            }
            const auto code = static_cast<ExitCode>(parse_int(run.row.substr(0, run.row.find(','))).value_or(0));
            if (code != ExitCode::success)
                print(out_, "exit code ", static_cast<int>(code), ": ", run.name, ", ", status_of(run),
                      ": log.txt in its folder\n");
            ++ended[code];
            table += concat(run.number, ",", run.row);
        }
        write_file(path("sweep.csv"), table);
        out_.add({{"runs", runs_.size()}, {"missing_runs", missing}, {"output", deck_.output}});
        std::string text = counted(runs_.size(), "run") + ":";
        for (const auto& [code, count] : ended)
            text += concat(" ", count, " of exit code ", static_cast<int>(code), ",");
        if (missing > 0) text += concat(" ", missing, " without result, which the same command runs again,");
        print(out_, text, " table in ", path("sweep.csv"), "\n");
        if (missing > 0) ended[ExitCode::not_converged] += missing;
        ended.erase(ExitCode::success);
        return ended.empty() ? ExitCode::success : ended.begin()->first;
    }

    ExitCode write_script() const {
        constexpr std::size_t most_tasks = 1000;  // Slurm's own limit is 1001, where its administrator sets no other
        std::error_code error;
        const fs::path program = fs::read_symlink("/proc/self/exe", error);
        const std::size_t tasks = std::min(runs_.size(), most_tasks);
        std::string command = in_shell_quotes(error ? "almesh" : program.string()) + " sweep " + in_shell_quotes(path_);
        for (const std::string& setting : settings_) command += " " + in_shell_quotes(setting);
        const std::string script = concat(
            "#!/bin/bash\n"
            "#SBATCH --job-name=", as_name(deck_.name), "\n"
            "#SBATCH --array=1-", tasks, "\n"
            "#SBATCH --cpus-per-task=", runs_.front().deck.threads, "\n"
            "#SBATCH --requeue\n"
            "#SBATCH --output=", fs::absolute(deck_.output).string(), "/slurm-%a.out\n"
            "# Runs that have ended are not run again: submit it again after a failure. Then gather:\n"
            "# ", command, " --collect\n"
            "cd ", in_shell_quotes(fs::current_path().string()), " || exit 2\n"
            "exec ", command, " --run \"$SLURM_ARRAY_TASK_ID/", tasks, "\"\n");
        make_folder(deck_.output);
        write_file(path("sweep.sh"), script);
        print(out_, counted(runs_.size(), "run"), " in ", counted(tasks, "task"),
              " of a job array; submit it, then gather:\n  sbatch ", path("sweep.sh"), "\n  ", command, " --collect\n");
        return ExitCode::success;
    }
};

// K/N
std::pair<int, int> task_of(const std::string& text) {
    const auto slash = text.find('/');
    const auto first = parse_int(text.substr(0, slash), 1);
    const auto step = slash == std::string::npos ? std::nullopt : parse_int(text.substr(slash + 1), 1);
    if (!first || !step) throw UsageError("--run ", text, ": expected K/N, the runs K, K + N, K + 2 N, ...");
    return {*first, *step};
}

}  // namespace

ExitCode sweep(const std::vector<std::string>& arguments, const Output& out) {
    std::vector<std::string> settings;
    std::string mode, task;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        const std::string& argument = arguments[i];
        if (!argument.starts_with("--")) {
            settings.push_back(argument);
            continue;
        }
        if (!mode.empty()) throw UsageError("sweep: ", mode, " and ", argument, ": one at a time");
        mode = argument;
        if (mode == "--run") task = ++i < arguments.size() ? arguments[i] : "";
    }
    if (arguments.empty() || arguments[0].starts_with("-"))
        throw UsageError("sweep takes a deck: almesh sweep DECK [key=value ...]");
    const auto [first, step] = mode == "--run" ? task_of(task) : std::pair(1, 1);
    SweepRun runs(arguments[0], settings, out);
    if (mode.empty()) return runs.run_here();
    if (mode == "--run") return runs.run_task(first, step);
    if (mode == "--slurm") return runs.write_script();
    if (mode == "--collect") return runs.collect();
    throw UsageError("sweep: unknown option ", mode, did_you_mean(mode, {"--slurm", "--run", "--collect"}));
}

}  // namespace almesh
