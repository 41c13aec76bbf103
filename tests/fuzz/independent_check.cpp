// With t_v the barycentric coordinates of a point and a the multi-index of a node, its basis function is
//
//     N_a(t) = prod_v P(a_v, t_v),   P(m, t) = prod_{k < m} (p t - k) / (k + 1)      (Silvester 1969)
#include "fuzz/independent_check.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "mesh/cells.hpp"

namespace almesh::fuzz {
namespace {

using Barycentric = std::array<long double, 4>;
using Matrix = std::array<Point, 3>;  // of columns

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
long double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// All basis functions at a point, and their derivatives with respect to t_1, t_2, t_3, t_0 making up the sum of 1.
struct Shape {
    std::vector<long double> value;
    std::vector<Point> slope;

    Shape(int dim, int degree, const std::vector<MultiIndex>& order, const Barycentric& t) {
        std::array<std::array<long double, max_degree + 1>, 4> P{}, dP{};  // P(m, t_v) and its derivative
        for (int v = 0; v <= dim; ++v) {
            P[v][0] = 1;
            for (int m = 0; m < degree; ++m) {
                P[v][m + 1] = P[v][m] * (degree * t[v] - m) / (m + 1);
                dP[v][m + 1] = (dP[v][m] * (degree * t[v] - m) + P[v][m] * degree) / (m + 1);
            }
        }
        for (const MultiIndex& a : order) {
            std::array<long double, 4> by{};  // derivative with respect to t_v alone
            long double product = 1;
            for (int v = 0; v <= dim; ++v) product *= P[v][a[v]];
            for (int v = 0; v <= dim; ++v) {
                by[v] = dP[v][a[v]];
                for (int w = 0; w <= dim; ++w)
                    if (w != v) by[v] *= P[w][a[w]];
            }
            value.push_back(product);
            slope.push_back({by[1] - by[0], by[2] - by[0], by[3] - by[0]});
        }
    }

    Point at(const std::vector<Point>& x) const {
        Point y{};
        for (std::size_t i = 0; i < value.size(); ++i)
            for (int a = 0; a < 3; ++a) y[a] += value[i] * x[i][a];
        return y;
    }

    // In 2D the third column is the unit vector out of the plane. From differences of nodes, so that a mesh far from
    // the origin loses nothing.
    Matrix jacobian(int dim, const std::vector<Point>& x) const {
        Matrix J{};
        if (dim == 2) J[2] = {0, 0, 1};
        for (std::size_t i = 1; i < value.size(); ++i) {
            const Point edge = minus(x[i], x[0]);
            for (int k = 0; k < dim; ++k)
                for (int a = 0; a < dim; ++a) J[k][a] += slope[i][k] * edge[a];
        }
        return J;
    }
};

struct Cell {
    int dim, degree;
    std::vector<MultiIndex> order;

    explicit Cell(const Elements& elements)
        : dim(elements.dim), degree(elements.degree), order(gmsh_node_order(dim, degree)) {}
    Shape shape(const Barycentric& t) const { return {dim, degree, order, t}; }
};

long double determinant(const Matrix& J) { return dot(J[0], cross(J[1], J[2])); }

// Points with multiples of 1 / parts as coordinates.
std::vector<Barycentric> lattice(int dim, int parts) {
    std::vector<Barycentric> points;
    for (int i = 0; i <= parts; ++i)
        for (int j = 0; i + j <= parts; ++j)
            for (int k = 0; i + j + k <= (dim == 3 ? parts : i + j); ++k)
                points.push_back({static_cast<long double>(parts - i - j - k) / parts,
                                  static_cast<long double>(i) / parts, static_cast<long double>(j) / parts,
                                  static_cast<long double>(k) / parts});
    return points;
}

// Newton's method for y in the element, from its centre; whether y is clearly inside.
bool contains(const Cell& cell, const std::vector<Point>& x, const Point& y) {
    constexpr long double margin = 1e-6L;
    Barycentric t{};
    for (int v = 0; v <= cell.dim; ++v) t[v] = 1.0L / (cell.dim + 1);
    long double step = 1;
    for (int k = 0; k < 30 && step > 1e-12L; ++k) {
        const Shape shape = cell.shape(t);
        const Matrix J = shape.jacobian(cell.dim, x);
        const long double det = determinant(J);
        if (det == 0) return false;
        const Point r = minus(y, shape.at(x));
        const Point d = {dot(r, cross(J[1], J[2])) / det, dot(r, cross(J[2], J[0])) / det,
                         dot(r, cross(J[0], J[1])) / det};
        step = 0;
        for (int v = 1; v <= cell.dim; ++v) {
            step = std::max(step, std::abs(d[v - 1]));
            t[v] += d[v - 1];
            t[0] -= d[v - 1];
        }
        if (!(step < 4)) return false;
    }
    return step <= 1e-12L && *std::min_element(t.begin(), t.begin() + cell.dim + 1) > margin;
}

struct Bounds {
    Point low, high;

    // A little larger than the box of the nodes; what of a curved element is beyond that is not looked at.
    explicit Bounds(const std::vector<Point>& x) : low(x[0]), high(x[0]) {
        for (const Point& p : x)
            for (int a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
        for (int a = 0; a < 3; ++a) {
            const long double size = high[a] - low[a];
            low[a] -= size / 16;
            high[a] += size / 16;
        }
    }
    bool have(const Point& y) const {
        for (int a = 0; a < 3; ++a)
            if (y[a] < low[a] || y[a] > high[a]) return false;
        return true;
    }
};

std::string overlap_of(const Elements& elements, const Cell& cell) {
    const std::vector<Bounds> bounds(elements.x.begin(), elements.x.end());
    for (const Barycentric& t : lattice(cell.dim, cell.dim + 2)) {
        if (*std::min_element(t.begin(), t.begin() + cell.dim + 1) <= 0) continue;
        const Shape shape = cell.shape(t);
        for (std::size_t e = 0; e < elements.x.size(); ++e) {
            const Point y = shape.at(elements.x[e]);
            for (std::size_t other = 0; other < elements.x.size(); ++other)
                if (other != e && bounds[other].have(y) && contains(cell, elements.x[other], y))
                    return concat("elements ", e, " and ", other, " overlap");
        }
    }
    return "";
}

std::vector<int> vertices_in_order(std::vector<int> node, int count) {
    node.resize(count);
    std::sort(node.begin(), node.end());
    return node;
}

}  // namespace

Elements::Elements(const RawMesh& raw) {
    for (const RawElement& element : raw.elements) dim = std::max(dim, element.dim);
    struct Use {
        int count = 0;
        Side side;
    };
    std::map<std::vector<int>, Use> uses;
    for (const RawElement& element : raw.elements) {
        if (element.dim != dim) continue;
        degree = element.degree;
        std::vector<int> nodes;
        std::vector<Point> positions;
        for (int k = 0; k < simplex_node_count(dim, degree); ++k) {
            nodes.push_back(raw.element_nodes[element.first + k]);
            const double* const p = raw.nodes[nodes.back()].x;
            positions.push_back({p[0], p[1], dim == 3 ? p[2] : 0});
        }
        for (int v = 0; v <= dim; ++v) {
            std::vector<int> side(nodes.begin(), nodes.begin() + dim + 1);
            side.erase(side.begin() + v);
            Use& use = uses[vertices_in_order(side, dim)];
            ++use.count;
            use.side.node = side;
        }
        node.push_back(std::move(nodes));
        x.push_back(std::move(positions));
    }
    for (const RawElement& element : raw.elements) {
        if (element.dim != dim - 1 || element.physical == 0) continue;
        const int* const first = &raw.element_nodes[element.first];
        const std::vector<int> nodes(first, first + simplex_node_count(dim - 1, element.degree));
        if (const auto found = uses.find(vertices_in_order(nodes, dim)); found != uses.end())
            found->second.side = {nodes, group_name(raw.groups, dim - 1, element.physical)};
    }
    for (const auto& [vertices, use] : uses)
        if (use.count == 1) sides.push_back(use.side);
}

std::string fault_of(const Elements& elements, bool either_winding) {
    const Cell cell(elements);
    std::vector<Shape> shapes;
    const int parts = cell.degree == 1 ? 1 : 3 * cell.degree;
    for (const Barycentric& t : lattice(cell.dim, parts)) shapes.push_back(cell.shape(t));
    for (std::size_t e = 0; e < elements.x.size(); ++e) {
        const auto det = [&](const Shape& shape) { return determinant(shape.jacobian(cell.dim, elements.x[e])); };
        const bool negative = either_winding && det(shapes[0]) < 0;
        for (const Shape& shape : shapes)
            if (!(negative ? det(shape) < 0 : det(shape) > 0)) return concat("element ", e, " is inverted");
    }
    return overlap_of(elements, cell);
}

long double distance(const Point& y, const std::vector<Point>& corners) {
    long double least = INFINITY;
    const auto consider = [&](const Point& p) { least = std::min(least, std::sqrt(dot(minus(y, p), minus(y, p)))); };
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point& p = corners[i];
        consider(p);
        for (std::size_t j = 0; j < i; ++j) {
            const Point edge = minus(corners[j], p);
            const long double t = dot(minus(y, p), edge) / dot(edge, edge);
            if (t > 0 && t < 1) consider({p[0] + t * edge[0], p[1] + t * edge[1], p[2] + t * edge[2]});
        }
    }
    if (corners.size() < 3) return least;
    const Point u = minus(corners[1], corners[0]), v = minus(corners[2], corners[0]), w = minus(y, corners[0]);
    const Point normal = cross(u, v);
    const long double square = dot(normal, normal), s = dot(cross(w, v), normal) / square,
                      t = dot(cross(u, w), normal) / square;
    return s >= 0 && t >= 0 && s + t <= 1 ? std::abs(dot(w, normal)) / std::sqrt(square) : least;
}

}  // namespace almesh::fuzz
