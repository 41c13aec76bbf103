// Two curved triangles that no sample at their nodes finds fault with: one of them is inverted between its nodes. What
// is proved of every point of an element, and what of the mesh.
#include <cstdio>

#include "almesh.hpp"

namespace {

// Degree 2: six nodes for a triangle, vertices first, then the middles of its edges. The middle of the edge that both
// have is pulled along it by `pull`.
almesh::MeshArrays two_triangles(double pull) {
    almesh::MeshArrays mesh;
    mesh.degree = 2;
    mesh.x = {0, 0, 1, 0, 1, 1, 0, 1,                                          // the corners of a square
              0.5, 0, 1, 0.5, 0.5 + pull, 0.5 + pull, 0.5, 1, 0, 0.5};         // and middles
    mesh.elements = {{almesh::Cell::triangle, {0, 1, 2, 4, 5, 6, 0, 2, 3, 6, 7, 8}}};
    return mesh;
}

}  // namespace

int main() {
    bool as_expected = true;
    for (const double pull : {0.0, 0.2, 0.24, 0.26}) {
        const almesh::Verdict verdict = almesh::certify(two_triangles(pull));
        std::printf("pulled by %.2f: certified bounds %.3f and %.3f: %s%s\n", pull, verdict.certified_bound[0],
                    verdict.certified_bound[1], verdict.valid ? "valid" : "not valid, ", verdict.reason.c_str());
        as_expected = as_expected && verdict.valid == (pull < 0.25);
    }
    return as_expected ? 0 : 1;
}
