#include "support/solids.hpp"

#include <cmath>

#include "mesh/build.hpp"

namespace almesh::test {
namespace {

struct Block {
    RawMesh raw;
    int k;

    int at(int i, int j, int l) const { return i + (k + 1) * (j + (k + 1) * l); }
    void add(const CellType& cell, int physical, const std::vector<int>& nodes) {
        raw.elements.push_back({static_cast<long long>(raw.elements.size()) + 1, raw.element_nodes.size(), 0, cell.dim,
                                1, physical, 0, &cell});
        raw.element_nodes.insert(raw.element_nodes.end(), nodes.begin(), nodes.end());
    }
    int centre_of(const std::vector<int>& vertices) {
        RawNode node{static_cast<long long>(raw.nodes.size()) + 1, {}, 0};
        for (const int v : vertices)
            for (int a = 0; a < 3; ++a) node.x[a] += raw.nodes[v].x[a] / static_cast<double>(vertices.size());
        raw.nodes.push_back(node);
        return static_cast<int>(raw.nodes.size()) - 1;
    }
    void add_cube(char letter, const std::vector<int>& v) {
        if (letter == 'h') add(hexahedron(), 4, v);
        if (letter == 'p') {
            add(prism(), 4, {v[0], v[1], v[2], v[4], v[5], v[6]});
            add(prism(), 4, {v[0], v[2], v[3], v[4], v[6], v[7]});
        }
        if (letter != 'd' && letter != 'u') return;
        const int c = centre_of(v);
        for (const CellFace& face : hexahedron().faces) {
            const int a = v[face[0]], b = v[face[1]], d = v[face[2]], e = v[face[3]];  // seen from outside
            const bool is_cut = &face == (letter == 'd' ? &hexahedron().faces.back() : &hexahedron().faces.front());
            if (!is_cut) add(pyramid(), 4, {a, e, d, b, c});
            else
                for (const auto& [s, t] : {std::array{b, d}, {d, e}}) add(simplex(3), 4, {a, t, s, c});
        }
    }
    void add_face(bool is_cut, int physical, const std::vector<int>& v) {
        if (!is_cut) return add(quadrilateral(), physical, v);
        add(simplex(2), physical, {v[0], v[1], v[2]});
        add(simplex(2), physical, {v[0], v[2], v[3]});
    }
};

}  // namespace

RawMesh solid_block(int k, const std::string& layers, double amplitude) {
    Block block;
    block.k = k;
    const int height = static_cast<int>(layers.size());
    block.raw.path = "block.msh";
    block.raw.groups = {{2, 1, "bottom"}, {2, 2, "top"}, {2, 3, "sides"}, {3, 4, "all"}};
    for (int l = 0; l <= height; ++l)
        for (int j = 0; j <= k; ++j)
            for (int i = 0; i <= k; ++i) {
                const bool is_inside = i > 0 && j > 0 && l > 0 && i < k && j < k && l < height;
                const double s = is_inside ? amplitude / k : 0, t = 3.0 * i + 5.0 * j + 7.0 * l;
                block.raw.nodes.push_back({static_cast<long long>(block.raw.nodes.size()) + 1,
                                           {1.0 * i / k + s * std::sin(t), 1.0 * j / k + s * std::cos(t),
                                            1.0 * l / k + s * std::sin(2 * t)},
                                           0});
            }
    for (int l = 0; l < height; ++l)
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < k; ++i) {
                std::vector<int> v;
                for (const int up : {0, 1})
                    for (const auto& [a, b] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 1}})
                        v.push_back(block.at(i + a, j + b, l + up));
                block.add_cube(layers[l], v);
                const auto side = [&](int f) {
                    const CellFace& face = hexahedron().faces[f];
                    return std::vector{v[face[0]], v[face[1]], v[face[2]], v[face[3]]};
                };
                const auto cut = [&](const std::string& letters) { return letters.find(layers[l]) != letters.npos; };
                if (l == 0) block.add_face(cut("pu"), 1, side(0));
                if (l == height - 1) block.add_face(cut("pd"), 2, side(5));
                if (j == 0) block.add_face(false, 3, side(1));
                if (i == 0) block.add_face(false, 3, side(2));
                if (i == k - 1) block.add_face(false, 3, side(3));
                if (j == k - 1) block.add_face(false, 3, side(4));
            }
    return block.raw;
}

Mesh solid_mesh(int k, const std::string& layers, double amplitude) {
    std::vector<std::string> notes;
    return build_mesh(solid_block(k, layers, amplitude), notes);
}

std::vector<Mesh> solid_meshes(double amplitude) {
    std::vector<Mesh> meshes;
    for (const char* const layers : {"hh", "pp", "hdpuh"}) meshes.push_back(solid_mesh(2, layers, amplitude));
    return meshes;
}

}  // namespace almesh::test
