// In the frame (t_1, t_2, n) at the centre, with u = t_1 . x / R, v = t_2 . x / R and R the extent of the points:
// z = sum of c_ij u^i v^j, 1 <= i + j <= degree, in 2D of c_i u^i. The projection is the root of
//
//     (u, v) - (u, v)(x) + (z - z(x)) grad z = 0
//
// by Newton's method.
#include "constraint/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "linalg/dense_solve.hpp"

namespace almesh {
namespace {

constexpr int highest = 4;

// Powers of the terms of a polynomial without constant.
std::vector<std::array<int, 2>> terms_of(int dim, int degree) {
    std::vector<std::array<int, 2>> terms;
    for (int total = 1; total <= degree; ++total)
        for (int j = 0; j <= (dim == 2 ? 0 : total); ++j) terms.push_back({total - j, j});
    return terms;
}

double power(double base, int exponent) {
    double result = 1;
    for (int k = 0; k < exponent; ++k) result *= base;
    return result;
}

// The i-th derivative of u^k.
double derivative(double u, int k, int i) {
    double factor = 1;
    for (int step = 0; step < i; ++step) factor *= k - step;
    return factor == 0 ? 0 : factor * power(u, k - i);
}

class HeightPatch final : public Surface {
public:
    HeightPatch(int dim, const Vec<3>& centre, const Vec<3>& normal, double size) : centre_(centre), size_(size) {
        n_ = 1 / length(normal) * normal;
        const Vec<3> axis = std::abs(n_[0]) < 0.6 ? Vec<3>{1, 0, 0} : Vec<3>{0, 1, 0};
        const Vec<3> across = dim == 2 ? Vec<3>{n_[1], -n_[0], 0} : cross(n_, axis);
        t_[0] = 1 / length(across) * across;
        t_[1] = cross(n_, t_[0]);
    }

    std::vector<std::array<int, 2>> terms;
    std::vector<double> c;

    // In units of the size.
    Vec<3> in_frame(const Vec<3>& x) const {
        const Vec<3> d = 1 / size_ * (x - centre_);
        return {dot(t_[0], d), dot(t_[1], d), dot(n_, d)};
    }

    SurfacePoint closest(const Vec<3>& x) const override {
        constexpr int steps = 30;
        constexpr double longest_step = 0.3, rounding = 1e-16;
        const Vec<3> at = in_frame(x);
        double u = at[0], v = at[1];
        for (int step = 0; step < steps; ++step) {
            const double z = height(u, v, 0, 0), z_u = height(u, v, 1, 0), z_v = height(u, v, 0, 1), d = z - at[2];
            const double F[2] = {u - at[0] + d * z_u, v - at[1] + d * z_v};
            Mat<2> J = {{{1 + z_u * z_u + d * height(u, v, 2, 0), z_u * z_v + d * height(u, v, 1, 1)},
                         {z_u * z_v + d * height(u, v, 1, 1), 1 + z_v * z_v + d * height(u, v, 0, 2)}}};
            if (!(determinant(J) > 0)) J = {{{1 + z_u * z_u, z_u * z_v}, {z_u * z_v, 1 + z_v * z_v}}};  // Gauss-Newton
            const Mat<2> inverse_J = inverse<2>(J);
            const double du = -(inverse_J[0][0] * F[0] + inverse_J[0][1] * F[1]),
                         dv = -(inverse_J[1][0] * F[0] + inverse_J[1][1] * F[1]);
            const double t = std::min(1.0, longest_step / std::max(std::hypot(du, dv), longest_step));
            u += t * du;
            v += t * dv;
            if (std::hypot(du, dv) <= rounding * std::hypot(u, v)) break;
        }
        return at_parameters(x, u, v);
    }
    std::string name() const override { return "a smooth patch"; }

private:
    Vec<3> centre_, n_;
    std::array<Vec<3>, 2> t_;
    double size_;

    // Derivative of z, i times along u, j times along v.
    double height(double u, double v, int i, int j) const {
        double sum = 0;
        for (std::size_t k = 0; k < terms.size(); ++k)
            sum += c[k] * derivative(u, terms[k][0], i) * derivative(v, terms[k][1], j);
        return sum;
    }

    // q = z(x) - z(u, v).
    SurfacePoint at_parameters(const Vec<3>& x, double u, double v) const {
        const Vec<3> p = centre_ + size_ * (u * t_[0] + v * t_[1] + height(u, v, 0, 0) * n_);
        const Vec<3> g = n_ - height(u, v, 1, 0) * t_[0] - height(u, v, 0, 1) * t_[1];
        const double uu = height(u, v, 2, 0), uv = height(u, v, 1, 1), vv = height(u, v, 0, 2);
        Mat<3> H;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                H[i][j] = -(uu * t_[0][i] * t_[0][j] + uv * (t_[0][i] * t_[1][j] + t_[1][i] * t_[0][j]) +
                            vv * t_[1][i] * t_[1][j]) / size_;
        return implicit_projection(x, p, g, H);
    }
};

}  // namespace

std::unique_ptr<Surface> fit_height_patch(int dim, const Vec<3>& centre, const Vec<3>& normal,
                                          const std::vector<Vec<3>>& points) {
    constexpr double points_per_term = 1.5;
    double size = 0;
    for (const Vec<3>& x : points) size = std::max(size, length(x - centre));
    if (!(size > 0) || !(length(normal) > 0)) return nullptr;
    auto patch = std::make_unique<HeightPatch>(dim, centre, normal, size);
    for (int degree = highest; degree >= 2; --degree) {
        patch->terms = terms_of(dim, degree);
        const int k = static_cast<int>(patch->terms.size());
        if (static_cast<double>(points.size()) < points_per_term * k) continue;
        std::vector<double> A(k * k, 0.0), b(k, 0.0);
        for (const Vec<3>& x : points) {
            const Vec<3> at = patch->in_frame(x);
            const double weight = std::exp(-4 * dot(at, at));
            std::vector<double> row;
            for (const auto& [i, j] : patch->terms) row.push_back(power(at[0], i) * power(at[1], j));
            for (int i = 0; i < k; ++i) {
                b[i] += weight * at[2] * row[i];
                for (int j = 0; j < k; ++j) A[i * k + j] += weight * row[i] * row[j];
            }
        }
        if (solve_dense(A, b, patch->c)) return patch;
    }
    return nullptr;
}

}  // namespace almesh
