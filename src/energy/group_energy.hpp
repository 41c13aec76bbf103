// The energy of elements of one type: all but its assembly (simd_energy.hpp; in the course lessons/plain_energy.hpp).
// Each element is integrated by the rule that element_rules.hpp has for it. Ideal elements that are no simplices have a
// Jacobian A of their own at each point, like curved ones.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "base/index.hpp"
#include "energy/distortion_energy.hpp"

namespace almesh {

class GroupEnergy : public DistortionEnergy {
public:
    std::unique_ptr<DistortionEnergy> part(const std::vector<double>& x, const std::vector<char>& moves,
                                           Restriction& around) const override;
    // Of these elements, among those of cell_nodes().
    virtual std::unique_ptr<GroupEnergy> part(const std::vector<double>& x, const Restriction& around) const = 0;
    CellNodes cell_nodes() const { return {nodes_.data(), element_count_, reference_.nodes}; }

    double valid_fraction(const std::vector<double>& x, const std::vector<double>& to) override {
        return params_.delta > 0 ? 1 : rules_.valid_fraction(nodes_, element_count_, x, to);
    }
    bool certified(const std::vector<double>& x) const override {
        return params_.delta > 0 || rules_.certified(nodes_, element_count_, x);
    }
    bool refine_quadrature(const std::vector<double>& x = {}) override { return rules_.refine(nodes_, x); }
    bool take_over_refinements(const DistortionEnergy& part) override {
        return rules_.take_over(static_cast<const GroupEnergy&>(part).rules_);
    }
    QuadratureState quadrature() const override { return rules_.state(); }
    void set_quadrature(const QuadratureState& state) override { rules_.set_state(state); }
    int refined_elements() const override { return static_cast<int>(rules_.refined().size()); }

    bool is_curved() const override { return !is_linear(); }
    double nodes_in_elements() const override { return static_cast<double>(element_count_) * reference_.nodes; }
    double hessian_work() const override;

    // For a mesh with several groups: w_e and w'_e are these units times |e|^(alpha - 1) and the like, and can be
    // scaled; the Hessian takes the pattern of the mesh, in which block b of pattern() is block place[b].
    int element_count() const { return element_count_; }
    const std::array<double, 2>& weight_units() const { return weight_units_; }
    virtual void scale_weights(const std::array<double, 2>& factor) = 0;
    const BlockCsr& pattern() const { return pattern_; }
    void use_pattern_of_mesh(const LargeVector<int>& place);
    void blocks_moved(const LargeVector<int>&) override {}

protected:
    // mesh: of one type of elements.
    GroupEnergy(const DistortionParams& params, const Mesh& mesh, const std::vector<double>& ideal);
    // Restriction of `whole`: element e and node i here are element place[e] and node node[i] there.
    GroupEnergy(const GroupEnergy& whole, const std::vector<int>& place, const std::vector<int>& node);
    const int* element(int e) const { return &nodes_[offset(e, reference_.nodes)]; }
    bool is_linear() const { return reference_.degree == 1 && reference_.cell->is_simplex(); }
    // Scales the weights det A^alpha so that the sums that `factor` comes from are |Omega|.
    void normalise_weights(const std::array<double, 2>& factor);

    int element_count_;
    ElementRules rules_;
    const ReferenceElement& reference_;  // that of most elements
    std::vector<int> nodes_;             // element_count x element nodes, or more
    std::vector<double> curved_ideal_;   // y, nodes x dim; empty where A is constant in each ideal element
    bool has_one_ideal_ = false;         // or y of one element, m x dim, of which all ideal elements are linear images

private:
    std::array<double, 2> weight_units_{};
};

// An element of the ideal mesh; det A of one that is curved or no simplex is its mean over the element.
struct IdealElement {
    std::array<double, 9> inverse;  // dim x dim, A^{-1} where it is constant
    double jacobian;                // det A
    double weight, damping_weight;  // w_e det A and w'_e det A, but for a factor that all elements have in common
};

// reference: the points over which the mean is taken. jacobian = 0 where det A is not positive at all of them.
IdealElement ideal_element(const Mesh& mesh, int e, const std::vector<double>& ideal, const DistortionParams& params,
                           const ReferenceElement& reference);

// Throws the InputError of an element of the ideal mesh whose Jacobian is not positive.
[[noreturn]] void refuse_ideal_element(const Mesh& mesh, int e);

}  // namespace almesh
