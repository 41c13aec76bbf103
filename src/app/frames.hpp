// A motion in time: one mesh for each of the times t that the key `frames` gives, whose motions are functions of t.
//
// Every mesh minimises the distortion relative to the same ideal mesh, so it depends on its time alone, whatever was
// before: nothing drifts. What is before serves as the start, the ideal mesh where that is as near to the target.
// Reading, ideal mesh, functional and the symbolic part of the linear solver are made once.
//
// Written after every frame: its mesh, frames.vtk.series, frames.csv, and the state from which a run goes on.
#pragma once
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"

namespace almesh {

struct Deck;

inline constexpr const char* frames_state = "frames.state";  // in the folder of results, until the run has ended

bool names_file(std::string_view frames);  // whether the value of the key is no list of times

// Ascending. Throws UsageError with the line of the deck, or of the file of times.
std::vector<double> frame_times(const Deck& deck);

// The deck of one frame, its motions at the time t. number: from 1. Throws UsageError with line, frame and time.
Deck deck_at(const Deck& deck, double t, int number);

// The exit code is that of the worst frame. Throws Error where a frame cannot begin, unless keep_going.
ExitCode run_frames(const Deck& deck, std::FILE* out);

}  // namespace almesh
