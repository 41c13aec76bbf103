// A piston over a stroke, forth and back: each mesh starts from the one before, and needs few Newton steps. The walls
// beside the piston let the nodes slide.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "almesh.hpp"

namespace {

// Squares between x = 0, the piston, and x = 1, the head.
almesh::MeshArrays cylinder(int columns, int rows) {
    using almesh::Cell;
    almesh::MeshArrays mesh;
    mesh.elements = {{Cell::quadrilateral, {}}};
    mesh.faces = {{"piston", {Cell::line, {}}}, {"head", {Cell::line, {}}}, {"walls", {Cell::line, {}}}};
    const auto node = [rows](int i, int j) { return i * (rows + 1) + j; };
    for (int i = 0; i <= columns; ++i)
        for (int j = 0; j <= rows; ++j) mesh.x.insert(mesh.x.end(), {1.0 * i / columns, 0.5 * j / rows});
    const auto add = [](almesh::Cells& cells, std::initializer_list<int> nodes) {
        cells.nodes.insert(cells.nodes.end(), nodes);
    };
    for (int i = 0; i < columns; ++i) {
        for (int j = 0; j < rows; ++j)
            add(mesh.elements[0], {node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        add(mesh.faces[2].cells, {node(i, 0), node(i + 1, 0)});
        add(mesh.faces[2].cells, {node(i + 1, rows), node(i, rows)});
    }
    for (int j = 0; j < rows; ++j) {
        add(mesh.faces[0].cells, {node(0, j + 1), node(0, j)});
        add(mesh.faces[1].cells, {node(columns, j), node(columns, j + 1)});
    }
    return mesh;
}

}  // namespace

int main() {
    almesh::MovingMesh mesh(cylinder(24, 12));
    mesh.set("head", almesh::Boundary::fixed());
    mesh.set("walls", almesh::Boundary::slides());
    mesh.set("piston", almesh::Boundary::moves([](const almesh::Point& X, double t) -> almesh::Point {
        return {X[0] + 0.4 * (1 - std::cos(2 * std::numbers::pi * t)), X[1]};
    }));

    std::printf("   t  piston at  Newton  quality  certified bound\n");
    almesh::Moved now = mesh.move(0);
    for (int step = 1; step <= 8 && now.is_good(); ++step) {
        now = mesh.follow(now, step / 8.0);
        double least = 1;
        for (const double bound : now.verdict.certified_bound) least = std::min(least, bound);
        std::printf("%.3f  %9.4f  %6d  %7.4f  %.4f\n", now.t, now.x[0], now.newton_steps, now.relative_quality, least);
    }
    return now.is_good() ? 0 : 1;
}
