// Quadrature on the reference simplices of dimension 1, 2 and 3 by the conical product of Gauss-Jacobi rules
// (Stroud, Approximate Calculation of Multiple Integrals, 1971, sec. 2.4): all weights positive, all points inside,
// any degree of exactness.
#pragma once
#include <vector>

namespace almesh {

struct Quadrature {
    int dim = 0, count = 0;
    std::vector<double> xi;      // count x dim reference coordinates
    std::vector<double> weight;  // sum: volume of the reference simplex, 1 / dim!
};

// Integrates polynomials of total degree <= exactness without error. Cost: ((exactness + 2) / 2)^dim points, one
// point (the centroid) for exactness 0 and 1.
Quadrature simplex_quadrature(int dim, int exactness);

}  // namespace almesh
