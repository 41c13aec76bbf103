// Boundary targets of meshes built in code, and loops over numbers of threads.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/parallel.hpp"
#include "constraint/target.hpp"

namespace almesh::test {

// motions: boundary name -> text of its motion; boundaries not named are fixed.
inline BoundaryTarget target_of(const Mesh& mesh, const std::map<std::string, std::string>& motions) {
    std::vector<Motion> motion;
    for (const std::string& name : mesh.boundaries)
        motion.push_back(parse_motion(motions.contains(name) ? motions.at(name) : "fixed"));
    return make_target(mesh, motion);
}

inline void set_kind(const Mesh& mesh, const std::string& boundary, NodeKind kind, BoundaryTarget& target) {
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (mesh.boundaries[mesh.face_boundary[f]] == boundary) target.kind[k] = target.written_kind[k] = kind;
    });
}

// Per boundary.
inline std::vector<char> slides(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<char> slides;
    for (const NodeKind kind : kinds_of_boundaries(mesh, target.kind)) slides.push_back(kind == NodeKind::slides);
    return slides;
}

// result() for 1, 2 and 3 threads.
template <class Result>
auto for_threads(const Result& result) {
    const int before = max_threads();
    std::vector<decltype(result())> results;
    for (int threads : {1, 2, 3}) {
        set_threads(threads);
        results.push_back(result());
    }
    set_threads(before);
    return results;
}

}  // namespace almesh::test
