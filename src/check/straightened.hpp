// Straightens as few elements of a curved mesh, by as little, as make it valid. This shows that a certified mesh
// exists, and where it is not the curved one.
//
// The nodes of an element at fault move a quarter of the way from their curved to their straight positions, then
// another quarter, until no element is at fault; a shared node moves as far as the element that needs most. This ends
// with the straight-sided mesh at the latest.
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

// certify_injective() of injectivity.hpp relative to the curved and to the straight form of the mesh, since one of them
// may overlap itself where the other does not.
Injectivity certify_curved(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                           const std::vector<double>& x, const Certificate& certificate);

struct StraightenedMesh : Straightened {
    Certificate certificate;
    Injectivity injectivity;
};

// At fault are elements whose certified bound is not above this one, and those that overlap. Cost: a few
// certificates.
StraightenedMesh straighten_invalid(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                                    double bound);

}  // namespace almesh
