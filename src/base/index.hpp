// Where entries of flat arrays stand. Counts and numbers are int; their products need not fit one.
#pragma once
#include <cstddef>
#include <vector>

namespace almesh {

// Entry (row, column) of an array of rows of `width` entries.
constexpr std::size_t offset(std::size_t row, int width, int column = 0) { return row * width + column; }

// The dim coordinates of point i of x (points x dim).
inline double* point(std::vector<double>& x, int i, int dim) { return x.data() + offset(i, dim); }
inline const double* point(const std::vector<double>& x, int i, int dim) { return x.data() + offset(i, dim); }

}  // namespace almesh
