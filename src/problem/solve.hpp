// The problem solved, its result examined: the steps of a run.
#pragma once
#include <cstdio>
#include <functional>
#include <memory>

#include "method/continuation.hpp"
#include "problem/solution.hpp"

namespace almesh {

struct ProblemSetup;

// The mesh so far, from which a run can go on: kept by whoever starts the run (deck/so_far.hpp).
class MeshSoFar {
public:
    virtual ~MeshSoFar() = default;

    std::shared_ptr<Standing> standing = std::make_shared<Standing>();

    // x: an iterate on the level, which is that of the problem or a coarser one. Written when it is due.
    virtual void keep(const Level& level, const std::vector<double>& x) = 0;
    // Or the mesh where its increment or power began; but for the mesh that the run starts from anyway, and one that is
    // not certified valid.
    virtual void write(const Level& level, const std::vector<double>& x) = 0;
};

struct SolveObserver : AlObserver {
    StageObserver stage = {};
    std::function<void(Newton&, const std::vector<double>& start)> begins = {};
};

// Solves on coarser meshes, if `start` says so, sets the functional, and runs Algorithm 1. so_far: null for none.
// goes_on: the run is resumed from the problem's start.
Solution solve(const ProblemOptions& options, const Problem& problem, const SolveObserver& observer = {},
               MeshSoFar* so_far = nullptr, bool goes_on = false);

// The problem solved the way that it needs: curved in place (curving.hpp), improved (improve.hpp), or as by solve().
struct WholeObserver {
    // Of one of the solutions, of this problem or of one that is made of it; so_far: null where it is not kept.
    std::function<SolveObserver(const Problem& of, MeshSoFar* so_far)> solution;
    StageObserver part;  // of a mesh that is curved in place
};

// Where the problem has a standing, the run goes on from there. Notes go to `out`.
Solution solve_as_needed(const ProblemSetup& setup, Problem& problem, const WholeObserver& observer, MeshSoFar& so_far,
                         std::FILE* out);

// Moves the nodes inside volumes that follow a motion to their images under it; the constraint has moved those on their
// faces. All of them stay if an element would become invalid. x: a valid mesh, in the run's frame.
void place_inside_volumes(const Problem& problem, std::vector<double>& x);

// Sets the nodes of fixed boundaries to their targets, and with algorithm = adaptive all of what has converged.
void snap(const ProblemOptions& options, const Problem& problem, Solution& solution);

// Gives x, in the run's frame, the digits that it has in the file's.
void round_as_file(const Problem& problem, std::vector<double>& x);

// Certificates, distances, and the diagnosis of what went wrong.
void examine(const ProblemOptions& options, const Problem& problem, Solution& solution);

// Of a solution with its certificates; kind none where it converged and is certified, and where nothing held it up.
// Each status has its own kind (method/status.hpp).
Diagnosis diagnose(const ProblemOptions& options, const Problem& problem, const Solution& solution);

}  // namespace almesh
