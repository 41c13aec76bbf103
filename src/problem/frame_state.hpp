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

struct Moment {
    double t;
    std::vector<double> x;  // nodes x dim, in the run's frame
    std::vector<Motion> motions;
};

// The meshes of the frames before.
struct FramesBefore {
    std::vector<Moment> moments;  // at most three, the last one at the end

    // The last one before the time t, null: there is none. A frame that is asked for again has the one before its first
    // try.
    const Moment* before(double t) const;
    // One more; one of the same time as the last takes its place.
    void push(Moment moment);
};

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number);

// Without their motions. Returns the number of the last frame, 0 where there is no state. Throws UsageError where it is
// of another run.
int read_state(const Deck& deck, const Problem& problem, FramesBefore& before);

}  // namespace almesh
