// A curved mesh with as few elements straightened, by as little, as make it valid: it shows that a certified mesh
// exists, and where that cannot be the curved one.
//
// The nodes of an element at fault go a quarter of the way from their curved to their straight positions, then another,
// until all are there; nodes that elements share go as far as the one that asks most. The last step of all is the
// straight-sided mesh, so this ends.
#pragma once
#include <functional>
#include <vector>

#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// Elements at fault with the nodes at x.
using ElementsAtFault = std::function<std::vector<int>(const std::vector<double>& x)>;

struct Straightened {
    std::vector<double> x;           // nodes x dim, at which no elements are at fault but straight ones
    std::vector<char> was_at_fault;  // per element: whether it was, and was not straight anyway
};

// straight, curved: nodes x dim positions, equal at the vertices.
Straightened straightened(const Mesh& mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                          const ElementsAtFault& at_fault);

// As certify_injective() of injectivity.hpp, of a mesh whose curved form and whose straight one may each overlap itself
// where the other does not.
Injectivity certify_curved(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                           const std::vector<double>& x, const Certificate& certificate);

struct StraightenedMesh : Straightened {
    Certificate certificate;
    Injectivity injectivity;
};

// At fault are elements whose scaled Jacobian is not certified to be above the bound, and those that overlap. Cost: a
// few certificates.
StraightenedMesh straighten_invalid(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                                    double bound);

}  // namespace almesh
