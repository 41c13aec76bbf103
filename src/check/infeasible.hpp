// Faces and elements that the prescribed boundary makes invalid, wherever the other nodes are.
//
// A face is infeasible where the target folds it, mirrors its part of the boundary or takes it through another
// (target_check.hpp). In an element, the derivative at a vertex depends on the nodes of the edges there, along an edge
// of a tetrahedron on those of the two faces that meet in it, and so on: on a face s of any dimension it depends on the
// nodes of the simplices spanned by s and one more vertex. If all of these nodes are fixed, they determine the
// determinant on s, whatever the mesh inside. Infeasible are elements with two faces on one smooth boundary whose angle
// becomes 180 degrees, elements across a gap that closes, and flat ones whose nodes slide in one plane. The curvature
// of a CAD surface makes elements infeasible if the nodes that are not vertices crowd: sliding along the surface may
// help these elements, a node inside the element may help others.
#pragma once
#include <string>
#include <vector>

#include "check/target_check.hpp"

namespace almesh {

struct BoundaryTarget;
class Constraint;
struct Mesh;
class SlidingSurfaces;

constexpr double flat_jacobian = 1e-12;  // a scaled determinant that may be zero

struct InfeasibleElement {
    int element;
    double scaled_determinant;  // a value that it has somewhere, at most the bound: det J over |det J| of the straight
                                // element of its vertices; 0 where that has no volume. At a corner of a cell that is
                                // no simplex over the lengths of the tangents
    bool by_curvature;          // the straight element is valid
    bool sliding_may_help = false;  // by_curvature, or not between two faces, whose angle is that of the surface
    bool division_helps = false;    // by nodes on its inner_simplices()
};

// Elements, ascending, whose scaled determinant is at most `bound` at a point where the held nodes determine it; the
// flags of what may help are not set. x: node_count x dim. held: per node. Cost: O(elements), and for those all of
// whose vertices are held what check/certificate takes.
std::vector<InfeasibleElement> infeasible_elements(const Mesh& mesh, const std::vector<double>& x,
                                                   const std::vector<char>& held, double bound = 0);

struct Infeasible {
    TargetReport faces;
    std::vector<InfeasibleElement> elements;

    bool none() const { return faces.faults.empty() && elements.empty(); }
    bool faces_by_curvature() const;
    bool sliding_may_help() const;  // all are of faces folded by their curvature alone, and of such elements
    bool division_helps() const;    // in all elements
};

// The faces that the target makes invalid, and the elements whose scaled determinant it makes at most `bound`: with 0
// no valid mesh reaches the target, with a little more no useful one does. Cells other than simplices that are below
// the bound in the ideal mesh already, and keep half of their value, are left out. Faces whose positions the target
// leaves open, because they slide or are free, are passed over. ideal: node_count x dim.
Infeasible find_infeasible(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                           double bound = 0);

// Per element the reason why it is infeasible with the boundary at x, "" if it may be valid. x: node_count x dim; if
// the constraint does not hold at x, the boundary is tested at x and at the target. sliding: null if no node slides.
std::vector<std::string> why_infeasible(const Mesh& mesh, const std::vector<double>& x, Constraint& constraint,
                                        const BoundaryTarget& target, const SlidingSurfaces* sliding);

// The first of them, a line each: what, where.
std::string describe(const Mesh& mesh, const Infeasible& infeasible);

// The elements at faces that are at fault or cross others, then those that are infeasible themselves.
std::vector<int> elements_of(const Mesh& mesh, const Infeasible& infeasible);

// Per node of the mesh: whether the target prescribes it and it is on a face with a vertex of an infeasible face or
// element or, if all elements are infeasible by curvature, on a face in one plane with these; in degree 1 it must
// itself be a vertex of an infeasible face or element.
std::vector<char> nodes_to_free(const Mesh& mesh, const BoundaryTarget& target, const Infeasible& infeasible);

// Elements for a user, mostly those that are not valid.
struct ElementList {
    int count = 0;
    std::string csv, first;  // all, for invalid.csv; the first ten, a line each below " (id, centre, NAME):"
};

// elements: in the order in which they are listed. x: node_count x dim in units of the file. value: per element. more:
// what follows it, as of why_infeasible(); or empty.
ElementList list_elements(const Mesh& mesh, const std::vector<int>& elements, const std::vector<double>& x,
                          const std::vector<double>& value, const std::vector<std::string>& more = {},
                          std::string name = "certified bound");

}  // namespace almesh
