// From the deck to the problem to be solved: the mesh, its target, and both in the run's unit of length.
#pragma once
#include <string>
#include <vector>

#include "constraint/target.hpp"
#include "app/deck.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct Problem {
    Mesh base;                  // as read and mended
    Mesh mesh;                  // read, mended, refined, raised; in units of `length`
    std::vector<double> ideal;  // straight-sided positions, in units of `length`
    BoundaryTarget target;      // in units of `length`
    double length = 1;          // of the mesh file, by which positions were divided
    std::string mesh_hash;      // FNV-1a of the file, to tell which mesh a result came from
    bool target_crosses = false;  // closed parts of the target boundary cross each other: no valid mesh reaches it
    std::vector<std::string> notes;
};

// Throws UsageError or InputError for everything that can be wrong before solving, target faces that are invalid
// themselves included.
Problem make_problem(const Deck& deck);

// Mesh and target of `fine` refined `times` times instead, in the same unit of length; the target is not checked again.
Problem coarser_problem(const Deck& deck, const Problem& fine, int times);

}  // namespace almesh
