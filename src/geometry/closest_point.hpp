// The point of a polynomial face closest to a given one, near a starting point.
//
// |c(xi) - x|^2 is minimised over the reference segment or triangle by Newton's method with an active set for its sides
// (Nocedal & Wright, Numerical Optimization, 1999, ch. 16.4); where the Hessian is not positive definite, by
// Gauss-Newton. Steps that do not decrease the distance are halved. The error of the distance is of the order of
// rounding relative to the size of the face, however close x is to it. A few evaluations of the face per call.
#pragma once
#include <vector>

#include "geometry/patch.hpp"

namespace almesh {

using Barycentric = std::array<double, 3>;  // on the reference face; the last entry is 0 on a segment

class FaceProjector {
public:
    FaceProjector(int m, int degree);

    // Squared distance of x, found by descent from the parameter point l: never more than from c(l). control: the
    // Bezier points of the face. work: 2 count points.
    double squared_distance(const Vec<3>* control, const Vec<3>& x, Barycentric l, std::vector<Vec<3>>& work) const;

    int count() const { return count_; }  // Bezier points of a face

private:
    // r = c - x and the derivatives of c at one parameter point.
    struct Jet {
        Vec<3> r;
        std::array<Vec<3>, 2> first;
        std::array<Vec<3>, 3> second;  // d00, d01, d11
        double squared;               // |r|^2
    };
    // Quadratic model of |c - x|^2 / 2: gradient g and Hessian H = (H00, H01, H11), positive definite unless the face
    // is degenerate there.
    struct Model {
        std::array<double, 2> g;
        std::array<double, 3> H;
    };
    Jet evaluate(const Vec<3>* control, const Vec<3>& x, const Barycentric& l, std::vector<Vec<3>>& work) const;
    Model model_of(const Jet& jet) const;
    bool feasible_step(const Model& model, const Barycentric& l, Barycentric& step) const;

    int m_, degree_, count_;
    std::vector<std::vector<int>> raised_;  // [d]: for each index a of degree d, the places of a + e_k at d + 1
};

}  // namespace almesh
