// Gmsh's numbers of element types (GmshDefines.h): the complete simplices that are read and written, and the names of
// the others for messages.
#pragma once

namespace almesh {

inline constexpr int msh_max_degree = 7;

struct SimplexType {
    int dim = -1;    // 0 to 3; -1: not a complete simplex of a degree up to msh_max_degree
    int degree = 0;  // a point has degree 1
    int nodes = 0;
};

int msh_type(int dim, int degree);  // dim in [0, 3], degree in [1, msh_max_degree]
SimplexType simplex_type(int type);

// Plural name, and what to do about it, of an element type that is not read.
const char* foreign_type_name(int type);

}  // namespace almesh
