#include "bench/deck_run.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/stopwatch.hpp"
#include "base/text.hpp"
#include "support/rows.hpp"
#include "support/temporary_folder.hpp"

namespace almesh::bench {
namespace {

[[noreturn]] void become(std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
}

std::map<std::string, double> numbers_of(const std::string& path) {
    std::map<std::string, double> numbers;
    for (const std::string& line : test::pieces(read_text_file(path), '\n')) {
        const auto equals = line.find(" = ");
        if (equals == std::string::npos) continue;
        if (const auto value = parse_double(line.substr(equals + 3))) numbers[line.substr(0, equals)] = *value;
    }
    return numbers;
}

}  // namespace

DeckRun run_deck(const std::string& name, std::vector<std::string> settings) {
    const test::TemporaryFolder folder;
    settings.insert(settings.begin(), {"./almesh", "inputs/" + name + ".deck", "output=" + folder.path("out")});
    DeckRun run;
    const Stopwatch watch;
    const pid_t child = fork();
    if (child < 0) throw InputError("the benchmark cannot start a process");
    if (child == 0) become(settings);
    int status = 0;
    waitpid(child, &status, 0);
    run.wall = watch.seconds();
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (run.exit_code < 0 || run.exit_code == 1 || run.exit_code == 2 || run.exit_code == 127)
        throw InputError("inputs/" + name + ".deck did not run: exit code " + std::to_string(run.exit_code));
    run.summary = numbers_of(folder.path("out") + "/summary.txt");
    run.peak_memory = 1024 * 1024 * run.summary["peak_memory_mb"];
    return run;
}

}  // namespace almesh::bench
