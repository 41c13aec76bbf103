// How good the elements of a mesh are, and before and after: the scaled Jacobian (check/scaled_jacobian.hpp), the shape
// quality 1 / eta against the regular cell (check/quality.hpp), and the certified bound (check/certificate.hpp).
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct QualityMeasure {
    std::string title, column;   // of the table's row and in quality.csv
    std::vector<double> values;  // per element
};
using QualityChange = std::vector<QualityMeasure>;

// before, x: node_count x dim positions; before may be empty.
QualityChange quality_change(const Mesh& mesh, const std::vector<double>& before, const std::vector<double>& x);

// For the terminal: the least, the mean, and how many elements are below some values.
std::string quality_table(const Output& out, const QualityChange& change, int degree);

// quality.csv: a row for each range of values, the first of all that are not positive; a column for each measure before
// and after, numbers of elements.
std::string quality_csv(const QualityChange& change);

// Quality and certificates of the mesh; where `before` is the name of a file, the distances and changes from where that
// has the nodes, at `came` (else empty). folder: of invalid.csv, "" for none. Returns whether the mesh is certified.
bool print_quality(const Output& out, const Mesh& mesh, const std::string& before, const std::vector<double>& came,
                   const std::string& folder);

}  // namespace almesh
