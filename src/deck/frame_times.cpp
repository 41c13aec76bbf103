// frames = FROM : STEP : TO, a list, or a file of times.
#include "deck/frame_times.hpp"

#include <cmath>
#include <filesystem>

#include "deck/deck.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/table.hpp"

namespace almesh {
namespace {

constexpr int most_numbers = 1000000;

double number_of(const std::string& what, std::string_view text) {
    const auto value = parse_double(text);
    if (!value) throw UsageError(what, ": ", in_backquotes(text), " is not a number");
    return *value;
}

// Separated by commas, blanks or line ends.
void add_times(const std::string& where, std::string_view text, std::vector<double>& times) {
    for (const std::string_view piece : split(text, ','))
        for (const std::string_view word : words(piece)) {
            const double t = number_of(where + ": frames", word);
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
    return times;
} catch (const InputError& error) {
    throw UsageError(where, ": frames: ", error.what());
}

}  // namespace

std::vector<double> numbers_of_range(const std::string& what, std::string_view text) {
    const auto piece = split(text, ':');
    if (piece.size() != 3) throw UsageError(what, " = ", text, ": expected FROM : STEP : TO");
    const double from = number_of(what, piece[0]), step = number_of(what, piece[1]), to = number_of(what, piece[2]);
    if (!(step > 0)) throw UsageError(what, " = ", text, ": the step must be > 0");
    const double steps = std::floor((to - from) / step * (1 + 1e-12) + 1e-9);
    if (!(steps >= 0 && steps < most_numbers))
        throw UsageError(what, " = ", text, " are ", steps + 1, " numbers: expected 1 to ", most_numbers);
    constexpr int digits = 14;  // so that 35 steps of 0.01 are 0.35
    std::vector<double> numbers;
    for (int k = 0; k <= steps; ++k) numbers.push_back(*parse_double(to_text(from + k * step, digits)));
    return numbers;
}

std::string frame_at(int number, double t) { return concat("frame ", number, ", t = ", t); }

bool names_file(std::string_view frames) {
    return !frames.empty() && !is_coupled(frames) && frames.find_first_of(",:") == std::string_view::npos &&
           !parse_double(frames);
}

std::vector<double> frame_times(const Deck& deck) {
    const std::string& where = deck.given.at("frames");
    if (deck.frames.find(':') != std::string::npos) return numbers_of_range(where + ": frames", deck.frames);
    std::vector<double> times;
    if (names_file(deck.frames)) times = times_of_file(where, deck.frames);
    else add_times(where, deck.frames, times);
    if (times.empty()) throw UsageError(where, ": frames: no times in ", deck.frames);
    return times;
}

Deck deck_at(const Deck& deck, double t, int number, const std::vector<std::string>& files) {
    Deck now = deck;
    auto file = files.begin();
    for (BoundaryMotion& boundary : now.boundaries) {
        const std::string where = concat(boundary.where, ": boundary ", boundary.name, ", ", frame_at(number, t), ": ");
        try {
            boundary.motion = at_time(std::move(boundary.motion), t, number);
        } catch (const UsageError& error) {
            throw UsageError(where, error.what());
        }
        for (MotionStep& step : boundary.motion.steps) {
            if (step.file == file_of_line) step.file = *file++;
            if (std::error_code error; !step.file.empty() && !std::filesystem::exists(step.file, error))
                throw UsageError(where, "no such file: ", step.file);
        }
    }
    return now;
}

Deck deck_at_rest(const Deck& deck) {
    Deck rest = deck;
    for (BoundaryMotion& boundary : rest.boundaries) {
        std::vector<MotionStep>& steps = boundary.motion.steps;
        if (is_prescribed(kind_of(boundary.motion)) || steps.back().file == file_of_line)
            boundary.motion = motion_of(NodeKind::fixed);
        else steps.erase(steps.begin(), steps.end() - 1);
    }
    return rest;
}

int files_in_line(const Deck& deck) {
    int count = 0;
    for (const BoundaryMotion& boundary : deck.boundaries)
        for (const MotionStep& step : boundary.motion.steps) count += step.file == file_of_line;
    return count;
}

}  // namespace almesh
