// The quadrature rule of each element: one for all, and finer ones for curved elements that came near inverting.
//
// Cells that are no simplices, but for linear pyramids, have few points, exact for |F|^2 where A is constant (p + 1 in
// each direction) and none at the nodes, until they are bent, and then for good the usual ones.
//
// The energy sees curved elements at the points of its quadrature only. valid_fraction() tells how far a step may go
// (valid_step.hpp), and elements that it would have inverted unseen get a finer rule (refined_rule.hpp) when refine()
// is called, for good. The assembly of the energy asks for the rule of an element without knowing its history.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "energy/options.hpp"
#include "energy/valid_step.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

struct ElementRule {
    ReferenceElement reference;  // its weights are those of the energy
    std::vector<double> volume;  // per point: its weight in an integral over the element
};

struct RefinedQuadrature;  // an ElementRule, and how it was made: refined_rule.hpp

// Near inversions of elements: those for which rules were refined, and those for the next refinement.
struct QuadratureState {
    std::vector<Inversion> refinements, inversions;
};

class ElementRules {
public:
    struct Refined {
        int element;
        std::shared_ptr<const RefinedQuadrature> rule;
    };

    ElementRules(const CellType& cell, int degree, const DistortionParams& params, int count);
    // Restriction to some elements: element e there is place[e] here. It takes over their rules, but not state().
    ElementRules part(const std::vector<int>& place) const;

    const ElementRule& plain() const { return *plain_; }  // of simplices the usual one
    const ElementRule& usual() const { return *usual_; }
    bool is_bent(int element) const { return has_plain() && bent_[element]; }
    bool some_bent() const { return some_bent_; }
    const ElementRule& of(int element, bool usual = false) const;  // usual: as if it were bent
    const std::vector<Refined>& refined() const { return refined_; }  // elements with a finer rule, oldest first

    // The largest s <= 1 found so that all elements are valid along (1 - r) x + r to for 0 <= r <= s. nodes: count x m.
    // Notes where elements would invert.
    double valid_fraction(const std::vector<int>& nodes, int count, const std::vector<double>& x,
                          const std::vector<double>& to) {
        return valid_step_.fraction(nodes, count, x, to, state_.inversions);
    }
    bool certified(const std::vector<int>& nodes, int count, const std::vector<double>& x) const;

    // Finer rules for the elements that are bent at x, or that steps were cut for since the last call: the usual one,
    // for the latter, if they have it, one of their own. Whether there are any. x: empty, or nodes: element x m.
    bool refine(const std::vector<int>& nodes, const std::vector<double>& x);
    // The refinements of a part since it was made. Whether there are any.
    bool take_over(const ElementRules& part);
    const QuadratureState& state() const { return state_; }
    void set_state(const QuadratureState& state);  // its refinements must begin with those here; none is bent then

private:
    const CellType* cell_;
    Quadrature of_pieces_;
    std::shared_ptr<const ElementRule> usual_, plain_;
    ValidStep valid_step_;
    std::vector<int> place_in_whole_;  // of a part
    std::vector<Refined> refined_;
    std::vector<char> bent_;  // per element; empty where there is no plain rule
    bool some_bent_ = false;
    QuadratureState state_;

    bool has_plain() const { return plain_ != usual_; }
    bool bend(int element) {  // whether it was not bent
        return has_plain() && std::exchange(bent_[element], 1) == 0 && (some_bent_ = true);
    }
    bool refine(const Inversion& inversion);
    const RefinedQuadrature* find(int element) const;  // or none
    void set(int element, std::shared_ptr<const RefinedQuadrature> rule);
};

}  // namespace almesh
