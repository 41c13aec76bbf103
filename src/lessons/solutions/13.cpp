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

}  // namespace almesh::lessons
