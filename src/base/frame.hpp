// The frame in which a run computes: x = (X - origin) / length of a position X in the mesh file. Its unit makes
// tolerances and iteration counts independent of that of the file, its origin keeps the digits of meshes far from the
// file's.
#pragma once
#include <cstddef>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

struct Frame {
    Vec<3> origin = {};
    double length = 1;

    Vec<3> to_file(const Vec<3>& x) const { return origin + length * x; }
    Vec<3> to_run(Vec<3> X) const {
        for (int a = 0; a < 3; ++a) X[a] = (X[a] - origin[a]) / length;
        return X;
    }

    // Coordinate number k of an array of points in dim dimensions.
    double to_file(double x, std::size_t k, int dim) const { return origin[k % dim] + length * x; }
    double to_run(double X, std::size_t k, int dim) const { return (X - origin[k % dim]) / length; }

    // Points x dim coordinates.
    std::vector<double> to_file(std::vector<double> x, int dim) const {
        for (std::size_t k = 0; k < x.size(); ++k) x[k] = to_file(x[k], k, dim);
        return x;
    }
    void take_to_run(std::vector<double>& X, int dim) const {
        for (std::size_t k = 0; k < X.size(); ++k) X[k] = to_run(X[k], k, dim);
    }
};

}  // namespace almesh
