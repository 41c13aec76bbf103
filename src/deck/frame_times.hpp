// The times of a motion: the key `frames`, and the deck at one of them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace almesh {

struct Deck;

inline bool is_coupled(std::string_view frames) { return frames == "-"; }  // lines of standard input have the times
bool names_file(std::string_view frames);  // whether the value of the key is no list of times

// Of the text FROM : STEP : TO. what: which the messages begin with. Throws UsageError.
std::vector<double> numbers_of_range(const std::string& what, std::string_view text);

// Ascending. Throws UsageError with the line of the deck, or of the file of times.
std::vector<double> frame_times(const Deck& deck);

std::string frame_at(int number, double t);  // "frame 3, t = 0.04"

// The deck of one frame, its motions at the time t. number: from 1. files: those of the line of a coupled run, in the
// order of the deck's steps that take one. Throws UsageError with line, frame and time.
Deck deck_at(const Deck& deck, double t, int number, const std::vector<std::string>& files = {});

// The same before the first time of a coupled run: the boundaries that are prescribed are where the mesh has them.
Deck deck_at_rest(const Deck& deck);

int files_in_line(const Deck& deck);  // steps that take one

}  // namespace almesh
