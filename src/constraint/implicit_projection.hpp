// The closest-point projection onto a surface q = 0, from what is known of q there.
#pragma once
#include <algorithm>
#include <limits>

#include "constraint/surface.hpp"

namespace almesh {

// p: closest to x on the surface; g and H: gradient and second derivatives of q at p. With n = g / |g| and d the
// distance of x, the curvature is S = P H P / |g| at p, P = I - n n', and S (I + d S)^-1 at x, as long as x is well
// before the nearest centre of curvature.
inline SurfacePoint implicit_projection(const Vec<3>& x, const Vec<3>& p, const Vec<3>& g, const Mat<3>& H) {
    constexpr double nearly_focal = 0.05;
    const double steepness = std::max(length(g), std::numeric_limits<double>::min());
    const Vec<3> n = 1 / steepness * g, Hn = {dot(H[0], n), dot(H[1], n), dot(H[2], n)};
    const double d = dot(x - p, n);
    Mat<3> S{}, focal{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            S[i][j] = (H[i][j] - n[i] * Hn[j] - Hn[i] * n[j] + dot(n, Hn) * n[i] * n[j]) / steepness;
            focal[i][j] = (i == j) + d * S[i][j];
        }
    SurfacePoint projection{p, n, {}, determinant(focal) > nearly_focal ? multiply<3>(S, inverse<3>(focal)) : S};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) projection.slope[i][j] = n[i] * n[j] + d * projection.curvature[i][j];
    return projection;
}

}  // namespace almesh
