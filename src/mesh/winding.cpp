#include "mesh/winding.hpp"

#include <algorithm>
#include <array>

#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

// The identity first; those of two vertices are the first two.
constexpr std::array<int, 3> windings[] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

bool is_identity(const std::vector<std::uint8_t>& winding) {
    return std::all_of(winding.begin(), winding.end(), [](std::uint8_t w) { return w == 0; });
}

}  // namespace

std::uint8_t winding(const int* here, const int* in_file, int count) {
    std::uint8_t w = 0;
    while (!std::equal(in_file, in_file + count, windings[w].begin(),
                       [here](int node, int k) { return node == here[k]; }))
        ++w;
    return w;
}

void set_winding(Mesh& mesh, const std::vector<int>& turned) {
    if (!turned.empty()) mesh.file.element_winding.assign(mesh.element_count(), 0);
    for (const int e : turned) mesh.file.element_winding[e] = 1;
    if (is_identity(mesh.file.face_winding)) mesh.file.face_winding.clear();
}

Mesh as_in_file(Mesh mesh) {
    if (mesh.file.element_winding.empty() && mesh.file.face_winding.empty()) return mesh;
    const Mesh here = mesh;
    const Subcells subcells(here);
    for (std::size_t f = 0; f < here.file.face_winding.size(); ++f) {
        std::array<int, 3> vertex{};
        const int* const face = here.face(static_cast<int>(f));
        for (int k = 0; k < here.dim; ++k) vertex[k] = face[windings[here.file.face_winding[f]][k]];
        const std::vector<int> nodes = subcells.nodes(here.face_element[f], vertex.data(), here.dim - 1);
        std::copy(nodes.begin(), nodes.end(), mesh.faces.begin() + static_cast<std::ptrdiff_t>(f * nodes.size()));
    }
    for (std::size_t e = 0; e < here.file.element_winding.size(); ++e) {
        if (here.file.element_winding[e] == 0) continue;
        std::array<int, 4> vertex{};
        std::copy_n(here.element(static_cast<int>(e)), here.dim + 1, vertex.begin());
        std::swap(vertex[here.dim - 1], vertex[here.dim]);
        const std::vector<int> nodes = subcells.nodes(static_cast<int>(e), vertex.data(), here.dim);
        std::copy(nodes.begin(), nodes.end(), mesh.elements.begin() + static_cast<std::ptrdiff_t>(e * nodes.size()));
    }
    return mesh;
}

}  // namespace almesh
