// The exercises of the course and what checks them: the same checks for a student's answers and for the solutions.
//
//     ANSWERS(accepted);
//
//     EXERCISE("4.1", "the Armijo condition") {
//         expect(accepted, "a step of length 1 is refused, although f falls by ", fall);
//     }
//
// ANSWERS names the functions that students write: each call of one runs in a child, which sends the result back
// (child.hpp). A callback runs there too, and counts in a Shared<int>; many calls in a loop are fewer children with
// in_child(). A check ends at the first expectation that does not hold; what it says is what the student reads, so it
// tells what came out, what was expected, and what that hints at.
#pragma once
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "lessons/child.hpp"

namespace almesh::lessons {

struct Unmet : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Also in what an answer calls: the judge hears of it whatever the answer catches.
template <class... Parts>
void expect(bool holds, const Parts&... parts) {
    if (!holds) refuse(concat(parts...));
}

// |value - expected| <= tolerance max(1, |expected|); not for nan. hint: what a wrong value shows, or "".
void expect_close(const std::string& what, double value, double expected, double tolerance,
                  const std::string& hint = "");

// Inputs that nobody can guess: others at each run, the same again with SEED=N in the environment. A message that says
// why an answer does not hold ends with the seed, where the exercise has asked for random numbers. These have four
// digits, so that they can be read, and typed.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return short_of(low + (high - low) * (engine_() / 4294967296.0)); }
    double scale(double low, double high) {  // low > 0
        return short_of(low * std::pow(high / low, engine_() / 4294967296.0));
    }
    int integer(int low, int high) { return low + static_cast<int>(engine_() % (high - low + 1u)); }    // both included
    template <class T>
    void shuffle(std::vector<T>& all) {
        for (int i = static_cast<int>(all.size()) - 1; i > 0; --i) std::swap(all[i], all[integer(0, i)]);
    }

private:
    static double short_of(double x) {
        const double digits = x == 0 ? 0 : 3 - std::floor(std::log10(std::abs(x)));  // behind the point
        const double power = std::pow(10, std::abs(digits));
        return digits > 0 ? std::round(x * power) / power : std::round(x / power) * power;
    }
    std::mt19937 engine_;
};
Random& random_inputs();

// What is said where a call of an answer takes more than five seconds of processor time, from here to the end of the
// exercise: why a loop of the student's does not end.
void expect_soon(const std::string& otherwise);

// The least-squares slope of log error over log h for h = h_0, h_0 / 2, ... (count of them): the order of accuracy.
double order_of(const std::function<double(double)>& error, double h_0, int count);

// inputs/lessons/NN-name/<exercises or solutions>/NAME.deck
std::string path_of(const std::string& name);

// Runs inputs/lessons/NN-name/<exercises or solutions>/NAME.deck, with keys as on the command line, into
// outputs/lessons/answers/NAME. Returns summary.txt; Unmet where the deck is refused.
std::map<std::string, std::string> run_deck(const std::string& name, const std::vector<std::string>& keys = {});
double number(const std::map<std::string, std::string>& summary, const std::string& quantity);

// The text of that deck without comments and blanks at the ends of lines: what the student set.
std::map<std::string, std::string> keys_of_deck(const std::string& name);

// Unmet where the deck has other lines than `fixed` ("key = value"), lines for the keys that `free` names, a title and
// an output.
void expect_only(const std::string& name, const std::vector<std::string>& fixed, const std::vector<std::string>& free);

struct Exercise {
    Exercise(const char* number, const char* title, void (*check)());
};

#define ALMESH_JOIN_(a, b) a##b
#define ALMESH_JOIN(a, b) ALMESH_JOIN_(a, b)
#define EXERCISE(number, title)                                                                                \
    static void ALMESH_JOIN(check_, __LINE__)();                                                               \
    static const ::almesh::lessons::Exercise ALMESH_JOIN(exercise_, __LINE__)(number, title,                   \
                                                                              ALMESH_JOIN(check_, __LINE__)); \
    static void ALMESH_JOIN(check_, __LINE__)()

}  // namespace almesh::lessons
