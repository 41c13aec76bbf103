// Points and weights on simplices: either all permutations of the orbits of a symmetric rule, or the conical product of
// Gauss-Jacobi rules, x_0 = u_0, x_1 = (1 - u_0) u_1, x_2 = (1 - u_0)(1 - u_1) u_2 (Duffy's map), whose Jacobian
// (1 - u_0)^(n-1) (1 - u_1)^(n-2) is the weight of the rules in u_0 and u_1. Products of these on the other cells, on a
// pyramid (cells.hpp) with the weight (1 - c)^2.
#include "mesh/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/lagrange.hpp"
#include "mesh/quadrature_table.hpp"

namespace almesh {
namespace {

struct Line {
    std::vector<double> x, w;
};

// m-point Gauss rule on [0, 1] for the weight (1 - x)^alpha, alpha a small integer: Newton on the Jacobi polynomial
// P_m^(alpha,0), deflated by the roots already found (Karniadakis & Sherwin, app. B).
Line gauss_jacobi(int m, int alpha) {
    const auto jacobi = [m, alpha](double t, double& derivative) {  // on [-1, 1]
        const double a = alpha;
        double p0 = 1, p1 = 0.5 * (a + (a + 2) * t);
        if (m == 0) p1 = p0;
        for (int k = 1; k < m; ++k) {
            const double a1 = 2 * (k + 1) * (k + a + 1) * (2 * k + a), a2 = (2 * k + a + 1) * a * a,
                         a3 = (2 * k + a) * (2 * k + a + 1) * (2 * k + a + 2),
                         a4 = 2 * (k + a) * k * (2 * k + a + 2);
            const double p2 = ((a2 + a3 * t) * p1 - a4 * p0) / a1;
            p0 = p1;
            p1 = p2;
        }
        const double b1 = (2 * m + a) * (1 - t * t), b2 = m * (a - (2 * m + a) * t), b3 = 2.0 * (m + a) * m;
        derivative = (b2 * p1 + b3 * p0) / b1;
        return p1;
    };
    Line rule;
    std::vector<double> root;
    for (int k = 0; k < m; ++k) {
        double t = -std::cos((2 * k + 1) * std::numbers::pi / (2 * m));
        if (k) t = 0.5 * (t + root.back());
        double derivative = 1;
        for (int iteration = 0; iteration < 100; ++iteration) {
            const double p = jacobi(t, derivative);
            double deflation = 0;
            for (double r : root) deflation += 1 / (t - r);
            const double step = -p / (derivative - deflation * p);
            t += step;
            if (std::abs(step) < 1e-16) break;
        }
        jacobi(t, derivative);
        root.push_back(t);
        rule.x.push_back(0.5 * (1 + t));
        // On [-1, 1] the weight is 2^(alpha+1) / ((1 - t^2) P'^2); mapping to [0, 1] divides by 2^(alpha+1).
        rule.w.push_back(1 / ((1 - t * t) * derivative * derivative));
    }
    return rule;
}

Quadrature conical_product(int dim, int exactness) {
    const int m = exactness / 2 + 1;
    Quadrature q{dim, 1, {}, {}};
    std::vector<Line> line;
    for (int k = 0; k < dim; ++k) {
        line.push_back(gauss_jacobi(m, dim - 1 - k));
        q.count *= m;
    }
    for (int i = 0; i < q.count; ++i) {
        double weight = 1, rest = 1;
        for (int k = 0, index = i; k < dim; ++k, index /= m) {
            const double u = line[k].x[index % m];
            weight *= line[k].w[index % m];
            q.xi.push_back(rest * u);
            rest *= 1 - u;
        }
        q.weight.push_back(weight);
    }
    return q;
}

Quadrature rule_of(const Line& line) { return {1, static_cast<int>(line.x.size()), line.x, line.w}; }

// On the product of two cells, the points of the first one running fastest.
Quadrature product(const Quadrature& first, const Quadrature& second) {
    Quadrature q{first.dim + second.dim, first.count * second.count, {}, {}, first.count, second.count};
    for (int j = 0; j < second.count; ++j)
        for (int i = 0; i < first.count; ++i) {
            q.xi.insert(q.xi.end(), &first.xi[i * first.dim], &first.xi[i * first.dim] + first.dim);
            q.xi.insert(q.xi.end(), &second.xi[j * second.dim], &second.xi[j * second.dim] + second.dim);
            q.weight.push_back(first.weight[i] * second.weight[j]);
        }
    return q;
}

// Barycentric coordinates of one point, ascending.
std::vector<double> first_point(const Orbit& orbit) {
    const char last = orbit.pattern.back();
    const auto repeats = std::count(orbit.pattern.begin(), orbit.pattern.end(), last);
    double rest = 1;
    for (char letter : orbit.pattern)
        if (letter != last) rest -= orbit.free[letter - 'a'];
    std::vector<double> point;
    for (char letter : orbit.pattern)
        point.push_back(letter == last ? rest / static_cast<double>(repeats) : orbit.free[letter - 'a']);
    std::sort(point.begin(), point.end());
    return point;
}

Quadrature all_points(int dim, std::span<const Orbit> rule) {
    Quadrature q{dim, 0, {}, {}};
    for (const Orbit& orbit : rule) {
        std::vector<double> point = first_point(orbit);
        do {
            q.xi.insert(q.xi.end(), point.begin(), point.end() - 1);
            q.weight.push_back(orbit.weight * simplex(dim).volume());
        } while (std::next_permutation(point.begin(), point.end()));
    }
    q.count = static_cast<int>(q.weight.size());
    return q;
}

// Moves a small part of the weight to points at the nodes, so that the distortion is infinite where an element folds
// there.
void add_node_points(const LagrangeBasis& basis, Quadrature& quadrature) {
    constexpr double node_part = 0.001;
    double volume = 0;
    for (double& weight : quadrature.weight) {
        volume += weight;
        weight *= 1 - node_part;
    }
    const auto add = [&](const std::array<double, 3>& xi, double part_of_node) {
        quadrature.xi.insert(quadrature.xi.end(), xi.begin(), xi.begin() + basis.dim);
        quadrature.weight.push_back(part_of_node * node_part * volume / basis.count);
        ++quadrature.count;
    };
    for (int i = 0; i < basis.count; ++i) {
        const std::array<double, 3> xi = basis.point(i);
        const bool is_apex = basis.cell.is_collapsed && xi[2] == 1;
        if (is_apex && basis.degree == 1) continue;
        if (is_apex)  // from each of the edges that end there
            for (const auto& [a, b] : {std::array{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}}) add({a, b, 1}, 0.25);
        else add(xi, basis.cell.is_collapsed && basis.degree == 1 ? 1.25 : 1);
    }
}

// xi: R x dim and S x 1 coordinates of the points of the two rules.
ProductPoints product_points(const LagrangeBasis& base, const std::vector<double>& xi, const LagrangeBasis& line,
                             const std::vector<double>& eta) {
    ProductPoints product{static_cast<int>(xi.size()) / base.dim, static_cast<int>(eta.size()), {}, {}, {}};
    std::vector<double> value(std::max(base.count, line.count)), derivative(base.count * base.dim);
    for (int r = 0; r < product.of_base; ++r) {
        base.values(&xi[r * base.dim], value.data());
        base.gradients(&xi[r * base.dim], derivative.data());
        for (int b = 0; b < base.count; ++b) {
            const double* const of_node = &derivative[b * base.dim];
            product.base.insert(product.base.end(), of_node, of_node + base.dim);
            product.base.push_back(value[b]);
        }
    }
    for (const double& at : eta) {
        line.values(&at, value.data());
        line.gradients(&at, derivative.data());
        for (int z = 0; z < line.count; ++z) product.line.insert(product.line.end(), {value[z], derivative[z]});
    }
    return product;
}

void fill_products(const LagrangeBasis& basis, const Quadrature& rule, ReferenceElement& element) {
    if (rule.of_line == 0 || basis.cell.is_collapsed || basis.degree == 1) return;
    const int m = basis.dim - 1;
    const LagrangeBasis base(basis.cell.factors[2] == 0 ? simplex(m) : quadrilateral(), basis.degree);
    const LagrangeBasis line(1, basis.degree);
    std::vector<double> xi, eta;
    for (int r = 0; r < rule.of_base; ++r)
        xi.insert(xi.end(), &rule.xi[r * basis.dim], &rule.xi[r * basis.dim] + m);
    for (int s = 0; s < rule.of_line; ++s) eta.push_back(rule.xi[s * rule.of_base * basis.dim + m]);
    ProductPoints inside = product_points(base, xi, line, eta);
    for (int r = 0; r < rule.of_base; ++r)
        for (int s = 0; s < rule.of_line; ++s) inside.point.push_back(s * rule.of_base + r);
    element.products.push_back(std::move(inside));

    xi.clear(), eta.clear();
    for (int b = 0; b < base.count; ++b)
        for (int k = 0; k < m; ++k) xi.push_back(base.point(b)[k]);
    for (int z = 0; z < line.count; ++z) {
        eta.push_back(line.point(z)[0]);
        for (int b = 0; b < base.count; ++b) {
            MultiIndex node = base.nodes[b];
            std::copy_n(line.nodes[z].begin(), 2, node.begin() + base.cell.entries());
            element.product_node.push_back(basis.find(node));
        }
    }
    if (rule.count == rule.of_base * rule.of_line) return;
    ProductPoints at_nodes = product_points(base, xi, line, eta);
    for (int b = 0; b < base.count; ++b)
        for (int z = 0; z < line.count; ++z)
            at_nodes.point.push_back(rule.of_base * rule.of_line + element.product_node[z * base.count + b]);
    element.products.push_back(std::move(at_nodes));
}

}  // namespace

Quadrature simplex_quadrature(int dim, int exactness) {
    const std::span<const Orbit> rule = symmetric_rule(dim, exactness);
    return rule.empty() ? conical_product(dim, exactness) : all_points(dim, rule);
}

Quadrature cell_quadrature(const CellType& cell, int exactness, int to_apex) {
    if (cell.is_simplex()) return simplex_quadrature(cell.dim, exactness);
    const Quadrature line = rule_of(gauss_jacobi(exactness / 2 + 1, 0));
    if (cell.is_collapsed) return product(product(line, line), rule_of(gauss_jacobi(to_apex / 2 + 1, 2)));
    const Quadrature first = cell.factors[0] == 1 ? line : simplex_quadrature(cell.factors[0], exactness);
    const Quadrature both = product(first, line);
    return cell.factors[2] == 0 ? both : product(both, line);
}

int default_exactness(const CellType& cell, int degree) {
    return cell.is_simplex() && degree == 1 ? 0 : 2 * degree + 2;
}

Quadrature element_quadrature(const CellType& cell, int degree, int exactness) {
    const bool is_linear = cell.is_simplex() && degree == 1;
    if (exactness == 0 || is_linear) exactness = default_exactness(cell, degree);
    Quadrature quadrature = cell_quadrature(cell, exactness, degree == 1 ? 0 : exactness);
    if (!is_linear) add_node_points(LagrangeBasis(cell, degree), quadrature);
    return quadrature;
}

ReferenceElement reference_element(const CellType& cell, int degree, const Quadrature& quadrature) {
    const int dim = cell.dim;
    const LagrangeBasis basis(cell, degree);
    ReferenceElement element{&cell, degree, basis.count, quadrature.count, quadrature.weight, {}, {}, {}, {}};
    const std::size_t stride = offset(basis.count, dim);
    element.gradients.resize(stride * quadrature.count);
    std::vector<MultiIndex> powers;
    if (cell.is_simplex()) powers = gmsh_node_order(dim, 2 * degree - 2);
    for (int q = 0; q < quadrature.count; ++q) {
        const double* const xi = &quadrature.xi[q * dim];
        basis.gradients(xi, &element.gradients[stride * q]);
        double l[4] = {1};  // barycentric coordinates
        for (int k = 0; k < dim; ++k) {
            l[k + 1] = xi[k];
            l[0] -= xi[k];
        }
        for (const MultiIndex& a : powers) {
            double product = 1;
            for (int k = 0; k <= dim; ++k)
                for (int power = 0; power < a[k]; ++power) product *= l[k];
            element.monomials.push_back(product);
        }
    }
    fill_products(basis, quadrature, element);
    return element;
}

}  // namespace almesh
