// Meshes from arrays and back, as almesh.hpp has them.
#pragma once
#include <vector>

#include "almesh.hpp"
#include "deck/make_problem.hpp"

namespace almesh {

inline constexpr const char* arrays_name = "mesh arrays";  // in place of a file's, in messages

Cell cell_of(const CellType& type);
const CellType& type_of(Cell cell);

void check_form(const MeshArrays& arrays);  // dimension and degree; throws UsageError

// Nodes and elements have their numbers in the arrays, plus one, as ids. Throws UsageError or InputError for arrays
// that do not fit together.
MeshSource source_of(const MeshArrays& arrays);

}  // namespace almesh
