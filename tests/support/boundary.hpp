// The nodes of a mesh's boundary faces.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh::test {

inline std::vector<char> on_boundary(const Mesh& mesh) {
    std::vector<char> on(mesh.nodes(), 0);
    for (const int node : mesh.faces) on[node] = 1;
    return on;
}

}  // namespace almesh::test
