#include "mesh/raw_mesh.hpp"

#include <algorithm>
#include <utility>

namespace almesh {

const RawEntity* find_entity(const RawMesh& mesh, int dim, int tag) {
    const auto before = [](const RawEntity& a, const std::pair<int, int>& b) { return std::pair(a.dim, a.tag) < b; };
    const auto it = std::lower_bound(mesh.entities.begin(), mesh.entities.end(), std::pair(dim, tag), before);
    return it != mesh.entities.end() && it->dim == dim && it->tag == tag ? &*it : nullptr;
}

}  // namespace almesh
