#include "lessons/exercises/13.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "lessons/exercise.hpp"
#include "support/program.hpp"

namespace almesh::lessons {
namespace {

ANSWERS(orientation, have_common_point, boundary_edges, cover_number, proved_injective, proves_positive, accepts);

constexpr long long most = 1LL << 60;

std::string text_of(const Point& p) { return concat("(", p[0], ", ", p[1], ")"); }
std::string text_of(const Segment& s) { return concat(text_of(s[0]), " to ", text_of(s[1])); }

Wide cross(const Point& u, const Point& v) { return Wide(u[0]) * v[1] - Wide(u[1]) * v[0]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1]}; }
int sign(Wide a) { return (a > 0) - (a < 0); }

// At most 60 bits, the first of them set: no floating-point number holds them all.
long long many_bits(int bits) {
    Random& random = random_inputs();
    long long number = 1;
    for (int k = 1; k < bits; ++k) number = 2 * number + random.integer(0, 1);
    return number;
}

// (u, v) with u x v = 1, both of so many bits.
std::array<Point, 2> nearly_parallel(int bits) {
    for (;;) {
        const Point u = {many_bits(bits), many_bits(bits)};
        long long p = u[0], q = u[1];
        Point of_p = {1, 0}, of_q = {0, 1};  // Euclid's algorithm: p = of_p[0] u[0] + of_p[1] u[1]
        while (q != 0) {
            const long long times = p / q;
            std::swap(p -= times * q, q);
            for (int k = 0; k < 2; ++k) std::swap(of_p[k] -= times * of_q[k], of_q[k]);
        }
        if (p == 1) return {u, {-of_p[1], of_p[0]}};
    }
}

// x -> A x + b with whole numbers, det A = 1: it changes no orientation, no common point and no cover number.
struct Map {
    long long a = 1, b = 0, c = 0, d = 1;
    Point shift{};

    // For coordinates below 2^small; images are below 2^bits.
    static Map random(int small, int bits) {
        const auto [u, v] = nearly_parallel(bits - small - 2);
        const Point shift = {many_bits(bits - 2), -many_bits(bits - 2)};
        if (random_inputs().integer(0, 1)) return {u[0], v[0], u[1], v[1], shift};
        return {u[1], v[1], -u[0], -v[0], shift};
    }
    // For coordinates up to `range`; images are below 2^60, some of their differences above.
    static Map largest(int range) {
        const auto [u, v] = nearly_parallel(59 - std::bit_width(range - 1u));  // v is no longer than u / 2
        return {u[0], v[0], u[1], v[1], {}};
    }
    // Heights and horizontal edges stay what they are.
    static Map shifted(int bits) { return {1, 0, 0, 1, {-many_bits(bits - 1), many_bits(bits - 1)}}; }

    Point operator()(const Point& p) const { return {a * p[0] + b * p[1] + shift[0], c * p[0] + d * p[1] + shift[1]}; }
    Segment operator()(const Segment& s) const { return {(*this)(s[0]), (*this)(s[1])}; }
};

Point small_point(int range) {
    Random& random = random_inputs();
    const int x = random.integer(-range, range);
    return {x, random.integer(-range, range)};
}

// ------------------------------------------------------------------------------------------------------------ 13.1

void expect_orientation(const Point& a, const Point& b, const Point& c, int expected, const std::string& hint) {
    const int found = orientation(a, b, c);
    expect(found == expected, "the orientation of ", text_of(a), ", ", text_of(b), ", ", text_of(c), " is ", found,
           ", expected ", expected, ": ", hint);
}

EXERCISE("13.1", "the exact orientation of three points") {
    Random& random = random_inputs();
    const std::string plain = "the sign of (b - a) x (c - a), 0 for points on a line";
    expect_orientation({0, 0}, {1, 0}, {0, 1}, 1, plain);
    expect_orientation({0, 0}, {0, 1}, {1, 0}, -1, plain);
    expect_orientation({1, 1}, {1, 1}, {5, 7}, 0, plain);
    for (int k = 0; k < 30; ++k) {
        const Point a = small_point(4), b = small_point(4), c = small_point(4);
        expect_orientation(a, b, c, sign(cross(minus(b, a), minus(c, a))), plain);
    }
    expect_orientation({-most, -most}, {most, -most}, {most, most}, 1, "a triangle as large as can be");
    expect_orientation({-most, -most}, {most, most}, {most - 1, most}, 1, "one is a unit beside the line");
    for (int k = 0; k < 60; ++k) {  // areas of a few units, sides of 2^57 to 2^61
        const int range = k % 2 + 1;
        const Point a = small_point(range), b = small_point(range), c = small_point(range);
        const Map map = k % 2 ? Map::random(2, 59) : Map::largest(range);
        const int twice_the_area = static_cast<int>(cross(minus(b, a), minus(c, a)));
        expect_orientation(map(a), map(b), map(c), sign(twice_the_area),
                           concat("the determinant of this long triangle is ", twice_the_area));
    }
    for (int k = 0; k < 30; ++k) {  // c = a + t (b - a) + e is as far off the line as e, which is a unit or nothing
        const int bits = random.integer(20, 58), t = random.integer(1, 3);
        const Point a = {-many_bits(bits), many_bits(bits)}, off = small_point(1);
        Point d = {many_bits(bits), many_bits(bits - random.integer(0, 19))};
        if (random.integer(0, 1)) d[0] = -d[0];
        const Point b = {a[0] + d[0], a[1] + d[1]}, c = {a[0] + t * d[0] + off[0], a[1] + t * d[1] + off[1]};
        if (std::max({std::abs(c[0]), std::abs(c[1])}) > most) continue;
        const int expected = sign(cross(d, off));
        const std::string hint = off == Point{} ? "the three are on a line" : "one is a unit beside the line";
        expect_orientation(a, b, c, expected, hint);
        expect_orientation(c, a, b, expected, hint);
        expect_orientation(b, a, c, -expected, hint);
    }
}

// ------------------------------------------------------------------------------------------------------------ 13.2

bool is_between(long long p, long long a, long long b) { return std::min(a, b) <= p && p <= std::max(a, b); }

// Of segments with small coordinates: s[0] + t u = s'[0] + t' u' with t and t' in [0, 1].
bool in_common(const Segment& s, const Segment& other) {
    const Point u = minus(s[1], s[0]), v = minus(other[1], other[0]), w = minus(other[0], s[0]);
    if (Wide D = cross(u, v); D != 0) {
        Wide t = cross(w, v), t_other = cross(w, u);
        if (D < 0) D = -D, t = -t, t_other = -t_other;
        return t >= 0 && t <= D && t_other >= 0 && t_other <= D;
    }
    if (cross(u, w) != 0 || cross(v, w) != 0) return false;
    // On a line, so where one holds an end of the other; a point beside a point is not between.
    for (const auto& [one, two] : {std::pair(s, other), std::pair(other, s)})
        for (const Point& end : two)
            if (is_between(end[0], one[0][0], one[1][0]) && is_between(end[1], one[0][1], one[1][1])) return true;
    return false;
}

void expect_common(const Segment& s, const Segment& t, bool expected, const std::string& where = "") {
    const bool found = have_common_point(s, t);
    const bool is_point = s[0] == s[1] || t[0] == t[1], parallel = cross(minus(s[1], s[0]), minus(t[1], t[0])) == 0;
    expect(found == expected, "the segments ", text_of(s), " and ", text_of(t), where,
           is_point ? ", one of them a point," : parallel ? ", which are parallel," : "",
           expected ? " have a point in common, the answer was no" : " have none in common, the answer was yes");
}

EXERCISE("13.2", "whether two segments have a point in common") {
    Random& random = random_inputs();
    expect_common({{{0, 0}, {4, 4}}}, {{{0, 4}, {4, 0}}}, true);
    expect_common({{{0, 0}, {4, 0}}}, {{{2, 0}, {2, 3}}}, true);
    expect_common({{{0, 0}, {4, 0}}}, {{{5, 0}, {7, 0}}}, false);
    expect_common({{{0, 0}, {6, 0}}}, {{{2, 0}, {3, 0}}}, true);
    expect_common({{{0, 0}, {0, 0}}}, {{{-1, -1}, {1, 1}}}, true);
    for (int k = 0; k < 90; ++k) {  // a grid so coarse that most touch
        const int range = k % 3 + 1;
        const Point a = small_point(range), b = small_point(range), c = small_point(range), d = small_point(range);
        const Segment s = {a, k % 10 == 0 ? a : b}, t = {c, d};
        expect_common(s, t, in_common(s, t));
        if (k % 2) continue;
        const Map map = k % 4 ? Map::random(3, 58) : Map::largest(range);
        expect_common(map(s), map(t), in_common(s, t), " (they touch or cross as small ones do)");
    }
    for (int k = 0; k < 40; ++k) {  // an end a unit from the other segment, on it, or a unit beyond
        const long long u = many_bits(random.integer(10, 56)), v = many_bits(random.integer(10, 56));
        const Point shift = {-many_bits(58), many_bits(57)}, off = small_point(1), far = {-v, u};
        const auto put = [&](Wide x, Wide y) {
            return Point{static_cast<long long>(x + shift[0]), static_cast<long long>(y + shift[1])};
        };
        const Segment s = {put(-u, -v), put(u, v)}, t = {put(off[0], off[1]), put(off[0] + far[0], off[1] + far[1])};
        const bool expected = sign(cross({u, v}, off)) <= 0;  // far is on the left of s
        expect_common(s, t, expected, " (an end of one is a unit from the other, or on it)");
    }
}

// ------------------------------------------------------------------------------------------------------------ meshes

Point on_circle(double radius, double turn) {
    constexpr double unit = 1 << 20;
    const double angle = 2 * std::numbers::pi * turn;
    return {std::llround(unit * radius * std::cos(angle)), std::llround(unit * radius * std::sin(angle))};
}

// m sectors around a centre, in so many turns.
Triangulation fan(int m, double radius, int turns, double start) {
    Triangulation mesh{{{0, 0}}, {}};
    for (int i = 0; i < m; ++i) {
        mesh.x.push_back(on_circle(radius, start + double(turns) * i / m));
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % m});
    }
    return mesh;
}

// A closed strip of 2 m triangles between two circles, in so many turns.
Triangulation strip(int m, double inner, double outer, int turns, double start) {
    Triangulation mesh;
    for (int i = 0; i < m; ++i) {
        const int next = (i + 1) % m;
        mesh.x.push_back(on_circle(inner, start + double(turns) * i / m));
        mesh.x.push_back(on_circle(outer, start + double(turns) * i / m));
        mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * next + 1});
        mesh.triangles.push_back({2 * i, 2 * next + 1, 2 * next});
    }
    return mesh;
}

Triangulation together(Triangulation one, const Triangulation& other) {
    const int first = static_cast<int>(one.x.size());
    one.x.insert(one.x.end(), other.x.begin(), other.x.end());
    for (const auto& [i, j, k] : other.triangles) one.triangles.push_back({first + i, first + j, first + k});
    return one;
}

// Two octagons over each other that have exchanged their lower halves along two paths between the nodes 0 and 1: who
// goes around one of these nodes comes to the other octagon. All triangles are sound, the boundary is two octagons.
Triangulation two_sheets(double inner, double outer, double start) {
    Triangulation mesh{{on_circle(0.5, start + 0.5), on_circle(0.5, start), on_circle(0.1, start + 0.25),
                        on_circle(0.1, start + 0.75)}, {}};
    for (const double radius : {outer, inner}) {
        const int above = radius == outer ? 2 : 3, below = 5 - above, first = static_cast<int>(mesh.x.size());
        for (int k = 0; k < 8; ++k) mesh.x.push_back(on_circle(radius, start + k / 8.0));
        const int centre[9] = {1, above, above, 0, 0, below, below, 1, 1};  // of the side from k to k + 1
        for (int k = 0; k < 8; ++k) {
            const int i = first + k, j = first + (k + 1) % 8;
            mesh.triangles.push_back({centre[k], i, j});
            if (centre[k] != centre[k + 1]) mesh.triangles.push_back({centre[k], j, centre[k + 1]});
        }
    }
    return mesh;
}

// Rows of squares cut in two, its nodes moved.
Triangulation grid(int m, int n, int spacing, int moved) {
    Triangulation mesh;
    const auto id = [&](int i, int j) { return i + (m + 1) * j; };
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= m; ++i) {
            const Point off = small_point(moved);
            mesh.x.push_back({i * spacing + off[0], j * spacing + off[1]});
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < m; ++i) {
            mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    return mesh;
}

void leave_out(Triangulation& mesh, int count) {
    random_inputs().shuffle(mesh.triangles);
    mesh.triangles.resize(std::max(2, static_cast<int>(mesh.triangles.size()) - count));
}

// Other numbers for the nodes, another order of triangles, another first node in each.
Triangulation shuffled(const Triangulation& mesh) {
    Random& random = random_inputs();
    std::vector<int> place(mesh.x.size());
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
    random.shuffle(place);
    Triangulation other{std::vector<Point>(place.size()), {}};
    for (std::size_t i = 0; i < place.size(); ++i) other.x[place[i]] = mesh.x[i];
    for (const Triangle& t : mesh.triangles) {
        const int k = random.integer(0, 2);
        other.triangles.push_back({place[t[k]], place[t[(k + 1) % 3]], place[t[(k + 2) % 3]]});
    }
    random.shuffle(other.triangles);
    return other;
}

std::map<Edge, int> sides_of(const std::vector<Triangle>& triangles) {
    std::map<Edge, int> count;
    for (const auto& [i, j, k] : triangles) ++count[{i, j}], ++count[{j, k}], ++count[{k, i}];
    return count;
}

std::vector<Edge> boundary_of(const std::vector<Triangle>& triangles) {
    const std::map<Edge, int> sides = sides_of(triangles);
    std::vector<Edge> boundary;
    for (const auto& [side, count] : sides)
        if (!sides.count({side[1], side[0]})) boundary.push_back(side);
    return boundary;
}

// ------------------------------------------------------------------------------------------------------------ 13.3

void expect_boundary(const Triangulation& mesh, const std::string& what) {
    const std::vector<Edge> expected = boundary_of(mesh.triangles);
    std::vector<Edge> found = boundary_edges(mesh.triangles);
    expect(found.size() == expected.size(), what, " has ", expected.size(), " edges on its boundary, the answer has ",
           found.size(), ": those of which only one triangle has both nodes");
    std::sort(found.begin(), found.end());
    for (const auto& [i, j] : found)
        expect(std::binary_search(expected.begin(), expected.end(), Edge{i, j}), "the edge from ", i, " to ", j, " of ",
               what, std::binary_search(expected.begin(), expected.end(), Edge{j, i})
                         ? " goes the other way: the triangle is on its left, as its nodes have it"
                         : " is not on the boundary");
    expect(std::adjacent_find(found.begin(), found.end()) == found.end(), "an edge of ", what, " is there twice");
}

void expect_refused(const std::vector<Triangle>& triangles, const std::string& what) {
    expect(boundary_edges(triangles).empty(), what, ": the answer has edges, expected none");
}

EXERCISE("13.3", "the edges of a boundary") {
    Random& random = random_inputs();
    for (int k = 0; k < 12; ++k) {
        Triangulation mesh = k % 3 == 0   ? strip(random.integer(5, 9), 1, 2, 1 + k % 2, 0)
                             : k % 3 == 1 ? grid(random.integer(1, 5), random.integer(1, 5), 10, 0)
                                          : together(fan(random.integer(3, 8), 1, 1, 0), two_sheets(1, 2, 0));
        if (k > 5) leave_out(mesh, random.integer(1, 4));
        mesh = shuffled(mesh);
        expect_boundary(mesh, "a mesh");
        const int step = 65536 * (32767 / static_cast<int>(mesh.x.size()));
        for (Triangle& t : mesh.triangles)
            for (int& i : t) i = 7 + step * i;
        expect_boundary(mesh, "a mesh with large numbers of nodes");
        std::vector<Triangle> wrong = mesh.triangles;
        const auto [i, j, l] = wrong[random.integer(0, static_cast<int>(wrong.size()) - 1)];
        wrong.push_back({j, l, i});
        expect_refused(wrong, "a triangle is there twice");
        wrong.back() = {0, i, j};
        random.shuffle(wrong);
        expect_refused(wrong, "two triangles are on the same side of an edge");
    }
    expect_refused({{1, 2, 3}, {2, 1, 4}, {2, 1, 5}}, "three triangles have the edge of the nodes 1 and 2");
    expect_refused({{1, 2, 3}, {1, 2, 4}}, "two triangles are on the same side of the edge from 1 to 2");
    expect_refused({{1, 2, 3}, {2, 1, 4}, {1, 2, 5}, {2, 1, 6}}, "four triangles have the edge of the nodes 1 and 2");
    const Triangulation large = shuffled(grid(120, 120, 10, 0));
    expect_soon("28800 triangles take more than five seconds");
    expect_boundary(large, "a mesh of 28800 triangles");
}

// ------------------------------------------------------------------------------------------------------------ 13.4

// How often closed curves with small coordinates wind around y, by the sum of their angles.
int winding(const std::vector<Segment>& curves, const Point& y) {
    double sum = 0;
    for (const auto& [a, b] : curves) {
        const Point u = minus(a, y), v = minus(b, y);
        sum += std::atan2(double(cross(u, v)), double(u[0] * v[0] + u[1] * v[1]));
    }
    return static_cast<int>(std::lround(sum / (2 * std::numbers::pi)));
}

// Curves around a centre in several turns, counter-clockwise, and some clockwise: the boundaries of bodies and holes.
std::vector<Segment> random_curves() {
    Random& random = random_inputs();
    std::vector<Segment> curves;
    for (int curve = random.integer(1, 3); curve > 0; --curve) {
        const int m = random.integer(3, 9), turns = m > 6 ? random.integer(1, 2) : 1;
        std::vector<Point> p;
        for (int i = 0; i < m; ++i) {
            const double radius = random.uniform(2, 9), angle = 2 * std::numbers::pi * turns * i / m;
            p.push_back({std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))});
        }
        if (random.integer(0, 3) == 0) std::reverse(p.begin(), p.end());
        for (int i = 0; i < m; ++i)
            if (p[i] != p[(i + 1) % m]) curves.push_back({p[i], p[(i + 1) % m]});
    }
    random.shuffle(curves);
    return curves;
}

// Where y is not on the curves.
void expect_covered(std::vector<Segment> curves, const Point& y, const Map& map, bool is_thin) {
    const bool is_on = std::any_of(curves.begin(), curves.end(),
                                   [&](const Segment& s) { return in_common(s, {y, y}); });
    if (is_on) return;
    const int expected = winding(curves, y);
    for (Segment& s : curves) s = map(s);
    const bool is_level = std::any_of(curves.begin(), curves.end(),
                                      [&](const Segment& s) { return s[0][1] == map(y)[1]; });
    const int found = cover_number(curves, map(y));
    expect(found == expected, "the ", curves.size(), " edges of closed curves cover the point ", text_of(map(y)), " ",
           found, " times, expected ", expected, is_level ? ": nodes are at the height of the point" : "",
           is_thin ? ": they are those of small curves, mapped so that they are long and thin" : "");
}

EXERCISE("13.4", "how often a point is covered") {
    Random& random = random_inputs();
    const std::vector<Segment> square = {
        {{{0, 0}, {4, 0}}}, {{{4, 0}, {4, 4}}}, {{{4, 4}, {0, 4}}}, {{{0, 4}, {0, 0}}}};
    for (const auto& [y, expected] : {std::pair(Point{2, 2}, 1), std::pair(Point{5, 2}, 0), std::pair(Point{-3, 4}, 0),
                                      std::pair(Point{-3, 0}, 0), std::pair(Point{9, 4}, 0)}) {
        const int found = cover_number(square, y);
        expect(found == expected, "the square (0, 4) x (0, 4) covers ", text_of(y), " ", found, " times, expected ",
               expected);
    }
    for (int k = 0; k < 150; ++k) {
        const std::vector<Segment> curves = random_curves();
        Point y = small_point(9);
        if (random.integer(0, 1)) y[1] = curves[0][0][1];  // at the height of a node
        expect_covered(curves, y, k % 3 == 0 ? Map{} : k % 3 == 1 ? Map::shifted(58) : Map::random(4, 58), k % 3 == 2);
    }
    for (int k = 0; k < 40; ++k) {
        const Point a = small_point(2), b = small_point(2), c = small_point(2);
        const std::vector<Segment> triangle = {{{a, b}}, {{b, c}}, {{c, a}}};
        const Point y = small_point(2);
        expect_covered(triangle, y, Map::largest(2), true);
    }
}

// ------------------------------------------------------------------------------------------------------------ 13.5

// Whether no two triangles have inner points in common: then the line of a side separates them.
bool overlap(const Triangulation& mesh, const Triangle& s, const Triangle& t) {
    for (const auto& [one, two] : {std::pair(s, t), std::pair(t, s)})
        for (int k = 0; k < 3; ++k) {
            const Point &a = mesh.x[one[k]], &b = mesh.x[one[(k + 1) % 3]];
            const bool is_beyond = std::all_of(two.begin(), two.end(), [&](int i) {
                return cross(minus(b, a), minus(mesh.x[i], a)) <= 0;
            });
            if (is_beyond) return false;
        }
    return true;
}

// "" where the certificate holds, or what is wrong.
std::string fault_of(const Triangulation& mesh) {
    for (const auto& [i, j, k] : mesh.triangles)
        if (cross(minus(mesh.x[j], mesh.x[i]), minus(mesh.x[k], mesh.x[i])) <= 0)
            return "a triangle is flat or goes around clockwise";
    for (const auto& [side, count] : sides_of(mesh.triangles))
        if (count > 1) return "two triangles are on the same side of an edge";
    const std::vector<Edge> boundary = boundary_of(mesh.triangles);
    for (std::size_t i = 0; i < boundary.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const Edge &e = boundary[i], &f = boundary[j];
            const auto at = [&](const Edge& edge) { return Segment{mesh.x[edge[0]], mesh.x[edge[1]]}; };
            const auto shared = std::find_first_of(e.begin(), e.end(), f.begin(), f.end());
            if (shared == e.end()) {
                if (in_common(at(e), at(f))) return "two edges of the boundary meet away from a common node";
                continue;
            }
            const Point p = mesh.x[*shared];
            const Point u = minus(mesh.x[e[0] == *shared ? e[1] : e[0]], p);
            const Point v = minus(mesh.x[f[0] == *shared ? f[1] : f[0]], p);
            if (cross(u, v) == 0 && Wide(u[0]) * v[0] + Wide(u[1]) * v[1] > 0)
                return "two edges of the boundary go the same way from a common node";
        }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (overlap(mesh, mesh.triangles[i], mesh.triangles[j]))
                return "points just inside of an edge of the boundary are covered more than once";
    return "";
}

void expect_certificate(const Triangulation& given, const std::string& what, int bits = 0) {
    Triangulation mesh = shuffled(given);
    const std::string fault = fault_of(mesh);
    if (bits > 0) {
        const Map map = Map::random(23, bits);
        for (Point& p : mesh.x) p = map(p);
    }
    const bool found = proved_injective(mesh);
    expect(found || !fault.empty(), what, ", ", mesh.triangles.size(), " triangles: not proved, but all holds",
           bits > 0 ? " (coordinates are large: in exact arithmetic it does)" : "");
    expect(!found || fault.empty(), what, ", ", mesh.triangles.size(), " triangles: proved, but ", fault,
           bits > 0 ? " (coordinates are large)" : "");
}

// A square with the square (1, 1) to (3, 3) left out, in units of 2^10; a triangle in the hole, its corner `gap` beyond
// the hole's right edge, not in its middle.
Triangulation touching(int gap) {
    Triangulation mesh = grid(4, 4, 1 << 10, 0);
    std::vector<Triangle> kept;
    for (int k = 0; k < 32; ++k)
        if (const int i = k / 2 % 4, j = k / 8; i < 1 || i > 2 || j < 1 || j > 2) kept.push_back(mesh.triangles[k]);
    mesh.triangles = kept;
    const int height = random_inputs().integer(1100, 2900);
    return together(mesh, {{{1500, 1500}, {3072 + gap, height}, {1500, 2500}}, {{0, 1, 2}}});
}

EXERCISE("13.5", "the certificate of a mesh") {
    Random& random = random_inputs();
    expect_certificate({{{0, 0}, {4, 0}, {0, 4}}, {{0, 1, 2}}}, "one triangle");
    expect_certificate({{{0, 0}, {4, 0}, {0, 4}}, {{0, 2, 1}}}, "a triangle turned over");
    expect_certificate({{{0, 0}, {4, 0}, {8, 0}}, {{0, 1, 2}}}, "a flat triangle");
    for (const int off : {-1, 0, 1})  // the third is flat, one unit to either side of that
        expect_certificate({{{0, 0}, {400, 0}, {400, 400}, {0, 400}, {200, 200 + off}},
                            {{0, 1, 2}, {0, 4, 3}, {0, 2, 4}, {4, 2, 3}}},
                           "a square with a triangle as flat as can be");
    for (int k = 0; k < 4; ++k) {
        const double start = random.uniform(0, 1);
        const double margin = random.scale(1e-5, 0.02);  // of ten units and more
        const int m = random.integer(5, 9), bits = k % 2 ? 57 : 0;
        expect_certificate(strip(m, 1, 2, 1, start), "a ring", bits);
        expect_certificate(strip(2 * m + 1, 1, 2, 2, start), "a strip that goes around a ring twice", bits);
        expect_certificate(fan(m, 1, 1, start), "a disc", bits);
        expect_certificate(fan(2 * m + 1, 1, 2, start), "a fan that goes around its vertex twice", bits);
        expect_certificate(two_sheets(1, 2, start), "two discs that are joined crosswise", bits);
        const Triangulation ring = strip(m + 4, 1, 2, 1, start);
        const auto disc = [&](int sides, double radius) { return fan(sides, radius, 1, start); };
        expect_certificate(together(ring, disc(m, 0.5)), "a disc in the hole of a ring", bits);
        const Triangulation narrow = strip(m + 3, 0.25, 2, 1, start);
        expect_certificate(together(disc(m, 0.5), narrow), "a disc over a hole", bits);
        expect_certificate(together(disc(m, 0.5), disc(m + 1, 2)), "a disc within a disc", bits);
        expect_certificate(together(disc(m, 2.5), ring), "a disc around a ring", bits);
        expect_certificate(together(ring, disc(m + 4, 1 + margin)), "a disc slightly larger than its hole", bits);
        expect_certificate(together(ring, disc(m + 4, 1 - margin)), "a disc slightly smaller than its hole", bits);
        expect_certificate(together(ring, disc(m + 4, 1)), "a disc as large as its hole, not joined", bits);
        for (const int gap : {-1, 0, 1})
            expect_certificate(touching(gap), "a corner one unit from an edge, or on it", bits);
    }
    // A node on an edge of another triangle; edges over each other, from a common node and not.
    expect_certificate({{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {4, -4}}, {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}}},
                       "a hanging node");
    expect_certificate({{{0, 0}, {4, 0}, {2, 4}, {6, 0}, {2, -4}}, {{0, 1, 2}, {4, 3, 0}}},
                       "two triangles whose edges lie over each other");
    expect_certificate({{{0, 0}, {4, 0}, {2, 4}, {-2, -4}, {3, -5}}, {{0, 1, 2}, {0, 3, 4}}},
                       "two triangles with a common corner");
    expect_certificate({{{0, 0}, {4, 0}, {2, 4}, {-2, -4}, {3, -5}, {0, 0}}, {{0, 1, 2}, {5, 3, 4}}},
                       "two triangles with corners at the same place, which are two nodes");
    expect_certificate({{{0, 0}, {8, 0}, {0, 8}, {3, 1}, {1, 3}}, {{0, 1, 2}, {0, 3, 4}}},
                       "a triangle within another, with a common corner");
    expect_certificate({{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}, {0, 0}, {0, 0}, {2, -2}, {2, 2}},
                        {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {5, 6, 7}}},
                       "a triangle over a square, with no node inside of another triangle");
    expect_certificate({{{0, 0}, {4, 0}, {2, 4}, {2, -4}, {1, 2}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}},
                       "three triangles at an edge");
    for (int k = 0; k < 60; ++k) {
        const int spacing = k % 2 ? 4 : 1000;  // of 4: flat triangles and edges that touch are common
        const int moved = spacing * random.integer(1, 5) / 10;
        Triangulation mesh = grid(random.integer(1, 4), random.integer(1, 4), spacing, moved);
        leave_out(mesh, random.integer(0, 8));
        if (random.integer(0, 3) == 0) {
            Triangulation other = fan(random.integer(3, 6), 2e-4 * random.uniform(0.2, 1), 1, 0);
            for (Point& p : other.x) p = {p[0] + 2 * spacing, p[1] + spacing};
            mesh = together(mesh, other);
        }
        expect_certificate(mesh, "a grid with triangles left out", k % 3 ? 0 : 57);
    }
}

// ------------------------------------------------------------------------------------------------------------ 13.6

struct Piece {
    std::array<std::array<Wide, 3>, 3> corner = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // barycentric, times scale
    Wide scale = 1;

    // The half that keeps corner a.
    Piece half(int a, int b) const {
        Piece piece = *this;
        piece.scale *= 2;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) piece.corner[i][k] = (i == b ? corner[a][k] : corner[i][k]) + corner[i][k];
        return piece;
    }
};

// det J = J_u x J_v as the derivatives of the six Lagrange functions at a corner, without control points; polarised it
// gives the coefficients p_i' Q p_j.
struct Determinant {
    QuadraticTriangle x;

    // Derivatives by l_1 and l_2 at p / scale, times scale.
    std::array<std::array<Wide, 2>, 2> at(const std::array<Wide, 3>& p, Wide scale) const {
        // N_i = l_i (2 l_i - 1), N_ij = 4 l_i l_j; a column for each of l_0, l_1, l_2.
        const Wide d[6][3] = {{4 * p[0] - scale, 0, 0}, {0, 4 * p[1] - scale, 0}, {0, 0, 4 * p[2] - scale},
                              {4 * p[1], 4 * p[0], 0},  {0, 4 * p[2], 4 * p[1]},  {4 * p[2], 0, 4 * p[0]}};
        std::array<std::array<Wide, 2>, 2> J{};
        for (int i = 0; i < 6; ++i)
            for (int direction = 0; direction < 2; ++direction)
                for (int k = 0; k < 2; ++k) J[direction][k] += (d[i][direction + 1] - d[i][0]) * x[i][k];
        return J;
    }

    bool is_positive(const Piece& piece) const {
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) {
                const auto J = at(piece.corner[i], piece.scale), K = at(piece.corner[j], piece.scale);
                if (J[0][0] * K[1][1] - J[0][1] * K[1][0] + K[0][0] * J[1][1] - K[0][1] * J[1][0] <= 0) return false;
            }
        return true;
    }
};

// Whether the tree is one, and proves it.
bool is_proof(const Determinant& det, const std::string& tree, std::size_t& at, const Piece& piece, int depth) {
    if (at < tree.size() && tree[at] == '.') return ++at, det.is_positive(piece);
    if (at + 1 >= tree.size() || depth == 25) return false;
    const std::string edge = tree.substr(at, 2);
    if (edge.find_first_not_of("012") != std::string::npos || edge[0] == edge[1]) return false;
    const int a = edge[0] - '0', b = edge[1] - '0';
    at += 2;
    return is_proof(det, tree, at, piece.half(a, b), depth + 1) && is_proof(det, tree, at, piece.half(b, a), depth + 1);
}

bool is_proof(const QuadraticTriangle& x, const std::string& tree) {
    std::size_t at = 0;
    return is_proof({x}, tree, at, {}, 0) && at == tree.size();
}

// A proof by bisection, at the longest edge or at any; "" where there is none with few pieces.
std::string proof_of(const Determinant& det, const Piece& piece, int depth) {
    if (det.is_positive(piece)) return ".";
    if (depth == 10) return "";
    Random& random = random_inputs();
    int edge = random.integer(0, 2);
    if (random.integer(0, 3)) {
        Wide longest = -1;
        for (int k = 0; k < 3; ++k) {
            Wide length = 0;
            for (int i = 0; i < 3; ++i) {
                const Wide d = piece.corner[k][i] - piece.corner[(k + 1) % 3][i];
                length += d * d;
            }
            if (length > longest) longest = length, edge = k;
        }
    }
    int a = edge, b = (edge + 1) % 3;
    if (random.integer(0, 1)) std::swap(a, b);
    const std::string first = proof_of(det, piece.half(a, b), depth + 1);
    const std::string second = first.empty() ? "" : proof_of(det, piece.half(b, a), depth + 1);
    return second.empty() ? "" : concat(a, b, first, second);
}

// Edge nodes up to `bend` of an edge away from the middles of the straight ones.
QuadraticTriangle random_triangle(double bend, int bits) {
    Random& random = random_inputs();
    const double size = std::ldexp(1.0, bits - 2), angle = random.uniform(0, 7);
    QuadraticTriangle x;
    double p[3][2];
    for (int i = 0; i < 3; ++i) {
        const double turn = angle + 2 * std::numbers::pi / 3 * i + random.uniform(-0.4, 0.4);
        p[i][0] = size * std::cos(turn);
        p[i][1] = size * std::sin(turn);
    }
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 2; ++k)
            x[i][k] = std::llround(i < 3 ? p[i][k] : 0.5 * (p[i - 3][k] + p[(i - 2) % 3][k]) +
                                                         random.uniform(-bend, bend) * size);
    return x;
}

// One with a proof that bisects.
std::pair<QuadraticTriangle, std::string> proved_triangle(int bits) {
    for (;;) {
        const QuadraticTriangle x = random_triangle(0.35, bits);
        const std::string tree = proof_of({x}, {}, 0);
        if (tree.size() > 1) return {x, tree};
    }
}

void expect_tree(const QuadraticTriangle& x, const std::string& tree, const std::string& what) {
    const bool expected = is_proof(x, tree), found = proves_positive(x, tree);
    std::string nodes;
    for (const Point& p : x) nodes += " " + text_of(p);
    expect(found == expected, "the tree `", tree.substr(0, 60), "`, ", what, ", of the triangle with the nodes", nodes,
           expected ? " is a proof, the answer was no" : " proves nothing, the answer was yes");
}

std::string with_end(std::vector<std::string> lines) {
    lines.push_back(concat("end ", lines.size() + 1));
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

std::string hash_of(const std::string& text) {
    unsigned long long h = 0xcbf29ce484222325;
    for (const char c : text) h = 0x100000001b3 * (h ^ (c & 0xffu));
    std::string digits;
    for (int k = 60; k >= 0; k -= 4) digits += "0123456789abcdef"[h >> k & 15];
    return digits;
}

void expect_accepted(const CurvedMesh& mesh, const std::string& proof, bool expected, const std::string& what) {
    expect(accepts(mesh, proof) == expected, what, expected ? " is refused" : " is accepted", "; its lines: `",
           trim(proof.substr(0, 300)), "`");
}

// inputs/lessons/13-injectivity/bent.msh and the program's proof of it.
void check_the_programs_proof() {
    const std::string file = "inputs/lessons/13-injectivity/bent.msh", folder = "outputs/lessons/answers";
    const std::string written = folder + "/bent.proof";
    std::ostringstream text, proof;
    std::filesystem::create_directories(folder);
    test::almesh_with({"quality", file, "proof=" + written});
    text << std::ifstream(file).rdbuf();
    proof << std::ifstream(written).rdbuf();
    const QuadraticTriangle five = {{{0, 0}, {1000, 0}, {500, 1000}, {586, 344}, {750, 586}, {-51, 371}}};
    const QuadraticTriangle six = {{{1000, 0}, {1100, 1100}, {500, 1000}, {1050, 550}, {800, 1050}, {750, 586}}};
    const CurvedMesh mesh = {text.str(), {5, 6}, {five, six}};
    expect_accepted(mesh, proof.str(), true, "almesh's proof of " + file);
    expect_accepted({mesh.text, {6, 5}, {five, six}}, proof.str(), false, "almesh's proof for other elements");
    expect_accepted({mesh.text + " ", {5, 6}, {five, six}}, proof.str(), false, "almesh's proof of another file");
}

EXERCISE("13.6", "an hour: the checker of a proof") {
    Random& random = random_inputs();
    const QuadraticTriangle straight = {{{0, 0}, {4, 0}, {0, 4}, {2, 0}, {2, 2}, {0, 2}}};
    for (const std::string tree :
         {".", "", "01..", "21.02..", "00..", "03..", "01.", "01...", "0", "x", ". ", "10..\n"})
        expect_tree(straight, tree, "of a straight triangle");
    std::string deep = ".";
    for (int k = 1; k <= 26; ++k) {
        deep = (k % 2 ? "01" : "12") + deep + ".";
        if (k >= 25) expect_tree(straight, deep, concat(k, " bisections one inside the other"));
    }
    for (int k = 0; k < 16; ++k) {
        const auto [x, tree] = proved_triangle(random.integer(8, 30));
        expect_tree(x, tree, "found by bisection");
        std::string turned = tree, cut = tree, less = tree;
        const std::size_t leaf = tree.find('.', random.integer(0, static_cast<int>(tree.size()) - 1));
        std::swap(turned[0], turned[1]);  // the halves the other way round
        expect_tree(x, turned, "its first bisection the other way round");
        expect_tree(x, ".", "no bisection");
        expect_tree(x, less.replace(tree.find("..") - 2, 4, "."), "a bisection too few");
        expect_tree(x, cut.replace(leaf, 1, "20.12.."), "a leaf cut again");
        const auto [of_other, other] = proved_triangle(random.integer(8, 30));
        expect_tree(x, other, "that of another triangle");
        const QuadraticTriangle bad = random_triangle(0.9, random.integer(8, 30));
        expect_tree(bad, tree, "that of another triangle");
    }
    for (const int area : {-1, 0, 1, 1, 1, 1}) {  // long straight sides: all coefficients are equal
        auto [u, v] = nearly_parallel(28);
        if (area < 0) std::swap(u, v);
        if (area == 0) v = {-u[0], -u[1]};
        QuadraticTriangle x;
        for (int k = 0; k < 2; ++k) {
            const long long first = many_bits(29), corner[3] = {first, first + 2 * u[k], first + 2 * v[k]};
            for (int i = 0; i < 3; ++i) x[i][k] = corner[i], x[3 + i][k] = (corner[i] + corner[(i + 1) % 3]) / 2;
        }
        expect_tree(x, ".", concat("with straight sides and twice the area ", 4 * area));
    }
    const QuadraticTriangle quarter = {{{0, 0}, {8, 0}, {0, 8}, {2, 0}, {4, 4}, {0, 4}}};  // det J = 0 at a vertex
    for (const std::string tree : {".", "01..", "0101..."}) expect_tree(quarter, tree, "with det J = 0 at a vertex");
    CurvedMesh mesh{"a mesh \xc3\xa9\n", {}, {}};
    std::vector<std::string> lines = {"almesh proof 1", "version almesh 0.2.0", "hash " + hash_of(mesh.text), ""};
    for (int e = 0; e < 3; ++e) {
        const auto [x, tree] = proved_triangle(20);
        mesh.id.push_back(10 + 7 * e + random.integer(0, 5));
        mesh.elements.push_back(x);
        lines.push_back(concat("element ", mesh.id[e], " ", tree));
    }
    mesh.id.push_back(1);
    mesh.elements.push_back(straight);
    lines[3] = "elements 4";
    const std::vector<std::string> good = lines;
    expect_accepted(mesh, with_end(good), true, "a sound proof");
    std::swap(lines[4], lines[6]);
    expect_accepted(mesh, with_end(lines), true, "a sound proof with its lines in another order");
    lines.push_back("element 1 01..");
    expect_accepted(mesh, with_end(lines), true, "a sound proof with a bisection too many");
    const auto refused = [&](const std::string& what, const auto& change) {
        std::vector<std::string> bad = good;
        change(bad);
        expect_accepted(mesh, with_end(bad), false, what);
    };
    refused("a proof without a line that an element needs", [](auto& l) { l.pop_back(); });
    refused("a proof with a line twice", [](auto& l) { l.push_back(l.back()); });
    refused("a proof of an element that is not there", [](auto& l) { l.push_back("element 999 ."); });
    refused("a proof of another file", [](auto& l) { l[2].back() = l[2].back() == '0' ? '1' : '0'; });
    refused("a proof of more elements", [](auto& l) { l[3] = "elements 5"; });
    refused("a proof with a line that is no claim", [](auto& l) { l.push_back("all is well"); });
    refused("a proof with an empty line", [](auto& l) { l.push_back(""); });
    refused("a proof of another format", [](auto& l) { l[0] = "almesh proof 2"; });
    refused("a proof with a claim cut off", [](auto& l) { l[5].pop_back(); });
    refused("a proof whose head is in another order", [](auto& l) { std::swap(l[2], l[3]); });
    const std::string whole = with_end(good);
    expect_accepted(mesh, whole.substr(0, whole.size() - 1), false, "a proof without its last newline");
    expect_accepted(mesh, whole + "\n", false, "a proof with a line behind its end");
    expect_accepted(mesh, whole.substr(0, whole.rfind("end")), false, "a proof without its end");
    expect_accepted(mesh, "", false, "an empty file");
    const CurvedMesh plain{"straight\n", {3}, {straight}};
    const std::string without_trees =
        with_end({"almesh proof 1", "version almesh 0.2.0", "hash " + hash_of(plain.text), "elements 1"});
    expect_accepted(plain, without_trees, true, "a proof whose element has no line, which has the tree `.`,");
    CurvedMesh other = mesh;
    other.elements.back() = {{{0, 0}, {0, 4}, {4, 0}, {0, 2}, {2, 2}, {2, 0}}};
    expect_accepted(other, whole, false, "a proof of a mesh with an inverted element");
    check_the_programs_proof();
}

}  // namespace
}  // namespace almesh::lessons
