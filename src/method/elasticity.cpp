// Linear elasticity, the displacement that of a solid,
//
//     integral of  2 m e(u) : e(v) + l div u div v = 0,   e(u) the symmetric gradient,
//     l = E v / ((1 + v) (1 - 2 v)),   m = E / (2 (1 + v)),   v = 0.3,
//
// whose modulus E is the reciprocal of the element's volume (of the Jacobian's determinant at a point of a curved one):
// the Jacobian-based stiffening with the exponent 1 of Stein, Tezduyar, Benney (J. Appl. Mech. 70, 2003), which leaves
// the determinant out of the integral over an element. Small elements then move almost as rigid bodies, and large ones
// take the deformation.
#include "method/comparators.hpp"

namespace almesh {

Stiffness elastic_stiffness(double jacobian) {
    constexpr double ratio = 0.3;  // v
    const double E = 1 / jacobian, l = E * ratio / ((1 + ratio) * (1 - 2 * ratio)), m = E / (2 * (1 + ratio));
    return {.a = m, .b = m, .c = l};
}

}  // namespace almesh
