// The files of a run, in the units of the mesh file; what they hold stands in outputs/README.md. All functions
// throw InputError where a file cannot be written.
#pragma once
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "problem/solution.hpp"
#include "problem/summary.hpp"

namespace almesh {

struct Deck;
struct FileFormat;
struct Mesh;
struct Problem;
struct VtkArray;

void write_deck(const Deck& deck, const Problem& problem);     // deck.txt
void write_initial(const Deck& deck, const Problem& problem);  // initial.vtk

// iterate-0000.vtk, iterate-0001.vtk, ... (number: of the file) and iterates.vtk.series, the list of them, after every
// one, so that a long run can be watched.
void write_iterate(const Deck& deck, const Problem& problem, int number, const std::vector<double>& x);

// An animation for ParaView: names of files beside it, with their times.
void write_series(const std::string& path, const std::vector<std::pair<std::string, double>>& files);

void append_to_series(const std::string& path, const std::string& name, double time);  // which has one already

// text: of the mesh's file, which is written with other positions where the format is its own; else in MSH 2.2 or SU2.
void write_mesh_as(const FileFormat& format, const std::string& path, const Mesh& mesh, const std::string& text,
                   const std::vector<double>& positions);

std::string frame_name(int number);  // frame-0001
// name.msh, .su2 or both, as the key `final` says, and name.vtk, with point_data. Returns the path of the first one.
std::string write_frame(const Deck& deck, const Problem& problem, const Solution& solution, const std::string& name,
                        const std::vector<VtkArray>& point_data);

// The final mesh, final.vtk, boundary.vtk; moved-nodes.csv where there are any, stop.vtk where there is a diagnosis
void write_results(const Deck& deck, const Problem& problem, const Solution& solution);
void write_summary(const Deck& deck, const Summary& summary);  // summary.txt and expectations.csv

// How many elements the certificate could not prove valid, and the worst ten: id, centre, certified bound and, if
// it is known (check/infeasible.hpp), why. Prints nothing where all are certified. x: nodes x dim in
// units of the file.
void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, const Certificate& certificate,
                       const std::string& folder, const std::vector<std::string>& why = {});

}  // namespace almesh
