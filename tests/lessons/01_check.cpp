#include "lessons/exercises/01.hpp"

#include "energy/densities.hpp"
#include "lessons/exercise.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(eta_of_lengths, level_set, eta_3d, eta_regularised, stretch_of, measure_tetrahedron, largest_stretch);

Lengths lengths_of(const std::array<Vec<2>, 3>& t) {
    Lengths length;
    for (int i = 0; i < 3; ++i) length[i] = std::hypot(t[(i + 1) % 3][0] - t[i][0], t[(i + 1) % 3][1] - t[i][1]);
    return length;
}

EXERCISE("1.1", "eta from the lengths of the edges") {
    expect_close("eta of the triangle (3, 4, 5) and one twice as large", eta_of_lengths({3, 4, 5}, {6, 8, 10}), 1,
                 1e-12, "a scaling does not distort");
    const std::array<Vec<2>, 3> ideal = {{{0, 0}, {2, 0}, {0.5, 1.5}}};
    for (const Vec<2>& x : {Vec<2>{0.5, 4}, Vec<2>{3, 0.2}, Vec<2>{-2, 1}}) {
        const std::array<Vec<2>, 3> physical = {{{1, 1}, {3, 2}, x}};
        const auto edges = [](const std::array<Vec<2>, 3>& t) {
            return Mat<2>{{{t[1][0] - t[0][0], t[2][0] - t[0][0]}, {t[1][1] - t[0][1], t[2][1] - t[0][1]}}};
        };
        const Mat<2> B = edges(physical), A_inverse = inverse<2>(edges(ideal));
        Mat<2> F{};
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                for (int k = 0; k < 2; ++k) F[i][j] += B[i][k] * A_inverse[k][j];
        if (determinant(F) < 0) F = {{F[0], {-F[1][0], -F[1][1]}}};  // lengths know nothing of orientation
        expect_close(concat("eta of the triangle (1, 1), (3, 2), (", x[0], ", ", x[1], ")"),
                     eta_of_lengths(lengths_of(ideal), lengths_of(physical)), distortion<2>(F, 0.0), 1e-11,
                     "put both triangles into the plane, or weigh the squares of the lengths by the ideal cotangents");
    }
    for (const Lengths& none : {Lengths{1, 2, 3}, Lengths{1, 1, 3}, Lengths{7, 2, 3}}) {
        const double found = eta_of_lengths({3, 4, 5}, none);
        expect(std::isinf(found) && found > 0, "eta for lengths ", none[0], ", ", none[1], ", ", none[2], " is ", found,
               ", expected infinity: they make no triangle with an area");
    }
}

EXERCISE("1.2", "a level set of eta") {
    for (const Vec<2>& apex : {Vec<2>{0.5, 0.8}, Vec<2>{-0.3, 0.1}})
        for (const double eta : {1.01, 1.5, 7.0}) {
            const Circle circle = level_set(apex, eta);
            for (double angle = 0.1; angle < 6.3; angle += 0.7) {
                const double x = circle.centre[0] + circle.radius * std::cos(angle),
                             y = circle.centre[1] + circle.radius * std::sin(angle);
                const double found = distortion<2>(Mat<2>{{{1, (x - apex[0]) / apex[1]}, {0, y / apex[1]}}}, 0.0);
                const std::string at = concat("(", x, ", ", y, ") of your circle for eta = ", eta);
                expect(y > 0, "the point ", at, " is not above the edge: the triangle is inverted there");
                expect_close(concat("eta at ", at), found, eta, 1e-9,
                             circle.centre == apex ? "the circle is not centred at the apex: eta grows faster towards "
                                                     "the edge"
                                                   : "eta = 1 + |x - apex|^2 / (2 y apex_y): complete the square");
            }
        }
}

EXERCISE("1.3", "eta in 3D") {
    expect_close("eta of the identity", eta_3d({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 1, 1e-12);
    expect_close("eta of 5 times the identity", eta_3d({{{5, 0, 0}, {0, 5, 0}, {0, 0, 5}}}), 1, 1e-12,
                 "the power of det F must make eta blind to size: 2/n with n = 3");
    const Mat<3> F = {{{1, 0.2, 0}, {0.1, 2, 0.3}, {0, -0.4, 0.5}}};
    expect_close("eta of a general F", eta_3d(F), distortion<3>(F, 0.0), 1e-12);
    expect(std::isinf(eta_3d({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}})), "eta of a reflection is finite: ",
           "with the barrier it is infinite where det F is not positive");
}

EXERCISE("1.4", "the regularised distortion, without cancellation") {
    const Mat<2> inverted = {{{1, 0.3}, {0.2, -1}}};
    for (const double delta : {1.0, 0.1, 1e-3})
        expect_close(concat("eta_delta of an inverted triangle, delta = ", delta, ", divided by the value of Eq. 2"),
                     eta_regularised(inverted, delta) / distortion<2>(inverted, delta), 1, 1e-9,
                     "|F|^2 / (2 sigma_delta), and det F keeps its sign in sigma_delta");
    const double small = eta_regularised(inverted, 1e-9) / distortion<2>(inverted, 1e-9);
    expect_close("the ratio to Eq. 2 at delta = 1e-9", small, 1, 1e-6,
                 "det + sqrt(det^2 + 4 delta^2) cancels where det < 0; multiply and divide by sqrt(...) - det");
    expect_close("eta_delta of the identity, delta = 0,", eta_regularised({{{1, 0}, {0, 1}}}, 0), 1, 1e-12,
                 "where det F > 0 the formula as printed keeps its digits");
}

EXERCISE("1.5", "how far a triangle is stretched") {
    expect_close("the stretch of eta = 1", stretch_of(1), 1, 1e-12,
                 "s itself, not its logarithm: it is 1 where nothing is stretched");
    for (const double s : {2.0, 10.0, 50000.0})
        expect_close(concat("the stretch of diag(1, ", s, ")"),
                     stretch_of(distortion<2>(Mat<2>{{{1, 0}, {0, s}}}, 0.0)), s, 1e-9,
                     "solve eta = (s + 1/s) / 2 for the root that is at least 1");
}

using Tetrahedron = std::array<Vec<3>, 4>;

SixLengths lengths_of(const Tetrahedron& t) {
    SixLengths length;
    const int edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    for (int k = 0; k < 6; ++k) {
        const Vec<3> d = t[edge[k][1]] - t[edge[k][0]];
        length[k] = std::sqrt(dot(d, d));
    }
    return length;
}

// The tetrahedron mapped by F with the singular values s.
Tetrahedron stretched(const Tetrahedron& t, const Vec<3>& s) {
    const Mat<3> turn = {{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}}};
    const Mat<3> tilt = {{{1, 0, 0}, {0, 0.28, -0.96}, {0, 0.96, 0.28}}};
    const Mat<3> S = {{{s[0], 0, 0}, {0, s[1], 0}, {0, 0, s[2]}}};
    const Mat<3> F = multiply<3>(multiply<3>(multiply<3>(tilt, turn), S), multiply<3>(turn, tilt));
    Tetrahedron image;
    for (int i = 0; i < 4; ++i) image[i] = {dot(F[0], t[i]), dot(F[1], t[i]), dot(F[2], t[i])};
    return image;
}

double eta_of(const Vec<3>& s) { return dot(s, s) / (3 * std::pow(std::cbrt(s[0] * s[1] * s[2]), 2)); }

void check_tetrahedra() {
    const Tetrahedron ideal = {{{0, 0, 0}, {2, 0.3, 0}, {0.5, 1.5, 0.2}, {0.4, 0.1, 0.9}}};
    for (const Vec<3>& s :
         {Vec<3>{2, 2, 2}, Vec<3>{2, 1, 0.5}, Vec<3>{1, 0.3, 0.9}, Vec<3>{0.01, 1, 1}, Vec<3>{7, 7, 7e-3}}) {
        const Measured found = measure_tetrahedron(lengths_of(ideal), lengths_of(stretched(ideal, s)));
        const std::string of = concat(" of an F with the singular values ", s[0], ", ", s[1], ", ", s[2]);
        const auto [least, most] = std::minmax({s[0], s[1], s[2]});
        const double stretch = most / least;
        expect_close("eta" + of, found.eta, eta_of(s), 1e-7,
                     "with the scalar products of the edges from vertex 0, (l_01^2 + l_02^2 - l_12^2) / 2 for two of "
                     "them, G of the ideal and P of the physical one, inverse(G) P has the trace |F|^2 and the "
                     "determinant (det F)^2");
        const bool squared = stretch > 1 && std::abs(found.stretch / (stretch * stretch) - 1) < 1e-3;
        expect_close("the stretch" + of, found.stretch, stretch, 1e-5,
                     squared ? "the eigenvalues of F'F are the squares of the singular values"
                             : "the root of the largest eigenvalue of F'F over the smallest");
    }
    for (const SixLengths& none : {SixLengths{3, 5, 4, 4, 5, 3}, SixLengths{1, 1, 1, 1, 1, 1.8},
                                   SixLengths{0.95, 1.97, 3, 0.9, 1.97, 0.95}}) {
        const Measured found = measure_tetrahedron(lengths_of(ideal), none);
        expect(std::isinf(found.eta) && std::isinf(found.stretch), "for the lengths ", none[0], ", ", none[1], ", ",
               none[2], ", ", none[3], ", ", none[4], ", ", none[5], " eta is ", found.eta, " and the stretch ",
               found.stretch, ", expected infinity: they make no tetrahedron with a volume",
               none[0] == 0.95 ? ", not even triangles: a positive determinant is not enough, the matrix of scalar "
                                 "products has to be positive definite"
                               : "");
    }
}

EXERCISE("1.6", "an hour: what eta says of a tetrahedron") {
    check_tetrahedra();
    expect_close("the largest stretch for eta = 1", largest_stretch(1), 1, 1e-7, "eta = 1 only for similar ones");
    for (const double stretch : {1.5, 4.0, 1000.0}) {
        const Vec<3> s = {stretch, std::sqrt((stretch * stretch + 1) / 2), 1};
        const double eta = eta_of(s), found = largest_stretch(eta);
        const std::string said = concat("for eta = ", eta, " you say ", found, ", but ");
        expect(found > stretch * (1 - 1e-6), said, "diag(", s[0], ", ", s[1], ", 1) has that eta and the stretch ",
               stretch, ": which singular value between the other two makes eta the smallest?");
        expect(found < stretch * (1 + 1e-6), said, "no F of that eta has more than ", stretch,
               ": the bound has to be one that some F attains");
    }
}

}  // namespace
}  // namespace almesh::lessons
