#include "io/msh_types.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "mesh/lagrange.hpp"

using namespace almesh;

TEST_CASE("types of complete simplices, there and back") {
    std::set<int> types;
    for (int dim = 1; dim <= 3; ++dim)
        for (int degree = 1; degree <= msh_max_degree; ++degree) {
            const SimplexType simplex = simplex_type(msh_type(dim, degree));
            CHECK(simplex.dim == dim);
            CHECK(simplex.degree == degree);
            CHECK(simplex.nodes == simplex_node_count(dim, degree));
            types.insert(msh_type(dim, degree));
        }
    CHECK(types.size() == 3 * msh_max_degree);
    CHECK(simplex_type(15).dim == 0);
    CHECK(simplex_type(15).nodes == 1);
}

TEST_CASE("other types are none, and have a name") {
    for (int type : {-1, 0, 3, 5, 20, 22, 24, 44, 64, 70, 73, 1000000}) CHECK(simplex_type(type).dim == -1);
    const auto name_begins = [](int type, const char* begin) {
        return std::string(foreign_type_name(type)).starts_with(begin);
    };
    for (int type : {3, 10, 16, 36, 47, 57}) CHECK(name_begins(type, "quadrangles"));
    for (int type : {5, 12, 17, 92, 99}) CHECK(name_begins(type, "hexahedra"));
    for (int type : {6, 13, 18, 90, 106}) CHECK(name_begins(type, "prisms"));
    for (int type : {7, 14, 19, 118}) CHECK(name_begins(type, "pyramids"));
    for (int type : {20, 22, 24, 52}) CHECK(name_begins(type, "incomplete triangles"));
    CHECK(name_begins(79, "incomplete tetrahedra"));
    for (int type : {44, 64, 73}) CHECK(name_begins(type, "simplices of a degree above 7"));
    CHECK(name_begins(999, "elements of an unknown kind"));
}
