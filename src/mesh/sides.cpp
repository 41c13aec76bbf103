#include "mesh/sides.hpp"

namespace almesh {

int side_number(const Mesh& mesh, int e, const int* vertex) {
    const int* const node = mesh.element(e);
    int opposite = -1;
    for (int v = 0; v <= mesh.dim; ++v) {
        if (std::find(vertex, vertex + mesh.dim, node[v]) != vertex + mesh.dim) continue;
        if (opposite >= 0) return -1;
        opposite = v;
    }
    return opposite;
}

}  // namespace almesh
