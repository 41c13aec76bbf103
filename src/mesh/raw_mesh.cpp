#include "mesh/raw_mesh.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace almesh {

const RawEntity* find_entity(const RawMesh& mesh, int dim, int tag) {
    const auto before = [](const RawEntity& a, const std::pair<int, int>& b) { return std::pair(a.dim, a.tag) < b; };
    const auto it = std::lower_bound(mesh.entities.begin(), mesh.entities.end(), std::pair(dim, tag), before);
    return it != mesh.entities.end() && it->dim == dim && it->tag == tag ? &*it : nullptr;
}

void refuse(const RawMesh& raw, const std::string& message) { throw InputError(raw.path + ": " + message); }

void refuse(const RawMesh& raw, const RawElement& element, const std::string& message) {
    throw InputError(raw.path + ":" + std::to_string(element.line) + ": element " + std::to_string(element.id) + " " +
                     message);
}

std::string name_of(const RawElement& element) {
    return "element " + std::to_string(element.id) + " (line " + std::to_string(element.line) + ")";
}

}  // namespace almesh
