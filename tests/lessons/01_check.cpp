#include "lessons/exercises/01.hpp"

#include "energy/densities.hpp"
#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

const Triangle ideal = {{{0, 0}, {2, 0}, {0.5, 1.5}}}, physical = {{{1, 1}, {3, 2}, {0.5, 4}}};

EXERCISE("1.1", "the Jacobian of an affine map") {
    const Mat<2> F = jacobian_of_map(ideal, physical);
    for (int v = 0; v < 3; ++v)
        for (int i = 0; i < 2; ++i) {
            const double image = physical[0][i] + F[i][0] * (ideal[v][0] - ideal[0][0]) +
                                 F[i][1] * (ideal[v][1] - ideal[0][1]);
            expect_close(concat("coordinate ", i, " of the image of vertex ", v), image, physical[v][i], 1e-12,
                         "F has to take the edges of the ideal triangle to those of the physical one");
        }
    const Mat<2> identity = jacobian_of_map(ideal, ideal);
    expect_close("F of a triangle mapped to itself, entry 1 1,", identity[0][0], 1, 1e-12);
}

EXERCISE("1.2", "eta in 2D") {
    const double angle = 0.7, scale = 3;
    const double c = scale * std::cos(angle), s = scale * std::sin(angle);
    expect_close("eta of a rotation times a scaling", eta_2d({{{c, -s}, {s, c}}}), 1, 1e-12,
                 "these are the maps without distortion");
    expect_close("eta of diag(1, 2)", eta_2d({{{1, 0}, {0, 2}}}), 1.25, 1e-12);
    expect_close("eta of a shear by 1", eta_2d({{{1, 1}, {0, 1}}}), 1.5, 1e-12);
    expect(std::isinf(eta_2d({{{1, 0}, {0, -1}}})), "eta of a reflection is ", eta_2d({{{1, 0}, {0, -1}}}),
           ", expected infinity: a line search could accept the inverted triangle");
    expect(std::isinf(eta_2d({{{1, 0}, {1, 0}}})), "eta of a triangle of no area is not infinite");
}

EXERCISE("1.3", "eta in 3D") {
    expect_close("eta of the identity", eta_3d({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 1, 1e-12);
    expect_close("eta of 5 times the identity", eta_3d({{{5, 0, 0}, {0, 5, 0}, {0, 0, 5}}}), 1, 1e-12,
                 "the power of det F must make eta blind to size: 2/n with n = 3");
    const Mat<3> F = {{{1, 0.2, 0}, {0.1, 2, 0.3}, {0, -0.4, 0.5}}};
    expect_close("eta of a general F", eta_3d(F), distortion<3>(F, 0.0), 1e-12);
    expect(std::isinf(eta_3d({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}})), "eta of a reflection is finite");
}

EXERCISE("1.4", "the regularised distortion, without cancellation") {
    const Mat<2> inverted = {{{1, 0.3}, {0.2, -1}}};
    for (const double delta : {1.0, 0.1, 1e-3})
        expect_close(concat("eta_delta of an inverted triangle, delta = ", delta, ","),
                     eta_regularised(inverted, delta) / distortion<2>(inverted, delta), 1, 1e-9,
                     "the ratio to the value of Eq. 2");
    const double small = eta_regularised(inverted, 1e-9) / distortion<2>(inverted, 1e-9);
    expect_close("the ratio to Eq. 2 at delta = 1e-9", small, 1, 1e-6,
                 "det + sqrt(det^2 + 4 delta^2) cancels where det < 0; multiply and divide by sqrt(...) - det");
    expect_close("eta_delta of the identity, delta = 0,", eta_regularised({{{1, 0}, {0, 1}}}, 0), 1, 1e-12);
}

EXERCISE("1.5", "how far a triangle is stretched") {
    expect_close("the stretch of eta = 1", stretch_of(1), 1, 1e-12);
    for (const double s : {2.0, 10.0, 50000.0})
        expect_close(concat("the stretch of diag(1, ", s, ")"),
                     stretch_of(distortion<2>(Mat<2>{{{1, 0}, {0, s}}}, 0.0)), s, 1e-9,
                     "solve eta = (s + 1/s) / 2 for the root that is at least 1");
}

}  // namespace
}  // namespace almesh::lessons
