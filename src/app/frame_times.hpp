// The times of a motion: the key `frames`, and the deck at one of them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace almesh {

struct Deck;

bool names_file(std::string_view frames);  // whether the value of the key is no list of times

// Ascending. Throws UsageError with the line of the deck, or of the file of times.
std::vector<double> frame_times(const Deck& deck);

std::string frame_at(int number, double t);  // "frame 3, t = 0.04"

// The deck of one frame, its motions at the time t. number: from 1. Throws UsageError with line, frame and time.
Deck deck_at(const Deck& deck, double t, int number);

}  // namespace almesh
