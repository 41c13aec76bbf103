// Boundaries of which some nodes are freed to slide, beside others whose positions are prescribed.
//
// A node that slides is to be on the surfaces of the parts that it is on: on one, on the curve in which two of them
// meet, or at the corner of three. With r_i(x_i) the sum of its distance vectors from them (sliding_nodes.hpp), in
// place of r = x - g_h in dirichlet.hpp, and D_i = dr_i/dx_i,
//
//     C = -lambda^T M r / |1| + mu/2 r^T M r / |1|^2,
//     gradient D' f,  f = M (mu r / |1|^2 - lambda / |1|),   Hessian mu D' M D / |1|^2 + f . d2r/dx2,
//
// D_i = I where the position is prescribed, 0 where the node is free. D_i projects onto the normals where x is on the
// surface: the node is free in other directions, and multipliers along the surface are of no account. d2r/dx2 is
// exact where x is on the surface; the Hessian without it (Gauss-Newton) is positive semidefinite. The target is nodal.
#pragma once
#include <memory>
#include <vector>

#include "constraint/dirichlet.hpp"

namespace almesh {

class SlidingSurfaces;

class SlidingBoundary : public Dirichlet {
public:
    // sliding: null where no boundary slides, but some are free. Throws InputError where a prescribed position is off
    // the surface along which the node slides as well.
    SlidingBoundary(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                    std::shared_ptr<const SlidingSurfaces> sliding);

    double max_error(const std::vector<double>& x) override;
    void add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                      std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, const std::vector<double>& lambda, double mu, bool projected,
                     BlockCsr& H) override;
    std::unique_ptr<Constraint> part(const Restriction& around, std::vector<double>& lambda) const override;
    bool corrects_steps() const override { return sliding_ != nullptr; }
    void correct(const std::vector<double>& x, const std::vector<double>& d, double t,
                 std::vector<double>& y) const override;
    std::vector<double> targets(const std::vector<double>& x) const override;
    std::vector<char> off_target(const std::vector<double>& x) const override;

    SurfaceDistance distance(int trace_node, const Vec<3>& x) const override;
    Mat<3> second_derivative_at(int trace_node, const Vec<3>& x, const Vec<3>& force) const override;

private:
    SlidingBoundary(const SlidingBoundary& whole, const Restriction& around);

    std::shared_ptr<const SlidingSurfaces> sliding_;
    std::vector<char> prescribed_;         // trace nodes: whether the position is, at g_h_
    std::vector<std::vector<int>> parts_;  // trace nodes: along which it slides

    std::vector<double> residual(const std::vector<double>& x) const override { return residual(x, nullptr); }
    std::vector<double> residual(const std::vector<double>& x, std::vector<double>* slope) const;
    Vec<3> at(const std::vector<double>& x, int trace_node) const;
};

// Prescribed positions where the target has no others, whatever the surfaces; else the target is nodal.
std::unique_ptr<Constraint> make_constraint(const Mesh& mesh, const std::vector<double>& ideal,
                                            const BoundaryTarget& target, TargetKind kind,
                                            std::shared_ptr<const SlidingSurfaces> sliding);

}  // namespace almesh
