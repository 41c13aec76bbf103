#include "energy/element_rules.hpp"

#include <algorithm>

#include "energy/refined_rule.hpp"

namespace almesh {
namespace {

template <class Items>
auto find_element(Items& items, int element) {
    return std::find_if(items.begin(), items.end(), [element](const auto& item) { return item.element == element; });
}

}  // namespace

ElementRules::ElementRules(const CellType& cell, int degree, int exactness)
    : cell_(&cell),
      of_pieces_(RefinedRule::of_pieces(cell, degree, exactness)),
      valid_step_(cell, degree) {
    const Quadrature rule = element_quadrature(cell, degree, exactness);
    common_ = std::make_shared<ElementRule>(ElementRule{reference_element(cell, degree, rule), rule.weight});
}

ElementRules ElementRules::part(const std::vector<int>& place) const {
    ElementRules of_part = *this;
    of_part.place_in_whole_ = place;
    of_part.refined_.clear();
    of_part.state_ = {};
    for (const Refined& there : refined_) {
        const auto here = std::find(place.begin(), place.end(), there.element);
        if (here != place.end()) of_part.set(static_cast<int>(here - place.begin()), there.rule);
    }
    return of_part;
}

const RefinedQuadrature* ElementRules::find(int element) const {
    const auto refined = find_element(refined_, element);
    return refined == refined_.end() ? nullptr : refined->rule.get();
}

void ElementRules::set(int element, std::shared_ptr<const RefinedQuadrature> rule) {
    const auto refined = find_element(refined_, element);
    if (refined == refined_.end()) refined_.push_back({element, std::move(rule)});
    else refined->rule = std::move(rule);
}

const ElementRule& ElementRules::of(int element) const {
    const RefinedQuadrature* const refined = find(element);
    return refined ? *refined : *common_;
}

bool ElementRules::certified(const std::vector<int>& nodes, int count, const std::vector<double>& x) const {
    std::vector<Inversion> inversions;
    return valid_step_.fraction(nodes, count, x, x, inversions) == 1;
}

bool ElementRules::refine(const Inversion& inversion) {
    const RefinedQuadrature* const before = find(inversion.element);
    RefinedRule finer = before ? before->rule : RefinedRule(*cell_);
    if (!finer.refine(inversion.at, inversion.ratio)) return false;
    set(inversion.element, std::make_shared<RefinedQuadrature>(std::move(finer), common().degree, of_pieces_));
    state_.refinements.push_back(inversion);
    return true;
}

// Each element once, where it would have inverted last.
bool ElementRules::refine() {
    bool changed = false;
    std::vector<Inversion> last;
    for (auto inversion = state_.inversions.rbegin(); inversion != state_.inversions.rend(); ++inversion) {
        if (find_element(last, inversion->element) != last.end()) continue;
        last.push_back(*inversion);
        changed = refine(*inversion) || changed;
    }
    state_.inversions.clear();
    return changed;
}

bool ElementRules::take_over(const ElementRules& part) {
    for (Inversion inversion : part.state_.refinements) {
        const auto there = find_element(part.refined_, inversion.element);
        inversion.element = part.place_in_whole_[inversion.element];
        set(inversion.element, there->rule);
        state_.refinements.push_back(inversion);
    }
    return !part.state_.refinements.empty();
}

void ElementRules::set_state(const QuadratureState& state) {
    for (std::size_t k = state_.refinements.size(); k < state.refinements.size(); ++k) refine(state.refinements[k]);
    state_.inversions = state.inversions;
}

}  // namespace almesh
