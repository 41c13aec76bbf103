// The program's sparse Cholesky against CHOLMOD (Chen, Davis, Hager & Rajamanickam, ACM Trans. Math. Softw. 35, 2008)
// on matrices of first Newton steps. From the top folder:
//
//   make compare-cholmod                                        about a minute
//   OMP_NUM_THREADS=1 make compare-cholmod SYSTEMS='circle refine=4 curving'
//
// SYSTEMS: decks of inputs/, each with settings in place of its own.
//
// Prints tables and writes outputs/compare-cholmod.txt. This is a program of its own: nothing else needs CHOLMOD.
//
// Each solver has processes of its own: memory, pages and threads of the one are not the other's, nor do idle threads
// of a BLAS, which may spin, take a core from the program's. The first analysis, factorisation and solve of a process
// are the cold ones. Both start from the matrix in their own format, and neither solve is refined.
#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "bench/newton_system.hpp"
#include "bench/timing.hpp"
#include "linalg/direct/cholesky.hpp"

#if __has_include(<suitesparse/cholmod.h>)
#include <suitesparse/cholmod.h>
#else
#include <cholmod.h>
#endif

namespace almesh::bench {
namespace {

constexpr int processes = 3;  // of each solver for each system, in turns
constexpr int warm_calls = 5;
constexpr const char* stages[] = {"analysis", "factorisation", "solve"};
constexpr const char* solvers[] = {"almesh", "CHOLMOD"};

// ------------------------------------------------------------------------------------------------------------ solvers

class Own {
public:
    explicit Own(const NewtonSystem& system) : system_(system), x_(system.b.size()) {}

    void analyse() { cholesky_ = std::make_unique<Cholesky>(system_.A); }
    void forget() { cholesky_.reset(); }
    void factor() {
        const FactorResult result = cholesky_->factor(system_.A);
        if (result.status != SolveStatus::success) throw InputError(concat("almesh: ", reason(result.status)));
    }
    void solve() { cholesky_->solve(system_.b.data(), x_.data()); }

    std::vector<double> solution() const { return x_; }
    double factor_entries() const { return cholesky_->factor_entries(); }
    std::string ordering() const { return "nested dissection"; }

private:
    const NewtonSystem& system_;
    std::unique_ptr<Cholesky> cholesky_;
    std::vector<double> x_;
};

class Cholmod {
public:
    explicit Cholmod(const NewtonSystem& system) : b_(system.b) {
        cholmod_start(&common_);
        common_.print = 0;
        common_.supernodal = CHOLMOD_SUPERNODAL;
        common_.nmethods = 1;
        common_.method[0].ordering = CHOLMOD_METIS;
        take_lower_triangle(system.A);

        right_.nrow = right_.nzmax = right_.d = b_.size();
        right_.ncol = 1;
        right_.x = b_.data();
        right_.xtype = CHOLMOD_REAL;
        right_.dtype = CHOLMOD_DOUBLE;
    }
    ~Cholmod() {
        forget();
        cholmod_free_dense(&x_, &common_);
        cholmod_free_dense(&y_, &common_);
        cholmod_free_dense(&e_, &common_);
        cholmod_finish(&common_);
    }
    Cholmod(const Cholmod&) = delete;
    Cholmod& operator=(const Cholmod&) = delete;

    void analyse() {
        L_ = cholmod_analyze(&A_, &common_);
        check(L_ != nullptr);
    }
    void forget() { cholmod_free_factor(&L_, &common_); }
    void factor() { check(cholmod_factorize(&A_, L_, &common_)); }
    // solve2 keeps solution and workspace for the next call.
    void solve() { check(cholmod_solve2(CHOLMOD_A, L_, &right_, nullptr, &x_, nullptr, &y_, &e_, &common_)); }

    std::vector<double> solution() const {
        const double* const x = static_cast<const double*>(x_->x);
        return {x, x + b_.size()};
    }
    double factor_entries() const { return common_.lnz; }
    // What L says it was ordered by: a library built without METIS takes another.
    std::string ordering() const {
        constexpr const char* name[] = {"natural", "given", "AMD", "METIS", "NESDIS", "COLAMD", "natural, postordered"};
        return concat(name[L_->ordering], L_->is_super ? ", supernodal" : ", simplicial");
    }

private:
    // By columns, the scalar rows from the diagonal down: as A is symmetric, a column is a row of A.
    void take_lower_triangle(const BlockCsr& A) {
        start_.assign(1, 0);
        for (int j = 0; j < A.size(); ++j) {
            const int block_row = j / A.d, r = j % A.d;
            for (int k = A.row[block_row]; k < A.row[block_row + 1]; ++k)
                for (int c = 0; c < A.d; ++c) {
                    const int i = A.col[k] * A.d + c;
                    if (i < j) continue;
                    row_.push_back(i);
                    value_.push_back(A.block(k)[r * A.d + c]);
                }
            start_.push_back(static_cast<int>(row_.size()));
        }
        A_.nrow = A_.ncol = start_.size() - 1;
        A_.nzmax = row_.size();
        A_.p = start_.data();
        A_.i = row_.data();
        A_.x = value_.data();
        A_.stype = -1;
        A_.itype = CHOLMOD_INT;
        A_.xtype = CHOLMOD_REAL;
        A_.dtype = CHOLMOD_DOUBLE;
        A_.sorted = A_.packed = 1;
    }

    // Warnings have positive status; that of a matrix that is not positive definite is one.
    void check(bool done) const {
        if (common_.status == CHOLMOD_NOT_POSDEF) throw InputError("CHOLMOD: the matrix is not positive definite");
        if (done && common_.status >= 0) return;
        if (common_.status == CHOLMOD_NOT_INSTALLED)
            throw InputError("CHOLMOD: this library was built without METIS; Debian's libsuitesparse-dev has it");
        throw InputError(concat("CHOLMOD: status ", common_.status, ", see cholmod_core.h for what it means"));
    }

    std::vector<int> start_, row_;
    std::vector<double> value_, b_;
    cholmod_common common_{};
    cholmod_sparse A_{};
    cholmod_dense right_{};
    cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
    cholmod_factor* L_ = nullptr;
};

// Which library does the dense work is only known when the program runs.
std::string name_of_blas() {
    if (const auto config = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_config"))) return config();
    Dl_info library{};
    void* const dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
    if (!dgemm || !dladdr(dgemm, &library) || !library.dli_fname) return "BLAS unknown";
    return concat("BLAS ", library.dli_fname, ", not OpenBLAS: `apt-get install libopenblas0-pthread` is faster");
}

std::string name_of_cholmod() {
    int version[3];
    cholmod_version(version);
    return concat("CHOLMOD ", version[0], ".", version[1], ".", version[2], ", ", name_of_blas());
}

// ---------------------------------------------------------------------------------------------------- in one process

struct System {
    std::string deck;
    std::vector<std::string> settings;
    std::string name() const {
        std::string text = deck;
        for (const std::string& setting : settings) text += " " + setting;
        return text;
    }
};

template <class Body>
double seconds_of(const Body& body) {
    const Stopwatch watch;
    body();
    return watch.seconds();
}

template <class Body>
double best_warm(const Body& body) {
    double best = std::numeric_limits<double>::infinity();
    for (int call = 0; call < warm_calls; ++call) best = std::min(best, body());
    return best;
}

// Prints "key = value" lines, which the starting process reads.
template <class Solver>
void measure(const System& chosen) {
    const NewtonSystem system(chosen.deck, chosen.settings);
    Solver solver(system);
    const auto analyse = [&] { return solver.forget(), seconds_of([&] { solver.analyse(); }); };
    const auto factor = [&] { return seconds_of([&] { solver.factor(); }); };
    const auto solve = [&] { return seconds_of([&] { solver.solve(); }); };
    const double cold[] = {analyse(), factor(), solve()};
    const double residual = scaled_residual(system.A, solver.solution(), system.b);
    const double warm_analysis = best_warm(analyse);
    solver.factor();  // allocates
    const double warm[] = {warm_analysis, best_warm(factor), best_warm(solve)};
    for (int s = 0; s < 3; ++s) std::printf("cold %s = %.9g\nwarm %s = %.9g\n", stages[s], cold[s], stages[s], warm[s]);
    std::printf("unknowns = %d\nentries = %.17g\nresidual = %.9g\n", system.A.size(), solver.factor_entries(),
                residual);
    std::printf("ordering = %s\nlibrary = %s\n", solver.ordering().c_str(), name_of_cholmod().c_str());
}

// ------------------------------------------------------------------------------------------------------ all processes

using Answer = std::map<std::string, std::string>;

// Runs this program again: `program --solver deck settings`.
Answer ask(const std::string& program, const std::string& solver, const System& system) {
    std::vector<std::string> words = {program, "--" + solver, system.deck};
    words.insert(words.end(), system.settings.begin(), system.settings.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    int ends[2];
    if (pipe(ends) != 0) throw InputError("cannot open a pipe to a new process");
    std::fflush(stdout);
    const pid_t child = fork();
    if (child < 0) throw InputError("cannot start a process");
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    close(ends[1]);
    std::string text;
    char buffer[4096];
    for (ssize_t size; (size = read(ends[0], buffer, sizeof buffer)) > 0;) text.append(buffer, size);
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw InputError(concat(solver, " did not get to its end with ", system.name()));

    Answer answer;
    for (const std::string_view line : split(text, '\n'))
        if (const auto equals = line.find(" = "); equals != line.npos)
            answer.emplace(line.substr(0, equals), line.substr(equals + 3));
    return answer;
}

// The answers of several processes. What a cold call waits for, above all new memory, differs between processes and is
// no noise to be left out: the median. Warm calls: the best.
class Measured {
public:
    void add(Answer answer) { answers_.push_back(std::move(answer)); }
    const std::string& text(const std::string& key) const { return answers_.front().at(key); }
    double number(const std::string& key) const { return numbers(key).front(); }
    double cold(const std::string& stage) const { return median(numbers("cold " + stage)); }
    double warm(const std::string& stage) const { return std::ranges::min(numbers("warm " + stage)); }

private:
    std::vector<double> numbers(const std::string& key) const {
        std::vector<double> values;
        for (const Answer& answer : answers_) values.push_back(parse_double(answer.at(key)).value());
        return values;
    }

    std::vector<Answer> answers_;
};

std::string left(const std::string& text, std::size_t width) {
    return text + std::string(width - std::min(width, text.size()), ' ');
}

std::string right(const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, text.size()), ' ') + text;
}

std::string right(const char* format, double value, std::size_t width) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return right(text, width);
}

constexpr std::size_t name_width = 20;

std::string head_of_times() {
    std::string text = left("", name_width + 14), line = left("ms", name_width + 14);
    for (const std::string kind : {"cold", "warm"}) {
        text += right(kind, 20) + right("", 16);
        line += right(solvers[0], 12) + right(solvers[1], 12) + right("ratio", 12);
    }
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n" + line + "\n";
}

// One line per stage: times in milliseconds, and how many times as long CHOLMOD takes.
std::string rows_of_times(const System& system, const Measured& own, const Measured& theirs) {
    std::string text;
    for (const std::string stage : stages) {
        text += left(stage == stages[0] ? system.name() : "", name_width) + left(stage, 14);
        for (const auto time : {&Measured::cold, &Measured::warm}) {
            const double a = (own.*time)(stage), b = (theirs.*time)(stage);
            text += right("%.2f", 1e3 * a, 12) + right("%.2f", 1e3 * b, 12) + right("%.2f", b / a, 12);
        }
        text += "\n";
    }
    return text;
}

std::string head_of_factors() {
    std::string text = left("", name_width + 10) + right("nnz(L)", 22) + right("", 14) + right("scaled residual", 26);
    text += "\n";
    text += left("", name_width) + right("unknowns", 10) + right(solvers[0], 12) + right(solvers[1], 12);
    return text + right("ratio", 12) + right(solvers[0], 13) + right(solvers[1], 13) + "  ordering of CHOLMOD\n";
}

std::string row_of_factor(const System& system, const Measured& own, const Measured& theirs) {
    const double a = own.number("entries"), b = theirs.number("entries");
    return left(system.name(), name_width) + right(own.text("unknowns"), 10) + right("%.0f", a, 12) +
           right("%.0f", b, 12) + right("%.2f", b / a, 12) + right("%.1e", own.number("residual"), 13) +
           right("%.1e", theirs.number("residual"), 13) + "  " + theirs.text("ordering") + "\n";
}

// Words with = are settings of the deck before them.
std::vector<System> read_systems(std::vector<std::string> words) {
    if (words.empty()) words = {"circle-refined-3", "curving", "aircraft"};
    std::vector<System> systems;
    for (const std::string& word : words) {
        if (word.find('=') == word.npos) systems.push_back({word, {}});
        else if (systems.empty()) throw InputError("a deck of inputs/ comes before its settings: circle refine=4");
        else systems.back().settings.push_back(word);
    }
    return systems;
}

// The processes to come: as many threads for one as for the other, which wait as those of ./almesh do. CHOLMOD asks for
// four in its own loops whatever OMP_NUM_THREADS says, so the limit too.
void set_environment(int threads) {
    const std::string count = std::to_string(threads);
    for (const char* name : {"OMP_NUM_THREADS", "OMP_THREAD_LIMIT", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS",
                             "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"})
        setenv(name, count.c_str(), 1);
    if (std::getenv("OMP_WAIT_POLICY")) return;
    setenv("OMP_WAIT_POLICY", "passive", 0);
    setenv("GOMP_SPINCOUNT", "1000", 0);
}

void compare(const std::string& program, const std::vector<System>& systems) {
    const int threads = max_threads();
    set_environment(threads);
    make_folder("outputs");
    std::string report, factors = head_of_factors();
    const auto print = [&](const std::string& text) {
        std::fputs(text.c_str(), stdout);
        std::fflush(stdout);
        report += text;
    };
    for (const System& system : systems) {
        Measured own, theirs;
        for (int p = 0; p < processes; ++p) {
            own.add(ask(program, "almesh", system));
            theirs.add(ask(program, "cholmod", system));
        }
        if (report.empty())
            print(concat("Sparse Cholesky of the first Newton matrix: almesh, and ", theirs.text("library"), "\n",
                         counted(threads, "thread"), " for both, ", processes, " processes each, in turns. ",
                         "Cold: the first call of a process, median; warm: the best of\n", warm_calls,
                         " further calls of each. Ratio: CHOLMOD over almesh, above 1 where almesh is faster.\n\n",
                         head_of_times()));
        print(rows_of_times(system, own, theirs));
        factors += row_of_factor(system, own, theirs);
    }
    print("\n" + factors);
    write_file("outputs/compare-cholmod.txt", report);
    std::printf("\noutputs/compare-cholmod.txt\n");
}

}  // namespace
}  // namespace almesh::bench

int main(int argc, char** argv) {
    using namespace almesh::bench;
    try {
        const std::string first = argc > 1 ? argv[1] : "";
        if (first == "--almesh") measure<Own>(read_systems({argv + 2, argv + argc}).front());
        else if (first == "--cholmod") measure<Cholmod>(read_systems({argv + 2, argv + argc}).front());
        else compare(argv[0], read_systems({argv + 1, argv + argc}));
    } catch (const almesh::Error& error) {
        std::fprintf(stderr, "compare-cholmod: %s\n", error.what());
        return 1;
    }
    return 0;
}
