// The distortion energy, its gradient and its Hessian as a textbook would assemble them: one element after the other,
// one quadrature point after the other, dense loops, the second derivative of eta written down from that of the
// determinant, a general eigensolver for its projection, every block found in its row by bisection. Made to be read,
// and the reference that simd_energy.hpp is tested against; ten to fifty times slower. One thread.
#pragma once
#include "energy/group_energy.hpp"

namespace almesh {

class PlainEnergy : public GroupEnergy {
public:
    PlainEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params);

    double energy(const std::vector<double>& x) override;
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                     const Projection& projection = {}) override;
    DistortionStatistics statistics(const std::vector<double>& x) override;
    using GroupEnergy::part;
    std::unique_ptr<GroupEnergy> part(const std::vector<double>& x, const Restriction& around) const override;
    void scale_weights(const std::array<double, 2>& factor) override;

private:
    PlainEnergy(const PlainEnergy& whole, const Restriction& around);

    std::vector<IdealElement> ideal_;  // per element

    template <class Body>
    void every_point(const std::vector<double>& x, const Body& body) const;
};

// Multiplies the negative eigenvalues of a symmetric size x size matrix, row-major, by kept_negative; with 0 what is
// left is its positive semidefinite part. Cyclic Jacobi rotations (Golub & Van Loan, Matrix Computations, sec. 8.5).
void project(int size, double* A, double kept_negative = 0);

}  // namespace almesh
