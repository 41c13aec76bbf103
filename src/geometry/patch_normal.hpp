// The normal of a polynomial patch as a polynomial: dx/dxi turned clockwise by 90 degrees (2D), or dx/dxi_0 x dx/dxi_1
// (3D). Outward for the boundary faces of a mesh; its length is the measure of the face per measure of the reference
// face. Bezier coefficients from products of those of the derivatives, hence exact up to rounding.
#pragma once
#include "geometry/patch.hpp"

namespace almesh {

class PatchNormal {
public:
    PatchNormal(int dim, int degree);

    const Bernstein& basis() const { return normal_; }  // degree (dim - 1)(degree - 1)

    // Bezier coefficients of the components; the third is zero in 2D.
    std::array<std::vector<double>, 3> coefficients(const Patch& patch) const;

    // Signed area (2D) or volume of the cone from the apex to the patch, positive where the normal points away from it:
    // 1 / dim times the integral of (x - apex) . n. Over a closed surface the cones add up to what it encloses.
    double cone(const Patch& patch, const Point& apex) const;

private:
    int dim_, degree_;
    Bernstein position_, gradient_, normal_, integrand_;
    BezierProduct gradient_gradient_;  // 3D only
    BezierProduct position_normal_;
    std::vector<int> raised_;  // gradient_.count x dim
};

}  // namespace almesh
