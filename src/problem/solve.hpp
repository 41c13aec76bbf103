// The problem solved, its result examined: the steps of a run.
#pragma once
#include "method/continuation.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {

class MeshSoFar;

struct SolveObserver : AlObserver {
    StageObserver stage = {};
    std::function<void(Newton&, const std::vector<double>& start)> begins = {};
};

// The solution on coarser meshes, if `start` says so, the functional, and Algorithm 1. so_far: null for none.
// goes_on: the problem's start is where its run stood.
Solution solve(const ProblemOptions& options, const Problem& problem, const SolveObserver& observer = {},
               MeshSoFar* so_far = nullptr, bool goes_on = false);

// Sets the nodes inside elements of volumes that follow a motion to where it takes them, like those on their sides,
// which the constraint has brought there; they stay where an element would not be valid. x: a valid mesh, in the run's
// frame.
void place_inside_volumes(const Problem& problem, std::vector<double>& x);

// Sets the nodes of fixed boundaries to their targets, and with algorithm = adaptive all of what has converged.
void snap(const ProblemOptions& options, const Problem& problem, Solution& solution);

// Gives x, in the run's frame, the digits that it has in the file's.
void round_as_file(const Problem& problem, std::vector<double>& x);

// Certificates, distances, and the diagnosis of what went wrong.
void examine(const ProblemOptions& options, const Problem& problem, Solution& solution);

// Of a solution with its certificates; kind none where it converged and is certified, and where nothing held it up.
// Each status has its own kind (method/status.cpp).
Diagnosis diagnose(const ProblemOptions& options, const Problem& problem, const Solution& solution);

}  // namespace almesh
