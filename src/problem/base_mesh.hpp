// The mesh of a file, and which mesh is the ideal one (key ideal).
#pragma once
#include <string>
#include <vector>

#include "base/error.hpp"
#include "check/infeasible.hpp"
#include "mesh/mesh.hpp"
#include "mesh/raw_mesh.hpp"
#include "problem/options.hpp"

namespace almesh {

struct BaseMesh {
    Mesh mesh;
    bool is_own_ideal = false;  // it is curved, and itself the ideal mesh
    std::string name = {};      // of its file, for errors
};

// Of a mesh with elements that are not valid, which are listed in what().
struct InvalidMesh : InputError {
    ElementList list;
    template <class... Parts>
    explicit InvalidMesh(ElementList found, const Parts&... parts)
        : InputError(parts..., found.first), list(std::move(found)) {}
};

// Throws InputError or InvalidMesh with the reasons against each mesh that could be the ideal one, and as build_mesh().
BaseMesh build_base_mesh(const RawMesh& raw, IdealKind ideal, std::vector<std::string>& notes);

// A mesh that is many times its size away from the origin of its file gets one of its own, in its middle; others keep
// it.
Vec<3> local_origin(const Mesh& mesh);

}  // namespace almesh
