// The certificate beside dense samples of the determinant, for random elements of each cell and degree, many of them
// nearly degenerate. ALMESH_ELEMENTS=10000 takes so many of each (`make certificates`).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "check/certificate.hpp"
#include "geometry/element_jacobian.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/quadrature.hpp"

using namespace almesh;

namespace {

using Point = std::array<double, 3>;

// From the unit cube to the reference cell.
Point in_cell(const CellType& cell, Point u) {
    const int m = cell.factors[0];
    for (int k = 0; k < m - 1; ++k)
        for (int above = k + 1; above < m; ++above) u[k] *= 1 - u[above];
    return u;
}

// The least value of det J that is found: on a lattice, and from its least ones on by steps along the coordinates.
template <int n>
class Samples {
public:
    Samples(const CellType& cell, int degree, int steps) : basis_(cell, degree), steps_(steps) {
        const int points = static_cast<int>(std::pow(steps + 1, n) + 0.5);
        for (int q = 0; q < points; ++q) {
            Point u{};
            for (int k = 0, rest = q; k < n; ++k, rest /= steps + 1) u[k] = 1.0 * (rest % (steps + 1)) / steps;
            at_.push_back(u);
            gradients_.resize(gradients_.size() + basis_.count * n);
            basis_.gradients(in_cell(cell, u).data(), &gradients_[gradients_.size() - basis_.count * n]);
        }
    }

    const LagrangeBasis& basis() const { return basis_; }

    double least(const std::vector<Vec<n>>& x, int starts) const {
        std::vector<std::pair<double, int>> values;
        for (std::size_t q = 0; q < at_.size(); ++q)
            values.push_back({determinant_of(x, &gradients_[q * basis_.count * n]), static_cast<int>(q)});
        std::partial_sort(values.begin(), values.begin() + std::max(1, starts), values.end());
        double best = values[0].first;
        for (int s = 0; s < starts; ++s) best = std::min(best, descend(x, at_[values[s].second], values[s].first));
        return best;
    }

    double at(const std::vector<Vec<n>>& x, const Point& xi) const {
        std::vector<double> dN(basis_.count * n);
        basis_.gradients(xi.data(), dN.data());
        return determinant_of(x, dN.data());
    }

private:
    LagrangeBasis basis_;
    int steps_;
    std::vector<Point> at_;
    std::vector<double> gradients_;

    double determinant_of(const std::vector<Vec<n>>& x, const double* dN) const {
        Mat<n> J{};
        for (int i = 0; i < basis_.count; ++i)
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k) J[a][k] += x[i][a] * dN[i * n + k];
        return determinant(J);
    }

    double descend(const std::vector<Vec<n>>& x, Point u, double value) const {
        for (double step = 0.5 / steps_; step > 1e-7;) {
            bool is_better = false;
            for (int k = 0; k < 2 * n; ++k) {
                Point v = u;
                v[k / 2] = std::clamp(v[k / 2] + (k % 2 ? step : -step), 0.0, 1.0);
                const double there = at(x, in_cell(basis_.cell, v));
                if (there < value) {
                    value = there;
                    u = v;
                    is_better = true;
                }
            }
            if (!is_better) step *= 0.4;
        }
        return value;
    }
};

// The reference element moved in a random direction, smooth or not, about as far as it takes to fold it; some of them
// stretched and turned then.
template <int n>
std::vector<Vec<n>> random_element(const Samples<n>& samples, std::mt19937& random) {
    const LagrangeBasis& basis = samples.basis();
    std::uniform_real_distribution<double> any(-1, 1);
    std::vector<Vec<n>> straight, direction;
    const double rough = random() % 2 ? 1 : 0.1;
    Mat<n> bend[3];
    for (Mat<n>& b : bend)
        for (auto& row : b)
            for (double& v : row) v = any(random);
    for (int i = 0; i < basis.count; ++i) {
        Point xi = basis.point(i);
        for (int k = 0; k < 2 && basis.cell.is_collapsed; ++k) xi[k] *= 1 - xi[2];
        Vec<n> at, moved;
        for (int a = 0; a < n; ++a) {
            at[a] = xi[a];
            moved[a] = rough * any(random);
            for (int power = 2; power <= basis.degree; ++power)
                for (int k = 0; k < n; ++k) moved[a] += bend[power - 2][a][k] * std::pow(xi[k], power);
        }
        straight.push_back(at);
        direction.push_back(moved);
    }
    const auto at = [&](double t) {
        std::vector<Vec<n>> x = straight;
        for (int i = 0; i < basis.count; ++i)
            for (int a = 0; a < n; ++a) x[i][a] += t * direction[i][a];
        return x;
    };
    double low = 0, high = 4;
    for (int halving = 0; halving < 20; ++halving) {
        const double middle = 0.5 * (low + high);
        (samples.least(at(middle), 0) > 0 ? low : high) = middle;
    }
    const double nearness[] = {0.3, 0.03, 1e-3, 1e-5, 1e-7};
    std::vector<Vec<n>> x = at(low * (1 + any(random) * nearness[random() % 5]));
    if (random() % 3 > 0) return x;
    const double c = std::cos(any(random)), s = std::sqrt(1 - c * c), thin = std::pow(10, -4 * std::abs(any(random)));
    for (Vec<n>& p : x) {
        const double u = p[0], v = thin * p[1];
        p[0] = c * u - s * v;
        p[1] = s * u + c * v;
    }
    return x;
}

// The mean determinant of the straight-sided element.
template <int n>
double mean_of_straight(const CellType& cell, const std::vector<Vec<n>>& x) {
    const Quadrature rule = cell_quadrature(cell, 4);
    const LagrangeBasis basis(cell, 1);
    std::vector<double> dN(basis.count * n);
    double integral = 0;
    for (int q = 0; q < rule.count; ++q) {
        basis.gradients(&rule.xi[q * n], dN.data());
        Mat<n> J{};
        for (int i = 0; i < basis.count; ++i)
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k) J[a][k] += x[i][a] * dN[i * n + k];
        integral += rule.weight[q] * determinant(J);
    }
    return integral / cell.volume();
}

// Where the certificate's bisection sees the least value.
template <int n>
Point least_place(const JacobianBasis& basis, const ElementJacobian<n, double>& element) {
    const PolynomialMinimum minimum = polynomial_minimum(basis.jacobian, element.coefficients(0), 0.01, 2000);
    Point xi{};
    int coordinate = 0, first = 0;
    for (const int m : basis.cell.factors) {
        for (int k = 1; k <= m; ++k) xi[coordinate++] = minimum.at[first + k];
        first += m + 1;
    }
    return xi;
}

template <int n>
void compare(const CellType& cell, int degree, int count) {
    const Samples<n> samples(cell, degree, n == 2 ? 16 : 6), dense(cell, degree, n == 2 ? 40 : 12);
    std::mt19937 random(degree);
    Mesh mesh;
    mesh.dim = n;
    mesh.degree = degree;
    std::vector<std::vector<Vec<n>>> elements;
    for (int e = 0; e < count; ++e) {
        elements.push_back(random_element(samples, random));
        for (const Vec<n>& at : elements.back()) {
            mesh.elements.push_back(mesh.nodes());
            mesh.x.insert(mesh.x.end(), at.begin(), at.end());
        }
    }
    if (!cell.is_simplex()) mesh.groups = groups_of(std::vector<const CellType*>(count, &cell), degree);
    const Certificate certificate = certify(mesh, mesh.x);
    const JacobianBasis basis(cell, degree);
    int close = 0, valid = 0;
    for (int e = 0; e < count; ++e) {
        CAPTURE(cell.dim);
        CAPTURE(cell.vertices);
        CAPTURE(degree);
        CAPTURE(e);
        ElementJacobian<n, double> jacobian(basis);
        std::copy(elements[e].begin(), elements[e].end(), jacobian.position(0));
        jacobian.compute(1);
        const double margin = jacobian.unit() * jacobian.rounding(), straight = mean_of_straight<n>(cell, elements[e]);
        const bool is_valid = certificate.certified_bound[e] > 0;
        valid += is_valid;
        double least = samples.least(elements[e], 2);
        least = std::min(least, samples.at(elements[e], least_place<n>(basis, jacobian)));
        if (is_valid != (least > 0)) least = std::min(least, dense.least(elements[e], 10));
        const double bound = certificate.certified_bound[e];
        CHECK(bound <= least / std::abs(straight) + 1e-9 * std::max(1.0, std::abs(bound)));  // samples of thin elements
        if (is_valid) CHECK(least > 0);
        if (std::abs(least) <= 2 * margin) ++close;
        else CHECK(is_valid == (least > 0));
    }
    CHECK(certificate.undecided <= close);
    CHECK(close <= 0.3 * count);  // of those made to be singular, to rounding
    CHECK(valid > 0.02 * count);
    CHECK(valid < 0.95 * count);
    if (count > 100) MESSAGE(count, " ", std::string(cell.plural), " of degree ", degree, ": ", valid, " valid, ", close, " near zero");
}

}  // namespace

TEST_CASE("what is certified valid is so at all samples, and what samples decide is decided") {
    const char* const number = std::getenv("ALMESH_ELEMENTS");
    const int count = number ? std::atoi(number) : 20;
    for (const CellType& cell : cell_types())
        for (int degree = cell.is_simplex() ? 2 : 1; degree <= 4; ++degree)
            if (cell.dim == 2) compare<2>(cell, degree, count);
            else if (cell.dim == 3) compare<3>(cell, degree, count);
}
