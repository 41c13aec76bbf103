// Targets that fold a face, or an element with several faces on the boundary: as CAD surfaces do where the nodes that
// are not vertices crowd. No mesh keeps such a target, but one whose nodes slide along the target's surface there may.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "check/determined_elements.hpp"
#include "check/target_check.hpp"
#include "constraint/target.hpp"

namespace almesh {

template <class Faults>
bool all_by_curvature(const Faults& faults) {
    return std::all_of(faults.begin(), faults.end(), [](const auto& fault) { return fault.by_curvature; });
}

struct ElementFault : DeterminedElement {
    bool sliding_may_help = false;  // by_curvature, or not between two faces, whose angle is that of the surface
    bool can_be_divided = false;    // by nodes on its inner_simplices()
};

struct TargetFaults {
    TargetReport faces;
    std::vector<ElementFault> elements;

    bool none() const { return faces.faults.empty() && elements.empty(); }
    bool sliding_may_help() const;  // all are of faces folded by their curvature alone, and of such elements
};

// ideal: node_count x dim positions. Of elements those whose scaled Jacobian the target makes at most `bound`
// somewhere: 0 where no valid mesh keeps it, a little more where none of any use does. Other cells than simplices that
// are as bad in the ideal mesh, or half as bad, are not among them. What the target leaves open, because it slides, is
// freed or free, is passed over.
TargetFaults find_faults(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                         double bound = 0);

// The first faults, a line each: what, where.
std::string describe(const Mesh& mesh, const TargetFaults& faults);

// Per node of the mesh, whether it is prescribed by the target and on a face that is folded, or at an element that is,
// or on a face next to these, or, where elements are folded by their curvature, in one plane with those; in degree 1 it
// is a vertex of such faces and elements.
std::vector<char> freed_nodes(const Mesh& mesh, const BoundaryTarget& target, const TargetFaults& faults);

}  // namespace almesh
