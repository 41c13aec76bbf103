// A mesh of the ring between two circles about the origin, in triangles: what the examples move.
#pragma once
#include <cmath>
#include <numbers>

#include "almesh.hpp"

namespace examples {

// around: nodes on a circle, layers: of quadrilaterals between the circles, each cut into two triangles.
inline almesh::MeshArrays ring(double inner, double outer, int around, int layers) {
    almesh::MeshArrays mesh;
    mesh.elements = {{almesh::Cell::triangle, {}}};
    mesh.faces = {{"inner", {almesh::Cell::line, {}}}, {"outer", {almesh::Cell::line, {}}}};
    for (int j = 0; j <= layers; ++j)
        for (int i = 0; i < around; ++i) {
            const double r = inner * std::pow(outer / inner, static_cast<double>(j) / layers);
            const double angle = 2 * std::numbers::pi * i / around;
            mesh.x.insert(mesh.x.end(), {r * std::cos(angle), r * std::sin(angle)});
        }
    const auto node = [around](int i, int j) { return j * around + i % around; };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < layers; ++j)
            mesh.elements[0].nodes.insert(mesh.elements[0].nodes.end(),
                                          {node(i, j), node(i, j + 1), node(i + 1, j + 1),  //
                                           node(i, j), node(i + 1, j + 1), node(i + 1, j)});
        mesh.faces[0].cells.nodes.insert(mesh.faces[0].cells.nodes.end(), {node(i, 0), node(i + 1, 0)});
        mesh.faces[1].cells.nodes.insert(mesh.faces[1].cells.nodes.end(), {node(i, layers), node(i + 1, layers)});
    }
    return mesh;
}

}  // namespace examples
