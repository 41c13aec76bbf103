// Shape quality of the elements of a mesh, 1 / eta with eta the distortion (paper, Eq. 1) of the map from the regular
// cell of its type, whose edges are all of the same length: 1 for a regular element, 0 for a degenerate or inverted one.
//
// Cost: one Jacobian per element and quadrature point.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace almesh {

struct Mesh;

struct QualityStatistics {
    std::vector<double> quality;     // per element: least 1 / eta at its quadrature points, 0 where inverted
    double min;                      // over the elements
    std::array<int, 10> histogram;   // elements with quality in [k / 10, (k + 1) / 10), 1 in the last
    double min_edge, max_edge;       // straight distances between vertices
};

// x: node_count x dim positions.
QualityStatistics mesh_quality(const Mesh& mesh, const std::vector<double>& x);

// Over the elements: the least value in an element of the size-skew metric f = sqrt(min(t, 1/t)) f_skew of de Boer, van
// der Schoot and Bijl (Computers & Structures 85, 2007) after Knupp (Finite Elem. Anal. Des. 39, 2003); t is det J over
// that of the ideal element. Simplices have no skew apart from their shape: f_skew is the quality above.
struct SizeSkew {
    double mean, min;  // 0 for an inverted element
};

// ideal, x: node_count x dim positions.
SizeSkew size_skew(const Mesh& mesh, const std::vector<double>& ideal, const std::vector<double>& x);

// Table of the ten bins: range, number of elements, bar. One line each.
std::string histogram_text(const QualityStatistics& statistics);

}  // namespace almesh
