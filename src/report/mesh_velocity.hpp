// How the mesh moves from frame to frame, for a solver on it: u = x - x_file, and its velocities at t_k by differences,
//
//     v_1 = (x_k - x_{k-1}) / (t_k - t_{k-1}),   v_2 = v_1 + r / (1 + r) (v_1 - v_1 of k - 1),
//
// r = (t_k - t_{k-1}) / (t_{k-1} - t_{k-2}): first order, and second order with steps of any length (BDF2). What faces
// sweep: check/swept_volumes.hpp. All are in units of the file.
#pragma once
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "check/swept_volumes.hpp"
#include "io/vtk.hpp"

namespace almesh {

struct Moment;
struct Problem;

// Displacement and velocities at the last moment, where the deck wants them. At the first moment the velocities are 0,
// and at the second v_2 is v_1.
std::vector<VtkArray> velocities(const Deck& deck, const Problem& problem, const std::vector<Moment>& moments);

// Of velocities(), as the deck wants it: BASE-velocity.csv, and where there is a moment before BASE-swept.csv. faces:
// of the mesh, which are found by the first call.
void write_velocities(const Deck& deck, const Problem& problem, const std::vector<Moment>& moments,
                      const std::vector<VtkArray>& columns, const std::string& base, std::vector<MeshFace>& faces);

}  // namespace almesh
