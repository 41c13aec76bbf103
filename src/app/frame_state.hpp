// What a motion in time goes on from, in the folder of results until the run has ended: the number of the last frame
// and the meshes that the next one may start from, to the last bit.
#pragma once
#include <string>
#include <vector>

#include "constraint/motion.hpp"

namespace almesh {

struct Deck;
struct Problem;

inline constexpr const char* frames_state = "frames.state";

// The meshes of the frames before.
struct FramesBefore {
    std::vector<double> x, earlier;  // in the run's frame; of the last one and of the one before that; empty: none
    double t = 0, earlier_t = 0;
    std::vector<Motion> motions;     // of the last one

    // One more; one of the same time as the last takes its place.
    void push(const std::vector<double>& mesh, double time, const std::vector<Motion>& of_mesh);
};

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number);

// Without the motions. Returns the number of the last frame, 0 where there is no state. Throws UsageError where it is
// of another run.
int read_state(const Deck& deck, const Problem& problem, FramesBefore& before);

}  // namespace almesh
