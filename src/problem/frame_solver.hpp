// One frame after the other of a motion in time, on one problem.
#pragma once
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "problem/options.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"
#include "method/newton.hpp"

namespace almesh {

struct SolveObserver;

// The meshes from which the next frame may start.
struct Moment {
    double t;
    std::vector<double> x;  // nodes x dim, in the run's frame
    std::vector<Motion> motions;
};

struct FramesBefore {
    std::vector<Moment> moments;  // at most three, the last one at the end

    // The last one before the time t, null: there is none. A frame that is asked for again has the one before its first
    // try.
    const Moment* before(double t) const {
        const auto found = std::find_if(moments.rbegin(), moments.rend(), [t](const Moment& of) { return of.t < t; });
        return found == moments.rend() ? nullptr : &*found;
    }
    // One more; one of the same time as the last takes its place.
    void push(Moment moment) {
        if (!moments.empty() && moments.back().t == moment.t) moments.pop_back();
        if (moments.size() == 3) moments.erase(moments.begin());
        moments.push_back(std::move(moment));
    }
};

class FrameSolver {
public:
    explicit FrameSolver(Problem& problem) : problem_(problem) {}

    // The problem has the target of the time t. started_from: on return "beyond", the mesh that the two before
    // extrapolate to, "before", "ideal" or, where the run was one of its own, which `anew` observes, "anew".
    Solution solve(const ProblemOptions& options, const FramesBefore& before, double t, std::string& started_from,
                   const SolveObserver& anew, const AlObserver& observer = {});

    // Whether the motions of one frame lead to those of another: leads_to().
    bool leads(const ProblemOptions& options, const std::vector<Motion>& before, const std::vector<Motion>& now) const;

    // Whether every mesh (1 - s) from + s to, 0 <= s <= 1, is certified valid, as both ends are.
    bool is_valid_between(const std::vector<double>& from, const std::vector<double>& to) const;

private:
    Problem& problem_;
    std::unique_ptr<Newton> newton_;

    Newton& newton(const ProblemOptions& options);
    void prepare(const ProblemOptions& options);
    std::string start(const ProblemOptions& options, double t, const FramesBefore& before,
                      std::vector<double>& x) const;
    Solution predict(const ProblemOptions& options, const std::vector<double>& x, HessianKind kind);
    Solution solve_from(const ProblemOptions& options, const std::vector<double>& x, const AlObserver& observer);
    Solution solve_anew(const ProblemOptions& options, const SolveObserver& anew, const AlObserver& observer);
    bool is_polished(const ProblemOptions& options) const;
    void polish(const ProblemOptions& options, Solution& solution);
};

}  // namespace almesh
