// The kernels of a Newton step against the machine's limits: dense fronts, sparse Cholesky, matrix times vector,
// ILU(0), assembly. Matrices are those of the first Newton step of decks of inputs/.
#pragma once
#include "bench/machine.hpp"

namespace almesh::bench {

void measure_kernels(const Machine& machine, bool quick, Table& table);
// Assembly and certificate by type of cell.
void measure_cells(const Machine& machine, bool quick, Table& table);

}  // namespace almesh::bench
