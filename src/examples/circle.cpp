// A circle moved in a ring by eight times its radius, as in section 4.1 of the paper, and turned; the mesh around it
// follows. Then what the quality of one element has to do with where the circle is: the derivative of a function.
#include <cmath>
#include <cstdio>

#include "examples/ring.hpp"

int main() {
    almesh::MovingMesh mesh(examples::ring(1, 21, 32, 20));
    mesh.set("outer", almesh::Boundary::fixed());
    mesh.set("inner", almesh::Boundary::moves([](const almesh::Point& X, double t) -> almesh::Point {
        return {X[0] + 8 * t, X[1]};
    }));

    almesh::Moved moved = mesh.move(1, [](const almesh::Progress& now) {
        if (now.newton_step == 0) std::printf("iteration %d: |c_D| = %.1e\n", now.iteration, now.constraint_norm);
    });
    std::printf("%s: %d Newton steps, relative quality %.4f, %s\n", moved.status.c_str(), moved.newton_steps,
                moved.relative_quality, moved.is_good() ? "certified valid and injective" : "not certified");

    // J: where the node beside the middle of the ring is. dJ / d(shift of the circle) by one linear solve.
    const std::size_t node = 32 * 10;
    std::vector<double> dJ_dx(moved.x.size(), 0.0);
    dJ_dx[2 * node] = 1;
    const std::vector<double> dJ_dg = mesh.adjoint(moved, dJ_dx);
    double slope = 0;
    for (std::size_t i = 0; i < 32; ++i) slope += dJ_dg[2 * i];  // the circle's nodes, all shifted in x
    const almesh::Moved ahead = mesh.move(1 + 1e-4), behind = mesh.move(1 - 1e-4);
    const double difference = (ahead.x[2 * node] - behind.x[2 * node]) / (8 * 2e-4);
    std::printf("dJ/dg = %.6f, by differences %.6f\n", slope, difference);
    return moved.is_good() && std::abs(slope - difference) < 1e-5 ? 0 : 1;
}
