// Solutions of the exercises of lesson 13.
#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "lessons/exercises/13.hpp"

namespace almesh::lessons {

namespace {

// Differences of coordinates are at most 2^61, products 2^122, their difference 2^123.
int turn(const Point& a, const Point& b, const Point& c) {
    const Wide det = Wide(b[0] - a[0]) * (c[1] - a[1]) - Wide(b[1] - a[1]) * (c[0] - a[0]);
    return (det > 0) - (det < 0);
}

bool is_on(const Point& p, const Segment& s) {
    if (turn(s[0], s[1], p) != 0) return false;
    for (int k = 0; k < 2; ++k)
        if (p[k] < std::min(s[0][k], s[1][k]) || p[k] > std::max(s[0][k], s[1][k])) return false;
    return true;
}

bool touch(const Segment& s, const Segment& t) {
    return is_on(t[0], s) || is_on(t[1], s) || is_on(s[0], t) || is_on(s[1], t);
}

bool cross(const Segment& s, const Segment& t) {
    return turn(s[0], s[1], t[0]) * turn(s[0], s[1], t[1]) < 0 && turn(t[0], t[1], s[0]) * turn(t[0], t[1], s[1]) < 0;
}

// Sides of triangles without one on the other side; none at all where a side is there twice, as it is where three
// triangles have an edge.
std::vector<Edge> open_sides(const std::vector<Triangle>& triangles) {
    std::set<Edge> sides;
    for (const Triangle& t : triangles)
        for (int k = 0; k < 3; ++k)
            if (!sides.insert({t[k], t[(k + 1) % 3]}).second) return {};
    std::vector<Edge> open;
    for (const auto& [i, j] : sides)
        if (!sides.count({j, i})) open.push_back({i, j});
    return open;
}

}  // namespace

int orientation(const Point& a, const Point& b, const Point& c) { return turn(a, b, c); }

bool have_common_point(const Segment& s, const Segment& t) { return touch(s, t) || cross(s, t); }

std::vector<Edge> boundary_edges(const std::vector<Triangle>& triangles) { return open_sides(triangles); }

int cover_number(const std::vector<Segment>& boundary, const Point& y) {
    int number = 0;  // edges that cross the ray from y to the right: upwards, less those downwards
    for (const auto& [a, b] : boundary) {
        const bool is_upward = a[1] <= y[1] && y[1] < b[1], is_downward = b[1] <= y[1] && y[1] < a[1];
        if (is_upward && turn(a, b, y) > 0) ++number;
        if (is_downward && turn(a, b, y) < 0) --number;
    }
    return number;
}

namespace {

// Whether two edges of the boundary have a point in common beside a node of both.
bool meet(const std::vector<Point>& x, const Edge& e, const Edge& f) {
    for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
            if (e[k] == f[l]) {
                const Point &p = x[e[k]], &of_e = x[e[1 - k]], &of_f = x[f[1 - l]];
                return is_on(of_e, {p, of_f}) || is_on(of_f, {p, of_e});
            }
    const Segment s = {x[e[0]], x[e[1]]}, t = {x[f[0]], x[f[1]]};
    return touch(s, t) || cross(s, t);
}

}  // namespace

bool proved_injective(const Triangulation& whole) {
    const auto& [x, triangles] = whole;
    for (const auto& [i, j, k] : triangles)
        if (turn(x[i], x[j], x[k]) <= 0) return false;
    const std::vector<Edge> boundary = open_sides(triangles);
    if (boundary.empty()) return false;
    for (std::size_t i = 0; i < boundary.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (meet(x, boundary[i], boundary[j])) return false;
    // No other part of the boundary goes through the middle of an edge. Points just inside of it are covered once if no
    // triangle but the edge's own has the middle.
    for (const Edge& e : boundary) {
        const Point middle = {x[e[0]][0] + x[e[1]][0], x[e[0]][1] + x[e[1]][1]};  // twice as large, and so are corners
        int holding = 0;
        for (const Triangle& t : triangles) {
            Point p[3];
            for (int k = 0; k < 3; ++k) p[k] = {2 * x[t[k]][0], 2 * x[t[k]][1]};
            const int side[3] = {turn(p[0], p[1], middle), turn(p[1], p[2], middle), turn(p[2], p[0], middle)};
            if (side[0] >= 0 && side[1] >= 0 && side[2] >= 0) ++holding;
        }
        if (holding != 1) return false;
    }
    return true;
}

namespace {

// det J = l' Q l, but for a positive factor: its Bernstein coefficients are the entries of Q.
using Form = std::array<std::array<Wide, 3>, 3>;

Form jacobian(const QuadraticTriangle& x) {
    std::array<Wide, 2> U[3], V[3];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 2; ++k) {
            const auto twice_P = [&](int j) -> Wide {
                const int node = i + j == 1 ? 3 : i + j == 3 ? 4 : 5;
                return i == j ? 2 * x[i][k] : 4 * x[node][k] - x[i][k] - x[j][k];
            };
            U[i][k] = twice_P(1) - twice_P(0);
            V[i][k] = twice_P(2) - twice_P(0);
        }
    const auto det = [&](int i, int j) { return U[i][0] * V[j][1] - U[i][1] * V[j][0]; };
    Form Q;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) Q[i][j] = det(i, j) + det(j, i);
    return Q;
}

// On the half that keeps corner a, the middle of the edge in place of corner b; four times as large.
Form half(const Form& Q, int a, int b) {
    Form rows, both;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) rows[i][j] = i == b ? Q[a][j] + Q[b][j] : 2 * Q[i][j];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) both[i][j] = j == b ? rows[i][a] + rows[i][b] : 2 * rows[i][j];
    return both;
}

// Whether the tree that begins at `at` proves that Q is positive; `at` is then behind it.
bool holds(const Form& Q, const std::string& tree, std::size_t& at, int depth) {
    if (at >= tree.size()) return false;
    if (tree[at] == '.') {
        ++at;
        return std::all_of(Q.begin(), Q.end(), [](const auto& row) { return row[0] > 0 && row[1] > 0 && row[2] > 0; });
    }
    if (depth == 25 || at + 1 >= tree.size()) return false;
    const int a = tree[at] - '0', b = tree[at + 1] - '0';
    if (a < 0 || a > 2 || b < 0 || b > 2 || a == b) return false;
    at += 2;
    return holds(half(Q, a, b), tree, at, depth + 1) && holds(half(Q, b, a), tree, at, depth + 1);
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text)
        if (c == '\n') lines.emplace_back();
        else lines.back() += c;
    return lines;
}

std::string hash(const std::string& text) {
    unsigned long long h = 14695981039346656037u;
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", h);
    return digits;
}

}  // namespace

bool proves_positive(const QuadraticTriangle& x, const std::string& tree) {
    std::size_t at = 0;
    return holds(jacobian(x), tree, at, 0) && at == tree.size();
}

bool accepts(const CurvedMesh& curved, const std::string& proof) {
    const std::vector<std::string> lines = lines_of(proof);  // the last one is what follows the last newline
    const std::size_t count = lines.size() - 1;
    if (count < 5 || !lines[count].empty() || lines[count - 1] != "end " + std::to_string(count)) return false;
    if (lines[0] != "almesh proof 1" || lines[1].rfind("version ", 0) != 0) return false;
    if (lines[2] != "hash " + hash(curved.text)) return false;
    if (lines[3] != "elements " + std::to_string(curved.elements.size())) return false;
    std::map<std::string, std::string> tree;
    for (const long long id : curved.id) tree["element " + std::to_string(id)] = "";
    for (std::size_t k = 4; k + 1 < count; ++k) {
        const std::size_t blank = std::min(lines[k].rfind(' '), lines[k].size());
        const auto of = tree.find(lines[k].substr(0, blank));
        if (of == tree.end() || !of->second.empty()) return false;
        of->second = lines[k].substr(blank);
    }
    for (std::size_t e = 0; e < curved.elements.size(); ++e) {
        const std::string& said = tree["element " + std::to_string(curved.id[e])];
        if (!proves_positive(curved.elements[e], said.empty() ? "." : said.substr(1))) return false;
    }
    return true;
}

}  // namespace almesh::lessons
