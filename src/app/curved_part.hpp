// Some elements of a mesh, curved as a problem of their own: their nodes that others have too are fixed.
#pragma once
#include <vector>

#include "app/problem.hpp"
#include "check/freed_nodes.hpp"

namespace almesh {

struct CurvedPart {
    Mesh mesh;  // in the run's frame; x: the straight-sided form
    // Nodes x dim: as in the file, as they are, and where the boundary is to go.
    std::vector<double> file, start, curved;
    std::vector<int> node, element, face;  // of the part -> of the whole; -1 for faces at the cut
    std::vector<char> on_cut;     // per node
};

// chosen: per element of the whole, at x now. curved: of the whole's boundary.
CurvedPart curved_part(const Problem& whole, const std::vector<char>& chosen, const std::vector<double>& x,
                       const std::vector<double>& curved);

// Faces and elements of the part that its boundary makes invalid by itself, with the positions `curved`. bound: as in
// find_faults().
TargetFaults find_faults(const CurvedPart& part, double bound);

std::vector<int> elements_of(const CurvedPart& part, const TargetFaults& faults);

// Per node of the part: whether it is on a boundary face of these elements, and not on the cut.
std::vector<char> freed_nodes(const CurvedPart& part, const std::vector<int>& elements);

// The same with the faces around them, see freed_nodes() of freed_nodes.hpp.
std::vector<char> freed_nodes_around(const CurvedPart& part, const TargetFaults& faults);

// Moves `curved` towards the straight-sided form until it makes no element invalid by itself.
void flatten(CurvedPart& part, double bound);

struct CurvedPartResult {
    std::vector<double> x;  // nodes x dim of the part
    AlResult al;
    // Valid only where it is injective too, and every node of the boundary in its place or on its surfaces.
    Certificate certificate;
};

// freed: nodes that slide along these surfaces of the whole; none, and null, for no node. It is given up where its
// boundary is not near its target after the first Newton steps, with a small penalty.
CurvedPartResult curve(const Deck& deck, const CurvedPart& part, const std::vector<char>& freed,
                       const SlidingSurfaces* surfaces, int first_steps);

}  // namespace almesh
