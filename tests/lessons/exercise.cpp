#include "lessons/exercise.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>

#include "support/program.hpp"

namespace almesh::lessons {
namespace {

struct Entry {
    std::string number, title;
    void (*check)();
};

std::vector<Entry>& exercises() {
    static std::vector<Entry> all;
    return all;
}

std::string& answers() {  // folder of the decks
    static std::string folder;
    return folder;
}

bool is_random = false;  // whether the exercise has asked for random numbers

unsigned seed() {
    static const char* const given = std::getenv("SEED");
    static const unsigned value = given ? static_cast<unsigned>(std::atoi(given)) : std::random_device()() % 1000000;
    return value;
}

// "" where it holds.
std::string verdict(const Entry& exercise) {
    expect_each_within(0, "");
    random_inputs() = Random(seed());
    is_random = false;
    try {
        exercise.check();
        return "";
    } catch (const Unmet& unmet) {
        return concat(unmet.what(), is_random ? concat(" (the same inputs again: SEED=", seed(), ")") : "");
    } catch (const Ended& ended) {
        return ended.what();
    } catch (const std::bad_alloc&) {
        return "asks for more memory than it can have";
    } catch (const std::exception& error) {
        return concat("throws an exception: ", error.what());
    } catch (...) {
        return "throws something that is no std::exception";
    }
}

void print(const Entry& exercise, const std::string& message) {
    const char* const number = exercise.number.c_str();
    const char* const title = exercise.title.c_str();
    if (message.empty()) std::printf("  %-5s %-50s holds\n", number, title);
    else std::printf("  %-5s %-50s does not hold yet\n        %s\n", number, title, message.c_str());
    std::fflush(stdout);
}

}  // namespace

Exercise::Exercise(const char* number, const char* title, void (*check)()) {
    exercises().push_back({number, title, check});
}

void expect_close(const std::string& what, double value, double expected, double tolerance, const std::string& hint) {
    expect(std::abs(value - expected) <= tolerance * std::max(1.0, std::abs(expected)), what, " is ", value,
           ", expected ", expected, hint.empty() ? "" : ": ", hint);
}

void expect_soon(const std::string& otherwise) {
    expect_each_within(5, otherwise);
}

Random& random_inputs() {
    static Random numbers(0);
    is_random = true;
    return numbers;
}

double order_of(const std::function<double(double)>& error, double h_0, int count) {
    double h = h_0, n = count, x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; ++i, h /= 2) {
        const double log_h = std::log(h), log_error = std::log(error(h));
        x += log_h;
        y += log_error;
        xx += log_h * log_h;
        xy += log_h * log_error;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

std::string path_of(const std::string& name) { return answers() + "/" + name + ".deck"; }

std::map<std::string, std::string> run_deck(const std::string& name, const std::vector<std::string>& keys) {
    const std::string folder = "outputs/lessons/answers/" + name;
    std::vector<std::string> arguments = {path_of(name), "output=" + folder, "vtk=none"};
    arguments.insert(arguments.end(), keys.begin(), keys.end());
    std::filesystem::remove_all(folder);
    const test::Outcome outcome = test::almesh_with(arguments);
    expect(std::filesystem::exists(folder + "/summary.txt"), "almesh ", path_of(name), " says: ", trim(outcome.error));
    return test::summary_of(folder);
}

double number(const std::map<std::string, std::string>& summary, const std::string& quantity) {
    return test::number(summary, quantity);
}

std::map<std::string, std::string> keys_of_deck(const std::string& name) {
    std::map<std::string, std::string> keys;
    for (std::string line : test::pieces(test::text_of(path_of(name)), '\n')) {
        line.resize(std::min(line.find('#'), line.size()));
        if (const auto equals = line.find('='); equals != std::string::npos)
            keys[std::string(trim(line.substr(0, equals)))] = std::string(trim(line.substr(equals + 1)));
    }
    return keys;
}

void expect_only(const std::string& name, const std::vector<std::string>& fixed, const std::vector<std::string>& free) {
    std::map<std::string, std::string> keys = keys_of_deck(name);
    for (const std::string& line : fixed) {
        const std::size_t equals = line.find(" = ");
        const std::string key = line.substr(0, equals), value = line.substr(equals + 3);
        expect(keys[key] == value, path_of(name), " has `", key, " = ", keys[key], "`, expected `", line,
               "`: only what the exercise asks for may change");
        keys.erase(key);
    }
    for (const auto& [key, value] : keys) {
        const bool may = key == "title" || key == "output" || std::find(free.begin(), free.end(), key) != free.end();
        expect(may, path_of(name), " has the line `", key, " = ", value, "`, which is not asked for");
    }
}

}  // namespace almesh::lessons

// check-NN FOLDER: checks the exercises of a lesson; FOLDER has the decks among their answers, check-NN.so beside the
// program the functions. Exit code 0 where all hold.
//
// check-NN FOLDER NUMBER FILE ANSWERS SECONDS MEMORY: one of them, with the functions in the shared object ANSWERS,
// which may use so many seconds of processor time and MB; FILE gets the message, or nothing where the answer holds. Only
// this program's exit code 0 says that it does.
int main(int count, char** argument) {
    using namespace almesh::lessons;
    if (count != 2 && count != 7) {
        std::fprintf(stderr, "usage: %s FOLDER-WITH-DECKS [NUMBER FILE ANSWERS SECONDS MEMORY]\n", argument[0]);
        return 2;
    }
    const bool one = count == 7;
    answers() = argument[1];
    std::size_t held = 0;
    for (const auto& exercise : exercises()) {
        if (one && exercise.number != argument[2]) continue;
        if (one) take_answers(argument[4], {std::atoi(argument[5]), std::atoi(argument[6])});
        else take_answers(std::string(argument[0]) + ".so", {});
        const std::string message = verdict(exercise);
        held += message.empty();
        if (one) std::ofstream(argument[3]) << message;
        else print(exercise, message);
    }
    if (one) return held == 1 ? 0 : 1;
    std::printf("%zu of %zu answers hold\n", held, exercises().size());
    return held == exercises().size() ? 0 : 1;
}
