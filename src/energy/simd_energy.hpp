// The distortion energy as runs compute it: elements are worked on in batches, one in each lane of the vector
// registers (linear_batch.hpp, curved_batch.hpp), and in scheduled blocks (element_blocks.hpp), so that the bits are
// the same for any number of threads. The second derivatives of the density are known in closed form, and so is their
// eigensystem for the projected Hessian (density_hessian.hpp).
//
// Cost per quadrature point and element with m nodes: O(m n^2) for the energy, O(M n^4) for the Hessian, M: powers of
// degree 2 p - 2 (gradient_products.hpp), which are made into its m^2 blocks at about the same cost; O(m^2 n^3)
// of cells that are no simplices. Memory per element: 4 m (m + 1) + 8 n^2 + 28 bytes.
#pragma once
#include <memory>
#include <vector>

#include "base/lanes.hpp"
#include "base/large_array.hpp"
#include "energy/element_blocks.hpp"
#include "energy/gradient_products.hpp"
#include "energy/group_energy.hpp"

namespace almesh {

class SimdEnergy : public GroupEnergy {
public:
    SimdEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params);

    double energy(const std::vector<double>& x) override;
    void add_gradient(const std::vector<double>& x, std::vector<double>& g) override;
    void add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                     const Projection& projection = {}) override;
    DistortionStatistics statistics(const std::vector<double>& x) override;
    using GroupEnergy::part;
    std::unique_ptr<GroupEnergy> part(const std::vector<double>& x, const Restriction& around) const override;
    void scale_weights(const std::array<double, 2>& factor) override;
    void blocks_moved(const LargeVector<int>& place) override;

private:
    // The elements `place` of `whole`, as the mesh `part`; both in the order of `blocks`.
    SimdEnergy(const SimdEnergy& whole, const Mesh& part, ElementBlocks blocks, const std::vector<int>& place,
               const std::vector<int>& node);

    // An element with a rule of its own, in all lanes, with the points of the rule in lanes. It has no weight in its
    // batch.
    struct Single {
        IdealElement ideal;
        std::vector<int> nodes;            // lanes x element nodes
        std::vector<Lanes> ideal_inverse;  // dim x dim
    };

    std::shared_ptr<const GradientProducts> products_;
    ElementBlocks blocks_;
    // By place in blocks_.order, as nodes_ and rules_, filled up to whole batches with copies of the last element that
    // weigh nothing:
    // element x element node x element node: block of the pattern. Where half of the Hessian is stored, for two nodes
    // a > b of each element: twice the block of both, and 1 more where b has its row.
    LargeVector<int> hessian_block_;
    int targets_;                        // of these numbers for each element
    LargeVector<Lanes> ideal_inverse_;   // batch x dim x dim, A^{-1} where it is constant
    std::vector<Lanes> ideal_jacobian_;  // batch, det A
    std::vector<Lanes> weight_;          // batch, w_e det A
    std::vector<Lanes> damping_weight_;  // batch, w'_e det A
    std::vector<Single> singles_;        // the first of rules_.refined()
    std::vector<double> of_refined_;     // what has been computed for some of them
    bool is_large_;                      // worth more than one thread
    std::vector<double> block_value_;    // sum of each block of elements

    template <class ElementOf>
    void fill(const Mesh& mesh, const ElementOf& element_of);
    void set_ideal(int place, const IdealElement& of);
    IdealElement ideal_at(int place) const;
    double integral(const std::vector<Lanes>& values) const;
    void take_refined_out();
    template <class Body>
    void dispatch(const Body& body);
    template <class Batch, class Body>
    void every_batch(int block, const std::vector<double>& x, const Body& body, bool usual = false);
    template <class Compute, class Add>
    void every_refined(const std::vector<double>& x, int size, const Compute& compute, const Add& add);
};

}  // namespace almesh
