// Distances to the primitives, with d = x - c, u = d.a a the part of d along the unit axis and v = d - u:
//
//     plane d.n      sphere |d| - R      cylinder |v| - R      torus sqrt((|v| - R)^2 + |u|^2) - r
//
// A fit minimises their squares over the points, in coordinates relative to the points' centre and extent; the residual
// of a true one is zero, so that differences in place of derivatives lose no accuracy.
#include "constraint/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "base/table.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh {
namespace {

Vec<3> any_perpendicular(const Vec<3>& a) {
    const Vec<3> axis = std::abs(a[0]) < 0.6 ? Vec<3>{1, 0, 0} : Vec<3>{0, 1, 0};
    return unit(cross(a, axis));
}

// (I - sum of u u' over the unit vectors u) / R
Mat<3> round(double R, std::initializer_list<Vec<3>> straight) {
    Mat<3> S{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            S[i][j] = i == j;
            for (const Vec<3>& u : straight) S[i][j] -= u[i] * u[j];
            S[i][j] /= R;
        }
    return S;
}

// Radii below which a surface's second derivatives are not followed towards its centre or axis, over its radius.
constexpr double innermost = 1e-3;

struct Plane final : Surface {
    Vec<3> c, n;
    int dim;
    Plane(const Vec<3>& c_, const Vec<3>& n_, int dim_) : c(c_), n(n_), dim(dim_) {}
    SurfacePoint closest(const Vec<3>& x) const override { return projection_at(x, x - dot(x - c, n) * n, n, {}); }
    std::string name() const override { return dim == 2 ? "straight line" : "plane"; }
    bool is_flat() const override { return true; }
};

struct Sphere final : Surface {
    Vec<3> c;
    double R;
    int dim;
    Sphere(const Vec<3>& c_, double R_, int dim_) : c(c_), R(R_), dim(dim_) {}
    SurfacePoint closest(const Vec<3>& x) const override {
        const Vec<3> d = x - c, n = length(d) > 0 ? unit(d) : Vec<3>{1, 0, 0};
        const double radius = std::max(length(d), innermost * R);
        return projection_at(x, c + R * n, n, dim == 2 ? round(radius, {n, {0, 0, 1}}) : round(radius, {n}));
    }
    std::string name() const override { return concat(dim == 2 ? "circle" : "sphere", " of radius ", to_text(R, 6)); }
};

// The cylinder is a torus with an infinite axis: both are given by c, the unit axis a and their radii.
struct Cylinder final : Surface {
    Vec<3> c, a;
    double R;
    Cylinder(const Vec<3>& c_, const Vec<3>& a_, double R_) : c(c_), a(a_), R(R_) {}
    SurfacePoint closest(const Vec<3>& x) const override {
        const Vec<3> d = x - c, u = dot(d, a) * a, v = d - u;
        const Vec<3> n = length(v) > 0 ? unit(v) : any_perpendicular(a);
        return projection_at(x, c + u + R * n, n, round(std::max(length(v), innermost * R), {n, a}));
    }
    std::string name() const override { return concat("cylinder of radius ", to_text(R, 6)); }
};

struct Torus final : Surface {
    Vec<3> c, a;
    double R, r;
    Torus(const Vec<3>& c_, const Vec<3>& a_, double R_, double r_) : c(c_), a(a_), R(R_), r(r_) {}
    SurfacePoint closest(const Vec<3>& x) const override {
        const Vec<3> d = x - c, v = d - dot(d, a) * a;
        const Vec<3> outward = length(v) > 0 ? unit(v) : any_perpendicular(a), along = cross(a, outward);
        const Vec<3> ring = c + R * outward, e = x - ring, n = length(e) > 0 ? unit(e) : a;
        Mat<3> S = round(std::max(length(e), innermost * r), {n, along});
        const double of_ring = dot(n, outward) / std::max(length(v), innermost * R);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) S[i][j] += of_ring * along[i] * along[j];
        return projection_at(x, ring + r * n, n, S);
    }
    std::string name() const override { return concat("torus of radii ", to_text(R, 6), " and ", to_text(r, 6)); }
};

using Residual = std::function<double(const std::vector<double>& parameters, const Vec<3>& x)>;

double squares(const Residual& residual, const std::vector<double>& s, const std::vector<Vec<3>>& points) {
    double sum = 0;
    for (const Vec<3>& x : points) sum += std::pow(residual(s, x), 2);
    return sum;
}

// Levenberg-Marquardt from s, until steps are of the size of rounding or no longer lead anywhere; returns the largest
// residual. points: of size 1.
double least_squares(const Residual& residual, const std::vector<Vec<3>>& points, std::vector<double>& s) {
    constexpr int steps = 60, most_idle = 3;
    constexpr double difference = 1e-6, rounding = 1e-13, idle = 0.99;
    const int k = static_cast<int>(s.size());
    double damping = 1e-3, sum = squares(residual, s, points);
    for (int step = 0, idle_steps = 0; step < steps && idle_steps < most_idle && sum > 0; ++step) {
        std::vector<double> A(k * k, 0.0), b(k, 0.0), d, derivative(k), trial;
        for (const Vec<3>& x : points) {
            const double r = residual(s, x);
            for (int i = 0; i < k; ++i) {
                trial = s;
                trial[i] += difference;
                const double plus = residual(trial, x);
                trial[i] -= 2 * difference;
                derivative[i] = (plus - residual(trial, x)) / (2 * difference);
            }
            for (int i = 0; i < k; ++i) {
                b[i] -= r * derivative[i];
                for (int j = 0; j < k; ++j) A[i * k + j] += derivative[i] * derivative[j];
            }
        }
        for (int i = 0; i < k; ++i) A[i * k + i] += damping * (A[i * k + i] + 1e-12);
        if (!solve_dense(A, b, d, 0)) break;
        trial = s;
        for (int i = 0; i < k; ++i) trial[i] += d[i];
        const double next = squares(residual, trial, points);
        const bool is_tiny = std::all_of(d.begin(), d.end(), [](double di) { return std::abs(di) <= rounding; });
        if (next < sum) {
            idle_steps = next > idle * sum ? idle_steps + 1 : 0;
            s = trial;
            sum = next;
            damping *= 0.05;
        } else {
            damping = std::max(20 * damping, 1e-9);
            if (damping > 1e12) break;
        }
        if (is_tiny) break;
    }
    double largest = 0;
    for (const Vec<3>& x : points) largest = std::max(largest, std::abs(residual(s, x)));
    return largest;
}

struct Fit {
    const std::vector<Vec<3>>& points;
    Vec<3> centre{};
    double size = 0;

    explicit Fit(const std::vector<Vec<3>>& points_) : points(points_) {
        const Box box = box_of(points);
        centre = 0.5 * (box.low + box.high);
        size = 0.5 * length(box.high - box.low);
    }

    // Of the points' covariance: those of a whole cylinder or torus have its axis among them.
    std::array<Vec<3>, 3> principal_axes() const {
        Mat<3> C{}, V;
        const std::vector<Vec<3>> x = scaled();
        Vec<3> mean{};
        for (const Vec<3>& at : x) mean = mean + 1.0 / static_cast<double>(x.size()) * at;
        for (const Vec<3>& at : x)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) C[i][j] += (at[i] - mean[i]) * (at[j] - mean[j]);
        diagonalise(3, C[0].data(), V[0].data());
        const Mat<3> rows = transpose<3>(V);
        return {rows[0], rows[1], rows[2]};
    }

    // Relative to centre and size; every so-many-th.
    std::vector<Vec<3>> scaled(int every = 1) const {
        std::vector<Vec<3>> result;
        for (std::size_t i = 0; i < points.size(); i += every) result.push_back(1 / size * (points[i] - centre));
        return result;
    }

    bool holds(const Surface& surface, double tolerance) const {
        return std::all_of(points.begin(), points.end(), [&](const Vec<3>& x) {
            return length(surface.closest(x).position - x) <= tolerance * size;
        });
    }
};

// |x|^2 = 2 c.x + (R^2 - |c|^2) is linear in c and the bracket.
std::unique_ptr<Surface> fit_sphere(int dim, const Fit& fit) {
    const int k = dim + 1;
    std::vector<double> A(k * k, 0.0), b(k, 0.0), s;
    for (const Vec<3>& x : fit.scaled()) {
        std::array<double, 4> row{2 * x[0], 2 * x[1], 2 * x[2], 1};
        row[dim] = 1;
        for (int i = 0; i < k; ++i) {
            b[i] += row[i] * dot(x, x);
            for (int j = 0; j < k; ++j) A[i * k + j] += row[i] * row[j];
        }
    }
    if (!solve_dense(A, b, s, 0)) return nullptr;
    Vec<3> c{};
    std::copy_n(s.begin(), dim, c.begin());
    const double squared = s[dim] + dot(c, c);
    if (!(squared > 0) || squared > 1e8) return nullptr;
    return std::make_unique<Sphere>(fit.centre + fit.size * c, fit.size * std::sqrt(squared), dim);
}

// s: centre (2 or 3 numbers), axis (2), radii. The axis is a + s_k e_1 + s_{k+1} e_2 with e_1, e_2 perpendicular to the
// guess a; the centre of a cylinder is where its axis meets the plane of e_1 and e_2. Some of the points tell whether
// there is such a surface.
std::unique_ptr<Surface> fit_round(const Fit& fit, const Vec<3>& a, bool torus) {
    constexpr int enough = 100;
    constexpr double largest_residual = 1e-6;
    const std::vector<Vec<3>> x = fit.scaled(), some = fit.scaled(std::max(1, static_cast<int>(x.size()) / enough));
    const Vec<3> e1 = any_perpendicular(a), e2 = cross(a, e1);
    const auto axis = [&](const std::vector<double>& s) { return unit(a + s[0] * e1 + s[1] * e2); };
    const auto centre = [&](const std::vector<double>& s) { return s[2] * e1 + s[3] * e2 + (torus ? s[5] : 0) * a; };
    const Residual residual = [&](const std::vector<double>& s, const Vec<3>& at) {
        const Vec<3> d = at - centre(s), u = dot(d, axis(s)) * axis(s);
        const double out = length(d - u) - s[4];
        return torus ? std::sqrt(out * out + dot(u, u)) - s[6] : out;
    };
    double farthest = 0, nearest = std::numeric_limits<double>::infinity();
    for (const Vec<3>& at : x) {
        const double radial = length(at - dot(at, a) * a);
        farthest = std::max(farthest, radial);
        nearest = std::min(nearest, radial);
    }
    std::vector<double> s = {0, 0, 0, 0, torus ? 0.5 * (nearest + farthest) : farthest};
    if (torus) s.insert(s.end(), {0, 0.5 * (farthest - nearest) + 0.05});
    for (const auto* at : {&some, &x})
        if (!(least_squares(residual, *at, s) <= largest_residual)) return nullptr;
    const Vec<3> c = fit.centre + fit.size * centre(s);
    if (torus) return std::make_unique<Torus>(c, axis(s), fit.size * s[4], fit.size * std::abs(s[6]));
    return std::make_unique<Cylinder>(c, axis(s), fit.size * std::abs(s[4]));
}

}  // namespace

double extent(const std::vector<Vec<3>>& points) {
    double largest = 0;
    for (const Vec<3>& x : points) largest = std::max(largest, length(x - points[0]));
    return largest;
}

SurfacePoint projection_at(const Vec<3>& x, const Vec<3>& p, const Vec<3>& n, const Mat<3>& S) {
    SurfacePoint projection{p, n, {}, S};
    const double d = dot(x - p, n);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) projection.slope[i][j] = n[i] * n[j] + d * S[i][j];
    return projection;
}

SurfacePoint implicit_projection(const Vec<3>& x, const Vec<3>& p, const Vec<3>& g, const Mat<3>& H) {
    constexpr double nearly_focal = 0.05;
    const double steepness = std::max(length(g), std::numeric_limits<double>::min());
    const Vec<3> n = 1 / steepness * g, Hn = times(H, n);
    const double d = dot(x - p, n);
    Mat<3> S{}, focal{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            S[i][j] = (H[i][j] - n[i] * Hn[j] - Hn[i] * n[j] + dot(n, Hn) * n[i] * n[j]) / steepness;
            focal[i][j] = (i == j) + d * S[i][j];
        }
    return projection_at(x, p, n, determinant(focal) > nearly_focal ? multiply<3>(S, inverse<3>(focal)) : S);
}

std::unique_ptr<Surface> fit_surface(int dim, const std::vector<Vec<3>>& points, const Vec<3>& normal,
                                     double tolerance) {
    const int count = static_cast<int>(points.size());
    if (count == 0) return nullptr;
    const Fit fit(points);
    if (!(fit.size > 0)) return nullptr;
    std::unique_ptr<Surface> found;
    const auto holds = [&] { return found && fit.holds(*found, tolerance); };
    if (length(normal) > 0) {  // through the points' own mean, which is in the plane to rounding
        Vec<3> mean{};
        for (const Vec<3>& x : points) mean = mean + 1.0 / count * (x - fit.centre);
        found = std::make_unique<Plane>(fit.centre + mean, unit(normal), dim);
    }
    if (holds()) return found;
    if (count < dim + 2) return nullptr;
    found = fit_sphere(dim, fit);
    if (holds()) return found;
    if (dim == 2) return fit_quadric(dim, points, tolerance);
    std::vector<Vec<3>> axes = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    for (const Vec<3>& axis : fit.principal_axes()) axes.push_back(axis);
    for (const bool torus : {false, true})
        for (const Vec<3>& axis : axes) {
            if (count < (torus ? 9 : 7)) continue;
            found = fit_round(fit, axis, torus);
            if (holds()) return found;
        }
    return fit_quadric(dim, points, tolerance);
}

}  // namespace almesh
