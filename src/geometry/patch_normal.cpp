#include "geometry/patch_normal.hpp"

namespace almesh {

PatchNormal::PatchNormal(int dim, int degree)
    : dim_(dim), degree_(degree), position_(dim - 1, degree), gradient_(dim - 1, degree - 1),
      normal_(dim - 1, (dim - 1) * (degree - 1)), integrand_(dim - 1, degree + normal_.degree),
      gradient_gradient_(gradient_, gradient_, Bernstein(dim - 1, 2 * (degree - 1))),
      position_normal_(position_, normal_, integrand_), raised_(raised_places(dim - 1, degree - 1)) {}

std::array<std::vector<double>, 3> PatchNormal::coefficients(const Patch& patch) const {
    std::array<std::array<std::vector<double>, 3>, 2> tangent;  // scaled by the multinomials
    for (int k = 0; k < dim_ - 1; ++k)
        for (int c = 0; c < 3; ++c) {
            const double* const x = patch.component(c);
            for (int a = 0; a < gradient_.count; ++a) {
                const double from = x[raised_[a * dim_]], to = x[raised_[a * dim_ + k + 1]];
                tangent[k][c].push_back(degree_ * (to - from) * gradient_.multinomial[a]);
            }
        }
    std::array<std::vector<double>, 3> n;
    for (std::vector<double>& component : n) component.assign(normal_.count, 0.0);
    if (dim_ == 2)
        for (int a = 0; a < normal_.count; ++a) {
            n[0][a] = tangent[0][1][a];
            n[1][a] = -tangent[0][0][a];
        }
    else
        for (int c = 0; c < 3; ++c) {
            const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            gradient_gradient_.add(1, tangent[0][c1].data(), tangent[1][c2].data(), n[c].data());
            gradient_gradient_.add(-1, tangent[0][c2].data(), tangent[1][c1].data(), n[c].data());
        }
    for (std::vector<double>& component : n)
        for (int a = 0; a < normal_.count; ++a) component[a] /= normal_.multinomial[a];
    return n;
}

double PatchNormal::cone(const Patch& patch, const Point& apex) const {
    std::array<std::vector<double>, 3> n = coefficients(patch);
    std::vector<double> value(integrand_.count, 0.0), x(position_.count);
    for (int c = 0; c < dim_; ++c) {
        for (int a = 0; a < position_.count; ++a) x[a] = (patch.component(c)[a] - apex[c]) * position_.multinomial[a];
        for (int a = 0; a < normal_.count; ++a) n[c][a] *= normal_.multinomial[a];
        position_normal_.add(1, x.data(), n[c].data(), value.data());
    }
    double mean = 0;  // of a polynomial over the simplex: that of its Bezier coefficients
    for (int a = 0; a < integrand_.count; ++a) mean += value[a] / integrand_.multinomial[a] / integrand_.count;
    const double reference_measure = dim_ == 2 ? 1 : 0.5;
    return mean * reference_measure / dim_;
}

}  // namespace almesh
