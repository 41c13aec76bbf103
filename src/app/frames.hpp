// A motion in time: one mesh for each of the times t that the key `frames` gives, whose motions are functions of t.
//
// Every mesh minimises the distortion relative to the same ideal mesh, so it depends on its time alone, whatever was
// before: nothing drifts. What is before serves as the start, the ideal mesh where that is as near to the target.
// Reading, ideal mesh, functional and the symbolic part of the linear solver are made once.
//
// Written after every frame: its mesh, frames.vtk.series, frames.csv, and the state from which a run goes on.
#pragma once
#include <cstdio>

#include "base/error.hpp"

namespace almesh {

struct Deck;

// The exit code is that of the worst frame. Throws Error where a frame cannot begin, unless keep_going.
ExitCode run_frames(const Deck& deck, std::FILE* out);

}  // namespace almesh
