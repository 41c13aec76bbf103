// For the page in which almesh runs in a browser: the nodes on the faces of a cell, in the order that the viewer draws.
#include <algorithm>
#include <vector>

#include "library/mesh_arrays.hpp"
#include "mesh/cells.hpp"

// type: of almesh_cell. Numbers of the faces of such a cell, which in 2D is its own only face: how many there are, then
// of each its corners, its nodes, and the places of these in the cell, row by row from the first corner to the second.
extern "C" const int* page_faces(int type, int degree) {
    using namespace almesh;
    static std::vector<int> numbers;
    const CellType& cell = type_of(static_cast<Cell>(type));
    const std::vector<MultiIndex> nodes = gmsh_node_order(cell, degree);
    std::vector<CellFace> faces(cell.faces.begin(), cell.faces.end());
    if (cell.dim == 2) faces = {{0, 1, 2, cell.vertices == 4 ? 3 : -1}};
    numbers = {static_cast<int>(faces.size())};
    for (const CellFace& face : faces) {
        const bool is_triangle = face[3] < 0;
        const MultiIndex &a = cell.corners[face[0]], &b = cell.corners[face[1]];
        const MultiIndex& c = cell.corners[face[is_triangle ? 2 : 3]];
        const std::size_t start = numbers.size();
        numbers.insert(numbers.end(), {is_triangle ? 3 : 4, 0});
        for (int v = 0; v <= degree; ++v)
            for (int u = 0; u <= (is_triangle ? degree - v : degree); ++u) {
                MultiIndex at;
                for (std::size_t k = 0; k < at.size(); ++k) at[k] = (degree - u - v) * a[k] + u * b[k] + v * c[k];
                numbers.push_back(static_cast<int>(std::find(nodes.begin(), nodes.end(), at) - nodes.begin()));
            }
        numbers[start + 1] = static_cast<int>(numbers.size() - start) - 2;
    }
    return numbers.data();
}
