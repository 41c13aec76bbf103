// Quadrature on the reference simplices of dimension 1, 2 and 3: all weights positive, all points inside, any degree of
// exactness. On triangles and tetrahedra the symmetric rules of quadrature_table.hpp as far as they go; beyond them,
// and on lines, the conical product of Gauss-Jacobi rules (Stroud, Approximate Calculation of Multiple Integrals, 1971,
// sec. 2.4), which takes about twice the points in 2D, three times in 3D.
#pragma once
#include <vector>

namespace almesh {

struct Quadrature {
    int dim = 0, count = 0;
    std::vector<double> xi;      // count x dim reference coordinates
    std::vector<double> weight;  // sum: volume of the reference simplex, 1 / dim!
};

// Integrates polynomials of total degree <= exactness without error. One point, the centroid, for exactness 0 and 1;
// ((exactness + 2) / 2)^dim points where the conical product is used.
Quadrature simplex_quadrature(int dim, int exactness);

}  // namespace almesh
