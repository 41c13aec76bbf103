#include "lessons/child.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest = std::size_t{256} << 20;  // bytes of one result

std::string file;
Limits limits;
int seconds_each = 0;  // 0: no more than the exercise may use
std::string if_late;
Clock::time_point begun;

// In a child.
int to_judge = -1;
const AnswerEntry* table = nullptr;

// What a child sends: one of these, the length of the text, the text.
enum Kind : char { value = 'v', refused = 'r', absent = 'a' };

[[noreturn]] void send(Kind kind, const std::string& text) {
    std::fflush(nullptr);
    std::string all(1, kind);
    put(all, text);
    for (std::size_t sent = 0; sent < all.size();) {
        const ssize_t count = write(to_judge, all.data() + sent, all.size() - sent);
        if (count < 0 && errno != EINTR) break;
        sent += std::max<ssize_t>(count, 0);
    }
    _exit(0);
}

const char* called = "";  // the last answer asked for

void is_absent(int which) { send(absent, which < 0 ? concat("missing ", called) : concat("absent ", which)); }

double seconds_of(const timeval& time) { return 1.0 * time.tv_sec + 1e-6 * time.tv_usec; }

double seconds_of(const rusage& used) { return seconds_of(used.ru_utime) + seconds_of(used.ru_stime); }

double used_by_children() {
    rusage used;
    getrusage(RUSAGE_CHILDREN, &used);
    return seconds_of(used);
}

// Pages for data that this process has; 0 where that is not told.
long pages_of_data() {
    long pages = 0;
    if (std::FILE* const of_process = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(of_process, "%*d %*d %*d %*d %*d %ld", &pages) != 1) pages = 0;
        std::fclose(of_process);
    }
    return pages;
}

void limit(int kind, rlim_t soft, rlim_t hard) {
    rlimit now;
    getrlimit(kind, &now);
    now = {std::min(soft, now.rlim_max), std::min(hard, now.rlim_max)};
    setrlimit(kind, &now);
}

void limit_memory() {
    if (const long pages = pages_of_data()) {
        const rlim_t most = static_cast<rlim_t>(pages) * sysconf(_SC_PAGESIZE) + (rlim_t{1} << 20) * limits.memory;
        limit(RLIMIT_DATA, most, most);
    }
}

void prepare_child(int seconds) {
    setpgid(0, 0);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    limit(RLIMIT_CPU, seconds, seconds + 1);
    limit_memory();
#ifdef _OPENMP
    omp_set_num_threads(1);  // the judge's threads are not there
#endif
}

void load_answers() {
    void* const object = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!object) send(refused, concat("the answers cannot be loaded: ", dlerror()));
    table = static_cast<const AnswerEntry*>(dlsym(object, "almesh_answers"));
    const auto hook = static_cast<void (**)(int)>(dlsym(object, "almesh_is_absent"));
    if (!table || !hook) send(refused, "the answers cannot be loaded");
    *hook = is_absent;
}

[[noreturn]] void compute_in_child(const std::function<void(std::string&)>& compute) {
    std::string bytes;
    try {
        load_answers();
        compute(bytes);
    } catch (const std::bad_alloc&) {
        send(refused, "asks for more memory than it can have");
    } catch (const std::exception& error) {
        send(refused, concat("throws an exception: ", error.what()));
    } catch (...) {
        send(refused, "throws something that is no std::exception");
    }
    send(value, bytes);
}

// Appends what there is to read. False at the end, or where nothing comes before the time is over.
bool read_some(int from, Clock::time_point end, std::string& bytes) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wait = {from, POLLIN, 0};
    const int ready = left > 0 ? poll(&wait, 1, static_cast<int>(std::min<long long>(left, INT_MAX))) : 0;
    if (ready < 0 && errno == EINTR) return true;
    if (ready <= 0) return false;
    char piece[1 << 16];
    const ssize_t count = read(from, piece, sizeof piece);
    if (count > 0) bytes.append(piece, static_cast<std::size_t>(count));
    return count > 0 || (count < 0 && errno == EINTR);
}

// Whether the message is there as a whole.
bool is_whole(const std::string& bytes) {
    std::size_t size = 0;
    if (bytes.size() < 1 + sizeof size) return false;
    std::memcpy(&size, bytes.data() + 1, sizeof size);
    return bytes.size() - 1 - sizeof size >= size;
}

struct Heard {
    std::string bytes;
    bool in_time = true;
    int status = 0;       // of wait4()
    double seconds = 0;   // of processor time
};

// What the child says until it has said all, ends or its time is over. Nothing of it goes on.
Heard listen(int from, pid_t child) {
    Heard heard;
    const Clock::time_point end = begun + std::chrono::seconds(4 * limits.seconds);
    while (!is_whole(heard.bytes) && heard.bytes.size() < longest && read_some(from, end, heard.bytes)) {}
    close(from);
    rusage used{};
    const bool may_end = !is_whole(heard.bytes) && heard.bytes.size() < longest;  // how is worth knowing
    pid_t ended = 0;
    while (may_end && (ended = wait4(child, &heard.status, WNOHANG, &used)) == 0 && Clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    heard.in_time = !may_end || Clock::now() < end;
    kill(-child, SIGKILL);
    if (ended == 0) {
        kill(child, SIGKILL);
        while (wait4(child, &heard.status, 0, &used) < 0 && errno == EINTR) {}
    }
    heard.seconds = seconds_of(used);
    return heard;
}

// allowed: seconds of processor time, those of expect_each_within() where was_limited.
[[noreturn]] void explain(const Heard& heard, int allowed, bool was_limited) {
    int signal = WIFSIGNALED(heard.status) ? WTERMSIG(heard.status) : 0;
    if (signal == SIGKILL && heard.seconds >= 0.7 * allowed) signal = SIGXCPU;  // by the hard limit
    if (heard.bytes.size() >= longest) refuse("returns more than can be read");
    if (!heard.in_time) throw Ended(concat("late ", heard.seconds));
    if (was_limited && signal == SIGXCPU) refuse(if_late);
    throw Ended(concat("ended ", signal ? -signal : WEXITSTATUS(heard.status)));
}

}  // namespace

void take_answers(const std::string& of_answers, const Limits& of_exercise) {
    file = of_answers;
    limits = of_exercise;
    begun = Clock::now();
    limit_memory();
#ifdef __linux__
    prctl(PR_SET_DUMPABLE, 0);  // no child opens the judge's memory, /proc/.../mem, unless the user is root
#endif
}

void expect_each_within(int seconds, const std::string& late) {
    seconds_each = late.empty() ? 0 : seconds;
    if_late = late;
}

bool is_child() { return to_judge >= 0; }

void refuse(const std::string& message) {
    if (is_child()) send(refused, message);
    throw Unmet(message);
}

void* address_of(const char* name) {
    called = name;
    for (const AnswerEntry* entry = table; entry->name; ++entry)
        if (std::strcmp(entry->name, name) == 0) return entry->address;
    is_absent(-1);
    std::abort();
}

std::string from_child(const std::function<void(std::string&)>& compute) {
    const int left = std::max(1, limits.seconds - static_cast<int>(used_by_children()));
    const bool is_limited = seconds_each > 0 && seconds_each < left;
    const int allowed = is_limited ? seconds_each : left;
    std::fflush(nullptr);
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("there is no pipe to a child");
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("there is no process for a child");
    if (child == 0) {
        close(ends[0]);
        to_judge = ends[1];
        prepare_child(allowed);
        compute_in_child(compute);
    }
    setpgid(child, child);
    close(ends[1]);
    const Heard heard = listen(ends[0], child);
    if (!is_whole(heard.bytes)) explain(heard, allowed, is_limited);
    std::string_view rest(heard.bytes);
    rest.remove_prefix(1);
    std::string text;
    take(rest, text);
    if (heard.bytes[0] == refused) throw Unmet(text);
    if (heard.bytes[0] == absent) throw Ended(text);
    if (heard.bytes[0] != value) refuse("the answer sends something that is no result");
    return text;
}

}  // namespace almesh::lessons
