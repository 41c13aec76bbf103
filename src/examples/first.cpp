#include <cstdio>

#include "examples/ring.hpp"

int main() {
    almesh::MovingMesh mesh(examples::ring(1, 21, 32, 20));
    mesh.set("outer", almesh::Boundary::fixed());
    mesh.set("inner", almesh::Boundary::moves([](almesh::Point X, double t) -> almesh::Point {
        return {X[0] + 8 * t, X[1]};
    }));
    const almesh::Moved moved = mesh.move();
    std::printf("%s, %s\n", moved.status.c_str(), moved.is_good() ? "certified valid and injective" : "not certified");
}
