// The files of a run, in the units of the mesh file; what they hold stands in the README under "Results". All functions
// throw InputError where a file cannot be written.
#pragma once
#include <functional>
#include <vector>

#include "report/summary.hpp"
#include "check/boundary_distance.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "check/diagnosis.hpp"
#include "check/quality.hpp"
#include "method/augmented_lagrangian.hpp"

namespace almesh {

struct Deck;
struct Problem;
struct VtkArray;
enum class FinalFormat;

// Seconds of a run. Timings are of the iterations on the coarser meshes and on the deck's own; the others of what is
// outside the latter: together they are the run.
struct RunTimes : Timings {
    double setup = 0;    // mesh, target and its checks, functional, pattern and ordering of the matrix
    double coarse = 0;   // coarser meshes: part of Timings::total
    double certify = 0;  // certificate, largest distance from the target
    double write = 0;    // files of results, but for history.csv, summary.txt, expectations.csv
    double run = 0;      // the whole
};

// What a run has found, in the run's frame (Problem::frame).
struct Solution {
    std::vector<double> x;  // nodes x dim
    AlResult al;
    double max_boundary_error = 0;
    int nodes_off_target = 0;  // of the boundary, by whatever little
    int nodes_off_motion = 0;  // of those that the deck moves or fixes: not where its motions take them,
    double off_motion = 0;     // and the largest distance, in units of the file
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
    int freed_nodes = 0;            // that slide where the target folds the mesh,
    double largest_slide = 0;          // and the largest distance of one from its target, in units of the file
    double surface_distance = 0;       // of faces whose nodes slide, from their surface
    int straight_faces = 0;            // of a curved mesh that were made flat, or flatter than they came
    std::vector<MovedNode> moved_nodes;       // of boundaries, from the target before it was changed,
    std::vector<BoundaryDistance> distances;  // from the target before it was changed, in units of the file

    int newton_steps() const { return al.newton_iterations + al.earlier_newton_iterations + coarse_newton_iterations; }
};

// How a problem is solved.
using Solve = std::function<Solution(const Deck& deck, const Problem& problem)>;

// Of the nodes of the solution, in the file's frame; those at their targets have the target's bits, and where a mesh is
// curved in place those that are where the file has them the file's.
std::vector<double> final_positions(const Problem& problem, const std::vector<double>& solution);

void write_deck(const Deck& deck, const Problem& problem);     // deck.txt
void write_initial(const Deck& deck, const Problem& problem);  // initial.vtk

// iterate-0000.vtk, iterate-0001.vtk, ... (number: of the file) and iterates.vtk.series, the list of them, after every
// one, so that a long run can be watched.
void write_iterate(const Deck& deck, const Problem& problem, int number, const std::vector<double>& x);

// An animation for ParaView: names of files beside it, with their times.
void write_series(const std::string& path, const std::vector<std::pair<std::string, double>>& files);

void append_to_series(const std::string& path, const std::string& name, double time);  // which has one already

std::string frame_name(int number);  // frame-0001
// name.msh, .su2 or both, as the key `final` says, and name.vtk, with point_data. Returns the path of the first one.
std::string write_frame(const Deck& deck, const Problem& problem, const Solution& solution, const std::string& name,
                        const std::vector<VtkArray>& point_data);

// How the final mesh is written: final.msh, final.su2, or both.
std::vector<FileFormat> final_formats(FinalFormat wanted, const Mesh& mesh);

// The final mesh, final.vtk, boundary.vtk; moved-nodes.csv where there are any, stop.vtk where there is a diagnosis
void write_results(const Deck& deck, const Problem& problem, const Solution& solution);
void write_summary(const Deck& deck, const Summary& summary);  // summary.txt and expectations.csv

}  // namespace almesh
