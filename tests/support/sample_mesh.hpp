// Raw meshes for tests: the unit square or cube, cut into n^dim boxes of 2 triangles or 6 tetrahedra (Kuhn), of any
// degree, with the boundary x = 0 tagged 1 ("left"), the rest 2 (no name), the inside 9 ("inside").
#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

using LatticePoint = std::array<int, 3>;  // coordinates times n * degree

class SampleMesh {
public:
    SampleMesh(int dim, int degree, int n, bool turn_every_other = false) : dim_(dim), degree_(degree), n_(n) {
        raw.path = "sample.msh";
        raw.groups = {{dim - 1, 1, "left"}, {dim, 9, "inside"}};
        std::vector<std::vector<LatticePoint>> elements;
        const int boxes = dim == 2 ? n * n : n * n * n;
        for (int box = 0; box < boxes; ++box) append_box({box % n, box / n % n, box / n / n}, elements);
        for (const auto& vertices : elements) append_faces(vertices);
        for (std::size_t e = 0; e < elements.size(); ++e) {
            if (turn_every_other && e % 2) std::swap(elements[e][0], elements[e][1]);
            append(dim_, elements[e], 9);
        }
    }

    RawMesh raw;

private:
    int dim_, degree_, n_;
    std::map<LatticePoint, int> node_;

    void append_box(const LatticePoint& corner, std::vector<std::vector<LatticePoint>>& elements) const {
        std::array<int, 3> axis = {0, 1, 2};
        do {
            std::vector<LatticePoint> vertices = {corner};
            for (int k = 0; k < dim_; ++k) {
                vertices.push_back(vertices.back());
                ++vertices.back()[axis[k]];
            }
            const bool odd = (axis[0] > axis[1]) ^ (axis[0] > axis[2]) ^ (axis[1] > axis[2]);
            if (odd) std::swap(vertices[dim_ - 1], vertices[dim_]);
            elements.push_back(vertices);
        } while (std::next_permutation(axis.begin(), axis.begin() + dim_));
    }

    void append_faces(const std::vector<LatticePoint>& vertices) {
        for (int opposite = 0; opposite <= dim_; ++opposite) {
            std::vector<LatticePoint> face = vertices;
            face.erase(face.begin() + opposite);
            for (int a = 0; a < dim_; ++a)
                for (int side : {0, n_})
                    if (std::all_of(face.begin(), face.end(), [&](const LatticePoint& p) { return p[a] == side; }))
                        append(dim_ - 1, face, a == 0 && side == 0 ? 1 : 2);
        }
    }

    int node(const LatticePoint& p) {
        const auto [it, is_new] = node_.try_emplace(p, static_cast<int>(raw.nodes.size()));
        const double h = 1.0 / (n_ * degree_);
        if (is_new) raw.nodes.push_back({10 + 3 * it->second, {p[0] * h, p[1] * h, p[2] * h}, 100 + it->second});
        return it->second;
    }

    void append(int dim, const std::vector<LatticePoint>& vertices, int tag) {
        const int count = static_cast<int>(raw.elements.size());
        raw.elements.push_back({count + 1, raw.element_nodes.size(), 1000 + count, dim, degree_, tag, 20 + tag});
        for (const MultiIndex& a : gmsh_node_order(dim, degree_)) {
            LatticePoint p{};
            for (int v = 0; v <= dim; ++v)
                for (int k = 0; k < 3; ++k) p[k] += a[v] * vertices[v][k];
            raw.element_nodes.push_back(node(p));
        }
    }
};

// Appends an element; node: indices into raw.nodes.
inline void append_element(RawMesh& raw, int dim, int tag, const std::vector<int>& node) {
    const int count = static_cast<int>(raw.elements.size());
    raw.elements.push_back({count + 1, raw.element_nodes.size(), 1000 + count, dim, 1, tag, 0});
    raw.element_nodes.insert(raw.element_nodes.end(), node.begin(), node.end());
}

}  // namespace almesh
