#include "io/msh_types.hpp"

#include <array>

#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr int numbers[4][msh_max_degree] = {{15, 15, 15, 15, 15, 15, 15},
                                            {1, 8, 26, 27, 28, 62, 63},
                                            {2, 9, 21, 23, 25, 42, 43},
                                            {4, 11, 29, 30, 31, 71, 72}};

struct ForeignRange {
    int first, last;
    const char* name;
};

constexpr const char* quadrangles = "quadrangles (mesh without Recombine)";
constexpr const char* hexahedra = "hexahedra (mesh without Recombine)";
constexpr const char* prisms = "prisms (mesh without Recombine)";
constexpr const char* pyramids = "pyramids (mesh without Recombine)";
constexpr const char* incomplete_triangles = "incomplete triangles (mesh with Mesh.SecondOrderIncomplete = 0)";
constexpr const char* incomplete_tetrahedra = "incomplete tetrahedra (mesh with Mesh.SecondOrderIncomplete = 0)";
constexpr const char* high_degrees = "simplices of a degree above 7 (mesh with a lower Mesh.ElementOrder)";
constexpr const char* constants = "elements of degree 0 (mesh with Mesh.ElementOrder = 1)";

constexpr ForeignRange foreign_ranges[] = {
    {3, 3, quadrangles},     {5, 5, hexahedra},     {6, 6, prisms},        {7, 7, pyramids},
    {10, 10, quadrangles},   {12, 12, hexahedra},   {13, 13, prisms},      {14, 14, pyramids},
    {16, 16, quadrangles},   {17, 17, hexahedra},   {18, 18, prisms},      {19, 19, pyramids},
    {36, 41, quadrangles},   {47, 51, quadrangles}, {57, 61, quadrangles}, {92, 105, hexahedra},
    {90, 91, prisms},        {106, 117, prisms},    {118, 132, pyramids},  {84, 89, constants},
    {44, 46, high_degrees},  {64, 66, high_degrees}, {73, 75, high_degrees},
    {20, 20, incomplete_triangles}, {22, 22, incomplete_triangles}, {24, 24, incomplete_triangles},
    {52, 56, incomplete_triangles}, {79, 83, incomplete_tetrahedra}};

}  // namespace

int msh_type(int dim, int degree) { return numbers[dim][degree - 1]; }

SimplexType simplex_type(int type) {
    static const auto table = [] {
        std::array<SimplexType, 73> known;
        known.fill(SimplexType());  // g++ 12 leaves dim 0 in some entries of a `known{}`
        for (int dim = 0; dim <= 3; ++dim)
            for (int degree = msh_max_degree; degree >= 1; --degree)
                known[numbers[dim][degree - 1]] = {dim, degree, dim ? simplex_node_count(dim, degree) : 1};
        return known;
    }();
    return type >= 0 && type < static_cast<int>(table.size()) ? table[type] : SimplexType();
}

const char* foreign_type_name(int type) {
    for (const ForeignRange& range : foreign_ranges)
        if (range.first <= type && type <= range.last) return range.name;
    return "elements of an unknown kind";
}

}  // namespace almesh
