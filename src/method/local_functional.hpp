// A functional (functional.hpp) as a function of the positions of some nodes, all others fixed where they are: the
// functional of the elements around these nodes, so that energy, derivatives and linear systems cost as much as on a
// mesh of that size. Vectors and matrices have entries for the nodes that move only, in a numbering of their own.
#pragma once
#include <memory>
#include <vector>

#include "linalg/block_csr.hpp"
#include "mesh/restriction.hpp"
#include "method/functional.hpp"

namespace almesh {

class LocalFunctional : public Functional {
public:
    // x: node_count x dim, a valid mesh. around: some of its nodes, energy: of the elements there.
    LocalFunctional(const AugmentedFunctional& E, const std::vector<double>& x, Restriction around,
                    std::unique_ptr<DistortionEnergy> energy);

    int nodes() const { return around_.moving; }
    // Copies the positions of the nodes that move from, and to, an array x of the whole functional.
    std::vector<double> read(const std::vector<double>& x) const { return around_.read(x, dim_); }
    void write(const std::vector<double>& y, std::vector<double>& x) const { around_.write(y, dim_, x); }

    double energy(const std::vector<double>& y) const override { return E_.energy(with_fixed(y, at_)); }
    double distortion_energy(const std::vector<double>& y, double energy) const override {
        return E_.distortion_energy(with_fixed(y, at_), energy);
    }
    double valid_fraction(const std::vector<double>& y, const std::vector<double>& to) const override {
        return distortion.valid_fraction(with_fixed(y, at_), with_fixed(to, to_));
    }
    bool refine_quadrature(const std::vector<double>& y) const override {
        return Functional::refine_quadrature(with_fixed(y, at_));
    }
    // Of the elements around.
    DistortionStatistics statistics(const std::vector<double>& y) const {
        return distortion.statistics(with_fixed(y, at_));
    }
    double rounding_error(const std::vector<double>& y, std::vector<double>&) const override {
        return E_.rounding_error(with_fixed(y, at_), g_);
    }
    void gradient(const std::vector<double>& y, std::vector<double>& g) const override;
    BlockCsr hessian_pattern() const;
    void hessian(const std::vector<double>& y, HessianKind kind, BlockCsr& H,
                 const Projection& projection = {}) const override;
    std::unique_ptr<LocalFunctional> part(const std::vector<double>& y, std::vector<char> moves) const override;

private:
    Restriction around_;
    std::unique_ptr<DistortionEnergy> energy_;
    std::vector<double> lambda_;
    std::unique_ptr<Constraint> constraint_;
    AugmentedFunctional E_;  // of all nodes of the elements; up to a constant that of the whole
    int dim_;
    mutable std::vector<double> at_, to_, g_;
    mutable BlockCsr H_;

    static const std::vector<double>& with_fixed(const std::vector<double>& y, std::vector<double>& all) {
        std::copy(y.begin(), y.end(), all.begin());
        return all;
    }
};

}  // namespace almesh
