// From the run's unit of length (Problem::length) to that of the mesh file. The distortion eta has no unit, so that an
// energy is a volume; the product (1, 1) = |1|^2 of constraint/dirichlet.hpp has the unit length^(dim - 2).
#pragma once
#include <cmath>

namespace almesh {

struct Units {
    int dim;
    double length;  // of the run, in units of the mesh file

    double distance(double value) const { return value * length; }
    double squared_distance(double value) const { return value * length * length; }
    double energy(double value) const { return value * std::pow(length, dim); }
    double gradient(double value) const { return energy(value) / length; }            // of the energy
    double penalty(double value) const { return energy(value) / (length * length); }  // mu
    // At a point: lambda, and c = (phi - g_D) / |1|.
    double multiplier(double value) const { return value * std::pow(length, 0.5 * dim); }
    double constraint(double value) const { return value * std::pow(length, 2 - 0.5 * dim); }
};

}  // namespace almesh
