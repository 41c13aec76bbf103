// A boundary with nodes that slide or are free, and others whose positions are prescribed.
//
// A node that slides must stay on the surface of its part or, in 3D, on the curve where two parts meet; at a corner its
// position is prescribed. Let r_i(x_i) be the sum of its distance vectors from these surfaces (sliding_nodes.hpp), in
// place of r = x - g_h in dirichlet.hpp, and D_i = dr_i/dx_i. Then
//
//     C = -lambda^T M r / |1| + mu/2 r^T M r / |1|^2,
//     gradient D' f,  f = M (mu r / |1|^2 - lambda / |1|),   Hessian mu D' M D / |1|^2 + f . d2r/dx2,
//
// with D_i = I for a prescribed position and D_i = 0 for a free node. On the surface D_i projects onto the normals: the
// node is free in other directions, and tangential multipliers have no effect. d2r/dx2 is exact on the surface; the
// Hessian without it (Gauss-Newton) is positive semidefinite. The target is nodal.
#pragma once
#include <memory>
#include <vector>

#include "constraint/dirichlet.hpp"

namespace almesh {

class SlidingSurfaces;

class SlidingBoundary : public Dirichlet {
public:
    // sliding: null if some boundaries are free and none slides. Throws InputError if a node of a sliding boundary has
    // a prescribed position that is off the surface.
    SlidingBoundary(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target,
                    std::shared_ptr<const SlidingSurfaces> sliding);

    double max_error(const std::vector<double>& x) override;
    std::unique_ptr<Constraint> part(const Restriction& around, std::vector<double>& lambda) const override;
    bool corrects_steps() const override { return sliding_ != nullptr; }
    void correct(const std::vector<double>& x, const std::vector<double>& d, double t,
                 std::vector<double>& y) const override;
    std::vector<double> targets(const std::vector<double>& x) const override;
    SurfaceDistance distance(int trace_node, const Vec<3>& x) const override;
    Mat<3> second_derivative_at(int trace_node, const Vec<3>& x, const Vec<3>& force) const override;

private:
    SlidingBoundary(const SlidingBoundary& whole, const Restriction& around);

    std::shared_ptr<const SlidingSurfaces> sliding_;
    std::vector<char> prescribed_;         // trace nodes: whether fixed at g_h_
    std::vector<std::vector<int>> parts_;  // trace nodes: those it slides along

    bool slides(int t) const override { return !parts_[t].empty(); }
};

// Dirichlet if the target prescribes all positions; else SlidingBoundary, whose target is nodal.
std::unique_ptr<Constraint> make_constraint(const Mesh& mesh, const std::vector<double>& ideal,
                                            const BoundaryTarget& target, TargetKind kind,
                                            std::shared_ptr<const SlidingSurfaces> sliding);

}  // namespace almesh
