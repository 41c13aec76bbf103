// `almesh linsolve A.mtx`: the linear solvers alone, on any symmetric matrix in Matrix Market format.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace almesh {

// arguments: A.mtx [b.mtx] [solver=cholesky|cg|gmres] [preconditioner=ilu0|ssor]
// [ordering=nested_dissection|minimum_degree|rcm|natural] [threads=N] [block=1|2|3]. The default ordering is
// nested_dissection for cholesky; for cg and gmres ILU(0) and SSOR order by domains. Without b.mtx,
// b = A (1, 1/2, 1/3, 1/4, 1/5, 1, ...). Prints sizes, times and the scaled residual to `out`. success: solved, else
// not_converged, with the reason printed. Throws UsageError and InputError.
ExitCode linsolve(const std::vector<std::string>& arguments, std::FILE* out);

}  // namespace almesh
