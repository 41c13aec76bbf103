// One frame after the other of a motion in time, on one problem.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "app/deck.hpp"
#include "app/problem.hpp"
#include "app/results.hpp"
#include "method/newton.hpp"

namespace almesh {

// The mesh of an earlier frame.
struct FrameBefore {
    std::vector<double> x;  // in the run's frame; empty: there is none
    std::vector<Motion> motions;
};

class FrameSolver {
public:
    explicit FrameSolver(Problem& problem) : problem_(problem) {}

    // The problem has the target of `deck`, which is of one time. started_from: on return "before", "ideal" or, where
    // the run was one of its own, "anew".
    Solution solve(const Deck& deck, const FrameBefore& before, std::string& started_from);

private:
    Problem& problem_;
    std::unique_ptr<Newton> newton_;
    NewtonMemory fresh_;  // of one that has made no step: a frame does not depend on those before it

    Newton& newton(const Deck& deck);
    void prepare(const Deck& deck);
    const std::vector<double>* start(const Deck& deck, const FrameBefore& before, std::string& started_from);
    Solution solve_from(const Deck& deck, const std::vector<double>& x);
    Solution solve_anew(const Deck& deck);
    bool settles(const Deck& deck) const;
    void settle(const Deck& deck, Solution& solution);
};

}  // namespace almesh
