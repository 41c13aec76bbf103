#include "lessons/exercises/01.hpp"

#include "lessons/exercise.hpp"
#include "lessons/random_inputs.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(eta_of_lengths, level_set, eta_3d, eta_regularised, stretch_of, measure_tetrahedron, largest_stretch);

Lengths lengths_of(const Corners& t) {
    Lengths length;
    for (int i = 0; i < 3; ++i) length[i] = std::hypot(t[(i + 1) % 3][0] - t[i][0], t[(i + 1) % 3][1] - t[i][1]);
    return length;
}

EXERCISE("1.1", "eta from the lengths of the edges") {
    Random& random = random_inputs();
    expect_close("eta of the triangle (3, 4, 5) and one twice as large", eta_of_lengths({3, 4, 5}, {6, 8, 10}), 1,
                 1e-12, "a scaling does not distort");
    for (int k = 0; k < 10; ++k) {  // 8 and 9: a thin triangle, as in boundary layers
        const double size = k < 2 ? 1 : k == 2 ? 1e-7 : k == 3 ? 1e7 : random.scale(1e-7, 1e7);
        const auto triangle = [](double of, bool thin) {
            return random_triangle(of, thin ? 1e-5 : 0.1, thin ? 1e-4 : 2);
        };
        const Corners ideal = triangle(k < 2 ? 1 : random.scale(1e-7, 1e7), k == 8), physical = triangle(size, k == 9);
        const Mat<2> F = multiply<2>(edges(physical), inverse<2>(edges(ideal)));
        expect_close(concat("eta of the triangle with the edges ", listed(lengths_of(physical)), ", ideal ",
                            listed(lengths_of(ideal)), ","),
                     eta_of_lengths(lengths_of(ideal), lengths_of(physical)),
                     frobenius_squared<2>(F) / (2 * determinant(F)), k < 8 ? 1e-10 : 1e-4,
                     "the lengths are all that eta depends on: put both triangles into the plane, or say what |F|^2 "
                     "and det F are");
    }
    std::vector<Lengths> none = {{1, 2, 3}, {1, 1, 3}, {2, 3, 7}, {0, 1, 1}, {0, 0, 0}};
    for (std::size_t k = 0; k < 5; ++k)
        for (int i = 1; i < 3; ++i) none.push_back({none[k][i], none[k][(i + 1) % 3], none[k][(i + 2) % 3]});
    random.shuffle(none);
    for (Lengths& lengths : none) {
        const double size = std::ldexp(1, random.integer(-20, 20));
        for (double& length : lengths) length *= size;
        const double found = eta_of_lengths({3, 4, 5}, lengths);
        expect(std::isinf(found) && found > 0, "eta for the lengths ", listed(lengths), " is ", found,
               ", expected infinity: they make no triangle with an area");
    }
}

// eta of the triangle (0, 0), (1, 0), x, whose ideal one has the given apex.
double eta_at(const Vec<2>& x, const Vec<2>& apex) {
    const double slope = (x[0] - apex[0]) / apex[1], stretch = x[1] / apex[1];
    return (1 + slope * slope + stretch * stretch) / (2 * stretch);
}

EXERCISE("1.2", "a level set of eta") {
    Random& random = random_inputs();
    for (int k = 0; k < 12; ++k) {
        const Vec<2> apex = k == 0 ? Vec<2>{0.5, 0.8} : Vec<2>{random.uniform(-3, 3), random.scale(1e-3, 30)};
        const double eta = k == 0 ? 1.5 : k % 3 ? 1 + random.scale(1e-3, 50) : 1 + random.scale(1e-8, 1e-3);
        const Circle circle = level_set(apex, eta);
        const std::string of =
            concat(" of your circle for eta = ", in_short(eta), ", ideal apex (", listed(apex), "), ");
        const double away = std::hypot(apex[0] - circle.centre[0], apex[1] - circle.centre[1]);
        expect(away < circle.radius, "the radius", of, "is ", circle.radius, ", and its centre is ", away,
               " from that apex, where eta = 1: the level set goes around it");
        const double first = random.uniform(0, 6);
        for (int i = 0; i < 8; ++i) {
            const double angle = first + i * 0.785;
            const Vec<2> x = {circle.centre[0] + circle.radius * std::cos(angle),
                              circle.centre[1] + circle.radius * std::sin(angle)};
            expect(x[1] > 0, "the point (", listed(x), ")", of,
                   "is not above the edge from (0, 0) to (1, 0): the triangle is inverted there");
            expect_close(concat("eta at the point (", listed(x), ")", of), eta_at(x, apex), eta, 1e-9,
                         circle.centre == apex ? "the circle is not centred at the apex: eta grows faster towards "
                                                 "the edge"
                                               : "write eta as a function of x and y, and complete the square");
        }
    }
}

void expect_no_eta(const Mat<3>& F, const char* which) {
    const double found = eta_3d(F);
    expect(std::isinf(found) && found > 0, "eta of ", shown<3>(F), " is ", found, ", expected infinity: ", which);
}

EXERCISE("1.3", "eta in 3D") {
    Random& random = random_inputs();
    expect_close("eta of the identity", eta_3d({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 1, 1e-12);
    expect_close("eta of 5 times the identity", eta_3d({{{5, 0, 0}, {0, 5, 0}, {0, 0, 5}}}), 1, 1e-12,
                 "a power of det F must make eta blind to size");
    expect_close("eta of a rotation by 180 degrees, diag(-1, -1, 1),", eta_3d({{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}),
                 1, 1e-12, "det F is all that tells what is inverted");
    expect_close("eta of a rotation that exchanges the axes, (0, 1, 0; 0, 0, 1; 1, 0, 0),",
                 eta_3d({{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}), 1, 1e-12, "its diagonal is 0, and all else is not");
    for (int k = 0; k < 12; ++k) {
        const Vec<3> s = {random.scale(0.1, 10), random.scale(0.1, 10), random.scale(0.1, 10)};
        const double size = k < 4 ? 1 : k < 8 ? random.scale(1e-7, 1e7) : k % 2 ? 1e-150 : 1e150;
        const Mat<3> F = scaled<3>(size, random_with<3>(s));
        const double product = s[0] * s[1] * s[2];
        expect_close(concat("eta of ", shown<3>(F)), eta_3d(F), dot(s, s) / (3 * std::cbrt(product * product)), 1e-10,
                     k < 4    ? "sum of the squares of all entries, and the power 2/n of det F with n = 3"
                     : k < 8 ? "a power of det F must make eta blind to size"
                             : "det F, or the square of an entry, is not a number in the range of double: what may you "
                               "do with F before, as eta is blind to size?");
        expect_no_eta(scaled<3>(size, random_with<3>({-s[0], s[1], s[2]})), "it is inverted, det F < 0");
    }
    for (int k = 0; k < 3; ++k) {
        const Vec<3> s = {random.scale(1e-7, 1e-5), random.uniform(0.5, 2), random.uniform(0.5, 2)};
        const Mat<3> F = random_with<3>(s);
        const double product = s[0] * s[1] * s[2], expected = dot(s, s) / (3 * std::cbrt(product * product));
        expect_close(concat("eta of ", shown<3>(F), ", nearly flat,"), eta_3d(F), expected, 1e-7,
                     "det F is small, and positive");
        expect_no_eta(random_with<3>({-s[0], s[1], s[2]}), "it is inverted, det F < 0");
    }
    const Vec<3> a = {1, -1, 0}, b = {1, 1, 1}, zero = {0, 0, 0};
    std::vector<Mat<3>> singular = {{a, b, a + b}, {a, b, b}, {b, b, b}, {a, zero, b}, {zero, zero, zero}};
    for (Mat<3>& F : singular) {
        const double size = std::ldexp(1, random.integer(-30, 30));
        std::swap(F[0], F[random.integer(0, 2)]);
        expect_no_eta(scaled<3>(size, F), "it is flat, det F = 0");
        expect_no_eta(scaled<3>(size, transpose<3>(F)), "it is flat, det F = 0");
    }
}

EXERCISE("1.4", "the regularised distortion, without cancellation") {
    Random& random = random_inputs();
    const auto compare = [](const Mat<2>& F, double delta, const char* hint) {
        const double det = determinant(F), root = std::hypot(det, 2 * delta);
        const double sigma = det > 0 ? (det + root) / 2 : 2 * delta * delta / (root - det);
        const double expected = frobenius_squared<2>(F) / (2 * sigma), found = eta_regularised(F, delta);
        expect(std::abs(found - expected) <= 1e-9 * expected, "eta_delta of ", shown<2>(F), ", whose det F is ", det,
               ", with delta = ", delta, " is ", found, ", expected ", expected, ": ", hint);
    };
    const char* const as_printed = "|F|^2 / (2 sigma_delta) of Eqs. 2 and 3";
    compare({{{1, 0.3}, {0.2, -1}}}, 0.1, "|F|^2 / (2 sigma_delta), and det F keeps its sign in sigma_delta");
    for (int k = 0; k < 20; ++k) {
        const Vec<2> s = {random.scale(0.1, 10), random.scale(0.1, 10)};
        const double size = k < 10 ? 1 : random.scale(1e-4, 1e4);
        const double delta = size * size * (k % 2 == 0   ? random.scale(1e-10, 0.03)
                                            : k % 4 == 1 ? random.scale(0.03, 30)
                                                         : random.scale(30, 1e7));
        compare(scaled<2>(size, random_with<2>(s)), delta, as_printed);
        compare(scaled<2>(size, random_with<2>({-s[0], s[1]})), delta,
                k % 2 ? as_printed : "where det F < 0 and delta is small, the sum in sigma_delta cancels");
    }
    const double two = std::ldexp(1, random.integer(-10, 10)), delta = random.scale(1e-6, 1);
    compare({{{-two, 0}, {0, -two}}}, delta, "a rotation by 180 degrees is not inverted, det F > 0");
    compare({{{two, 2 * two}, {2 * two, 4 * two}}}, delta, "where det F = 0 sigma_delta is delta");
    expect_close(concat("eta_delta of F = 0 with delta = ", delta), eta_regularised({}, delta), 0, 0,
                 "|F| = 0 and sigma_delta = delta");
    for (const Mat<2>& F : {Mat<2>{{{1, 2}, {2, 4}}}, Mat<2>{{{1, 0}, {0, -1}}}, Mat<2>{}}) {
        const double found = eta_regularised(F, 0);
        expect(std::isinf(found) && found > 0, "eta_delta of ", shown<2>(F), " with delta = 0 is ", found,
               ", expected infinity: without delta it is eta, which has its barrier where det F <= 0");
    }
    for (int k = 0; k < 6; ++k)
        compare(scaled<2>(random.scale(1e-4, 1e4), random_with<2>({random.scale(0.01, 10), 1})), 0,
                "where det F > 0 the formula as printed keeps its digits");
}

EXERCISE("1.5", "how far a triangle is stretched") {
    Random& random = random_inputs();
    expect_close("the stretch of eta = 1", stretch_of(1), 1, 1e-12,
                 "s itself, not its logarithm: it is 1 where nothing is stretched");
    for (int k = 0; k < 16; ++k) {
        const double s = k == 0   ? 2
                         : k < 6  ? random.uniform(1.01, 10)
                         : k < 12 ? random.scale(10, 1e6)
                                  : 1 + random.scale(1e-5, 1e-2);
        const double eta = (s + 1 / s) / 2;
        expect_close(concat("the stretch for eta = ", eta), stretch_of(eta), s, 1e-9,
                     "eta = (s + 1/s) / 2 is an equation for s; one of its roots is at least 1");
    }
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

double eta_of(const Vec<3>& s) { return dot(s, s) / (3 * std::pow(std::cbrt(s[0] * s[1] * s[2]), 2)); }

// One tetrahedron that is not regular, mapped by an F with the singular values s.
void compare_measures(const Vec<3>& s) {
    Random& random = random_inputs();
    const Vec<3> sizes = {random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2)};
    const Mat<3> A = scaled<3>(random.scale(1e-3, 1e3), random_with<3>(sizes)), F = random_with<3>(s);
    Tetrahedron ideal{}, physical;
    for (int i = 0; i < 3; ++i) ideal[i + 1] = A[i];
    for (int i = 0; i < 4; ++i) physical[i] = times<3>(F, ideal[i]);
    const Measured found = measure_tetrahedron(lengths_of(ideal), lengths_of(physical));
    const std::string of =
        concat(" of the tetrahedron with the edges ", listed(lengths_of(physical)), ", ideal ",
               listed(lengths_of(ideal)), ", whose F has the singular values ", listed(s), ",");
    const auto [least, most] = std::minmax({s[0], s[1], s[2]});
    const double stretch = most / least;
    expect_close("eta" + of, found.eta, eta_of(s), 1e-6);
    const bool squared = stretch > 1.1 && std::abs(found.stretch / (stretch * stretch) - 1) < 1e-3;
    expect_close("the stretch" + of, found.stretch, stretch, 1e-5,
                 squared ? "the eigenvalues of F'F are the squares of the singular values" : "");
}

void check_tetrahedra() {
    Random& random = random_inputs();
    compare_measures({2, 2, 2});
    for (int k = 0; k < 6; ++k)
        compare_measures({random.scale(0.1, 10), random.scale(0.1, 10), random.scale(0.1, 10)});
    compare_measures({random.uniform(0.005, 0.01), 1, 1});
    compare_measures({7, 7, random.uniform(0.007, 0.01)});
    compare_measures({1, 300, 1});
    for (int k = 0; k < 3; ++k) compare_measures({random.uniform(2e-4, 4e-4), 1, 1});

    const SixLengths not_even_triangles = {0.95, 1.97, 3, 0.9, 1.97, 0.95};
    for (const SixLengths& none : {SixLengths{3, 5, 4, 4, 5, 3}, SixLengths{1, 1, 1, 1, 1, 1.8},
                                   SixLengths{1, 2, 1, 1.8, 1.3, 4}, not_even_triangles}) {
        const double size = std::ldexp(1, random.integer(-10, 10));
        SixLengths lengths = none;
        for (double& length : lengths) length *= size;
        const Measured found = measure_tetrahedron({1, 1, 1, 1, 1, 1}, lengths);
        expect(found.eta == INFINITY && found.stretch == INFINITY, "for the lengths ", listed(lengths), " eta is ",
               found.eta, " and the stretch ", found.stretch,
               ", expected infinity: they make no tetrahedron with a volume",
               none == not_even_triangles ? ", nor its faces triangles, though a determinant may be positive" : "");
    }
}

EXERCISE("1.6", "an hour: what eta says of a tetrahedron") {
    check_tetrahedra();
    expect_close("the largest stretch for eta = 1", largest_stretch(1), 1, 1e-7, "eta = 1 only for similar ones");
    for (int k = 0; k < 10; ++k) {
        const double stretch = k < 4   ? random_inputs().uniform(1.1, 5)
                               : k < 8 ? random_inputs().scale(5, 1e3)
                                       : 1 + random_inputs().scale(1e-3, 0.1);
        const Vec<3> s = {stretch, std::sqrt((stretch * stretch + 1) / 2), 1};
        const double eta = eta_of(s), found = largest_stretch(eta);
        const std::string said = concat("for eta = ", eta, " you say ", found, ", but ");
        expect(found > stretch * (1 - 1e-6), said, "there is a tetrahedron of that eta with the stretch ", stretch);
        expect(found < stretch * (1 + 1e-6), said, "no F of that eta has more than ", stretch,
               ": the bound has to be one that some F attains");
    }
}

}  // namespace
}  // namespace almesh::lessons
