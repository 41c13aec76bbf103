// How good the elements of a mesh are before and after: two measures, the scaled Jacobian (check/scaled_jacobian.hpp)
// and the shape quality 1 / eta against the regular cell (check/quality.hpp).
#pragma once
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct QualityMeasure {
    std::string title, column;   // of the table's row and in quality.csv
    std::vector<double> values;  // per element
};
using QualityChange = std::vector<QualityMeasure>;

// before, x: node_count x dim positions.
QualityChange quality_change(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& x);

// For the terminal: the least, the mean, and how many elements are below some values.
std::string quality_table(const QualityChange& change);

// quality.csv: a row for each range of values, the first of all that are not positive; a column for each measure before
// and after, numbers of elements.
std::string quality_csv(const QualityChange& change);

}  // namespace almesh
