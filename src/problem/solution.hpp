// The solution of a problem.
#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "base/error.hpp"
#include "check/boundary_distance.hpp"
#include "check/certificate.hpp"
#include "check/diagnosis.hpp"
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "method/augmented_lagrangian.hpp"

namespace almesh {

struct ProblemOptions;
struct Problem;

// Seconds of a run. Timings are for the iterations on the coarser meshes and on the deck's own; the others are
// for all but the latter: together they are the run.
struct RunTimes : Timings {
    double setup = 0;    // mesh, target and its checks, functional, pattern and ordering of the matrix
    double coarse = 0;   // coarser meshes: part of Timings::total
    double certify = 0;  // certificate, largest distance from the target
    double write = 0;    // files of results, but for history.csv, summary.txt, expectations.csv
    double run = 0;      // the whole
};

// From the run's unit of length (Problem::frame) to that of the mesh file. The distortion eta has no unit, so that an
// energy is a volume; the product (1, 1) = |1|^2 of constraint/dirichlet.hpp has the unit length^(dim - 2).
struct Units {
    int dim;
    double length;  // of the run, in units of the mesh file

    double distance(double value) const { return value * length; }
    double energy(double value) const { return value * std::pow(length, dim); }
    double gradient(double value) const { return energy(value) / length; }            // of the energy
    double penalty(double value) const { return energy(value) / (length * length); }  // mu
    // At a point: lambda, and c = (phi - g_D) / |1|.
    double multiplier(double value) const { return value * std::pow(length, 0.5 * dim); }
    double constraint(double value) const { return value * std::pow(length, 2 - 0.5 * dim); }
    AlIteration of(AlIteration row) const;
    NewtonStep of(NewtonStep step) const;
};

// What a run has found, in the run's frame (Problem::frame).
struct Solution {
    std::vector<double> x;  // nodes x dim
    AlResult al;
    double max_boundary_error = 0;
    int nodes_off_target = 0;  // boundary nodes, by any amount
    OffMotion off_motion;      // of the nodes that the deck moves or fixes, in units of the file
    Certificate certificate;
    Injectivity injectivity;
    SizeSkew size_skew;
    Diagnosis diagnosis;       // of an ending other than converged and certified
    double reached = 0;       // the largest part of the motion, less than all of it, that converged
    double refused_bytes = 0;  // of the Cholesky factor, where they ended the run
    RunTimes time;
    int coarse_newton_iterations = 0;  // on the coarser meshes
    double predicted_bytes = 0;  // of memory, before the run
    int refined_elements = 0;          // with a finer quadrature
    int freed_nodes = 0;               // that slide where the target folds the mesh
    double surface_distance = 0;       // of faces whose nodes slide, from their surface
    int straight_faces = 0;            // of a curved mesh that were made flat, or flatter than they came
    std::vector<BoundaryDistance> distances;  // from the target before it was changed, in units of the file

    int newton_steps() const { return al.newton_iterations + al.earlier_newton_iterations + coarse_newton_iterations; }
};

// Of a solution with its certificates.
inline ExitCode exit_code(const Solution& solution, bool as_expected) {
    if (solution.al.status != Status::converged) return ExitCode::not_converged;
    if (!solution.injectivity.certified) return ExitCode::not_certified;
    return as_expected ? ExitCode::success : ExitCode::expectation_failed;
}

// How a problem is solved.
using Solve = std::function<Solution(const ProblemOptions& options, const Problem& problem)>;

// Node positions of the solution in the file's frame. A node at its target gets the exact bits of the target, and a
// node that has not moved those of the file.
std::vector<double> final_positions(const Problem& problem, const std::vector<double>& solution);

}  // namespace almesh
