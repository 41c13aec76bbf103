// Whole runs: where each deck spends its time, what a second thread gives, and how time and memory grow with the mesh.
#pragma once
#include "bench/machine.hpp"

namespace almesh::bench {

void measure_decks(const Machine& machine, bool quick, Table& table);

// A frame of a motion that goes on.
void measure_frames(const Machine& machine, bool quick, Table& table);

// The circle of section 4.1 refined 0, 1, 2, ... times, beside the paper's Table 1; the aircraft refined, and of degree
// 1, 2, ...
void measure_scaling(bool quick, Table& table);

}  // namespace almesh::bench
