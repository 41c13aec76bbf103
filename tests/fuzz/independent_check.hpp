// A second opinion on meshes, with nothing of the program's certificates: determinants at many points, elements in each
// other by Newton's method, distances to where the boundary should be. In long double.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh::fuzz {

using Point = std::array<long double, 3>;

// The elements of the highest dimension in a file, and which of their sides are on the boundary.
class Elements {
public:
    explicit Elements(const RawMesh& raw);

    int dim = 0, degree = 0;
    std::vector<std::vector<Point>> x;        // of the nodes of each element, in Gmsh's order
    std::vector<std::vector<int>> node;       // the same as indices into raw.nodes
    struct Side {
        std::vector<int> node;  // all of the side's file element, or its vertices where it has none
        std::string boundary;   // name of its physical group; "" without one
    };
    std::vector<Side> sides;    // of one element only
};

// What is wrong with the elements: "" where at every point of a fine lattice in each of them det J has the right sign,
// and none of a few points inside each is in another one. either_winding: an element may be negatively oriented as a
// whole.
std::string fault_of(const Elements& elements, bool either_winding);

// Distance of y from the point, segment or triangle with these corners.
long double distance(const Point& y, const std::vector<Point>& corners);

}  // namespace almesh::fuzz
