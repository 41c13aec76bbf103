// One frame after the other of a motion in time, on one problem.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "problem/options.hpp"
#include "problem/frame_state.hpp"
#include "report/frame_table.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"
#include "method/newton.hpp"

namespace almesh {

class FrameSolver {
public:
    explicit FrameSolver(Problem& problem) : problem_(problem) {}

    // The problem has the target of the time row.t. row.started_from: on return "beyond", the mesh
    // that the two before extrapolate to, "before", "ideal" or, where the run was one of its own, "anew", which has a
    // row.history.
    Solution solve(const ProblemOptions& options, const FramesBefore& before, FrameRow& row,
                   const AlObserver& observer = {});

    // Whether the motions of one frame lead to those of another: leads_to().
    bool leads(const ProblemOptions& options, const std::vector<Motion>& before, const std::vector<Motion>& now) const;

    // Whether every mesh (1 - s) from + s to, 0 <= s <= 1, is certified valid. Both are.
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
    Solution solve_anew(const ProblemOptions& options, FrameRow& row, const AlObserver& observer);
    bool is_polished(const ProblemOptions& options) const;
    void polish(const ProblemOptions& options, Solution& solution);
};

}  // namespace almesh
