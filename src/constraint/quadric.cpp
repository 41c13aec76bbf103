// q(x) = x'Hx / 2 + h.x + c with its coefficients the eigenvector of the smallest eigenvalue of D'D, the rows of D
// being the monomials at the points (relative to their centre and extent).
#include "constraint/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "linalg/dense_solve.hpp"

namespace almesh {
namespace {

constexpr int most = 10;  // monomials of degree up to 2 in space

// In its own frame: q(u) = sum over i of (a_i u_i^2 / 2 + h_i u_i) + c.
struct Quadric final : Surface {
    Vec<3> a{}, h{}, centre{};
    Mat<3> axis{};
    double c = 0;
    int dim = 3;

    Vec<3> in_frame(const Vec<3>& x) const { return times(axis, x - centre); }
    Vec<3> in_space(const Vec<3>& u) const { return u[0] * axis[0] + u[1] * axis[1] + u[2] * axis[2]; }
    Vec<3> gradient(const Vec<3>& u) const { return {a[0] * u[0] + h[0], a[1] * u[1] + h[1], a[2] * u[2] + h[2]}; }
    double value(const Vec<3>& u) const {
        double sum = c;
        for (int i = 0; i < 3; ++i) sum += (0.5 * a[i] * u[i] + h[i]) * u[i];
        return sum;
    }

    // Stationary point of |p - u|^2 / 2 + t q(p).
    Vec<3> stationary(const Vec<3>& u, double t) const {
        Vec<3> p;
        for (int i = 0; i < 3; ++i) p[i] = (u[i] - t * h[i]) / (1 + t * a[i]);
        return p;
    }

    Vec<3> closest_in_frame(const Vec<3>& u) const;
    SurfacePoint closest(const Vec<3>& x) const override;
    std::string name() const override { return dim == 2 ? "conic" : "quadric"; }
};

// While I + t A is positive definite the stationary point is a minimum, and q there decreases with t: the closest point
// is where it vanishes, by Newton's method within the bracket, or bisection. Where it does not vanish, x is farther
// from the surface than its centres of curvature: as far as it goes then.
Vec<3> Quadric::closest_in_frame(const Vec<3>& u) const {
    constexpr int steps = 100;
    constexpr double inside = 1 - 1e-9, rounding = 1e-16;
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const double a_i : a) {
        if (a_i > 0) low = std::max(low, -inside / a_i);
        if (a_i < 0) high = std::min(high, -inside / a_i);
    }
    double t = 0;
    for (int step = 0; step < steps; ++step) {
        const Vec<3> p = stationary(u, t), g = gradient(p);
        const double q = value(p);
        if (q > 0) low = std::max(low, t);
        else high = std::min(high, t);
        double slope = 0;
        for (int i = 0; i < 3; ++i) slope += g[i] * g[i] / (1 + t * a[i]);
        double next = t + q / std::max(slope, std::numeric_limits<double>::min());
        if (!(next > low && next < high)) next = std::isinf(low) || std::isinf(high) ? 2 * t + q : 0.5 * (low + high);
        if (std::abs(next - t) <= rounding * std::abs(t)) break;
        t = next;
    }
    return stationary(u, t);
}

SurfacePoint Quadric::closest(const Vec<3>& x) const {
    const Vec<3> p = closest_in_frame(in_frame(x));
    Mat<3> H{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) H[i][j] += a[k] * axis[k][i] * axis[k][j];
    return implicit_projection(x, centre + in_space(p), in_space(gradient(p)), H);
}

std::array<double, most> monomials(const Vec<3>& u, int dim) {
    if (dim == 2) return {u[0] * u[0], u[1] * u[1], u[0] * u[1], u[0], u[1], 1};
    return {u[0] * u[0], u[1] * u[1], u[2] * u[2], u[0] * u[1], u[0] * u[2], u[1] * u[2], u[0], u[1], u[2], 1};
}

}  // namespace

std::unique_ptr<Surface> fit_quadric(int dim, const std::vector<Vec<3>>& points, double tolerance) {
    constexpr double several = 1e-9;      // second eigenvalue over the largest: more than one quadric
    constexpr double no_normal = 1e-3;    // |g| over its largest value
    const int n = dim == 2 ? 6 : most;
    if (static_cast<int>(points.size()) < n + 2) return nullptr;
    const Box box = box_of(points);
    const Vec<3> centre = 0.5 * (box.low + box.high);
    const double size = 0.5 * length(box.high - box.low);
    std::vector<double> A(n * n), V(n * n);
    for (const Vec<3>& x : points) {
        const std::array<double, most> row = monomials(1 / size * (x - centre), dim);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) A[i * n + j] += row[i] * row[j];
    }
    diagonalise(n, A.data(), V.data());
    const auto eigenvalue = [&](int i) { return A[i * n + i]; };
    std::array<int, most> order{};
    for (int i = 0; i < n; ++i) order[i] = i;
    std::sort(order.begin(), order.begin() + n, [&](int i, int j) { return eigenvalue(i) < eigenvalue(j); });
    if (!(eigenvalue(order[1]) > several * eigenvalue(order[n - 1]))) return nullptr;
    const auto entry = [&](int i) { return V[i * n + order[0]]; };
    Mat<3> H{}, axes;
    for (int i = 0; i < dim; ++i) H[i][i] = 2 * entry(i) / (size * size);
    for (int i = 0, k = dim; i < dim; ++i)
        for (int j = i + 1; j < dim; ++j, ++k) H[i][j] = H[j][i] = entry(k) / (size * size);
    diagonalise(3, H[0].data(), axes[0].data());
    auto quadric = std::make_unique<Quadric>();
    quadric->dim = dim;
    quadric->centre = centre;
    quadric->c = entry(n - 1);
    for (int i = 0; i < 3; ++i) {
        quadric->a[i] = H[i][i];
        for (int k = 0; k < 3; ++k) quadric->axis[i][k] = axes[k][i];
        for (int k = 0; k < dim; ++k) quadric->h[i] += quadric->axis[i][k] * entry(n - 1 - dim + k) / size;
    }
    double steepest = 0, flattest = std::numeric_limits<double>::infinity();
    for (const Vec<3>& x : points) {
        if (!(length(quadric->closest(x).position - x) <= tolerance * size)) return nullptr;
        const double slope = length(quadric->gradient(quadric->in_frame(x)));
        steepest = std::max(steepest, slope);
        flattest = std::min(flattest, slope);
    }
    if (!(flattest > no_normal * steepest)) return nullptr;
    return quadric;
}

}  // namespace almesh
