// Elements that the target alone folds.
//
// The derivative of an element's map at a vertex depends on the nodes of the edges there, along an edge of a
// tetrahedron on those of the two faces that meet in it, and so on: on a face s of any dimension it depends on the
// nodes of the simplices spanned by s and one more vertex. Where all of these nodes are prescribed the determinant on s
// is what the target makes it, whatever the mesh inside. Such are elements with two faces on one smooth boundary,
// between which the angle becomes 180 degrees, and those across a gap that closes.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct DeterminedElement {
    int element;
    double scaled_jacobian;  // a value that it has somewhere, at most the bound: det J over |det J| of the straight
                             // element of its vertices in the target; 0 where that has no volume. At a corner of
                             // a cell that is no simplex over the lengths of the tangents
    bool by_curvature;       // the straight element is valid
};

// Elements whose scaled Jacobian is at most `bound` somewhere where it is determined, ascending in the element.
// target: node_count x dim, where the nodes that are prescribed go. Cost: O(elements), and for those with all vertices
// prescribed what check/certificate takes.
std::vector<DeterminedElement> determined_elements(const Mesh& mesh, const std::vector<double>& target,
                                                   const std::vector<char>& prescribed, double bound = 0);

}  // namespace almesh
