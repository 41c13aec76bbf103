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

ElementRules::ElementRules(const CellType& cell, int degree, const DistortionParams& params, int count)
    : cell_(&cell),
      of_pieces_(RefinedRule::of_pieces(cell, degree, params.exactness)),
      valid_step_(cell, degree) {
    const auto made_of = [&](const Quadrature& rule) {
        return std::make_shared<ElementRule>(ElementRule{reference_element(cell, degree, rule), rule.weight});
    };
    usual_ = plain_ = made_of(element_quadrature(cell, degree, params.exactness));
    const bool is_smooth = params.objective != Objective::minimax && params.objective != Objective::tangled;
    const bool may_be_bent = !cell.is_simplex() && (!cell.is_collapsed || degree > 1);
    if (may_be_bent && params.exactness == 0 && params.delta == 0 && params.regular.empty() && is_smooth)
        plain_ = made_of(cell_quadrature(cell, 2 * degree));
    bent_.resize(has_plain() ? count : 0, 0);
}

ElementRules ElementRules::part(const std::vector<int>& place) const {
    ElementRules of_part = *this;
    of_part.place_in_whole_ = place;
    of_part.refined_.clear();
    of_part.state_ = {};
    of_part.bent_.clear();
    for (std::size_t k = 0; k < place.size() && has_plain(); ++k) of_part.bent_.push_back(bent_[place[k]]);
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

const ElementRule& ElementRules::of(int element, bool usual) const {
    const RefinedQuadrature* const refined = find(element);
    return refined ? *refined : usual || is_bent(element) ? *usual_ : *plain_;
}

bool ElementRules::certified(const std::vector<int>& nodes, int count, const std::vector<double>& x) const {
    std::vector<Inversion> inversions;
    return valid_step_.fraction(nodes, count, x, x, inversions) == 1;
}

bool ElementRules::refine(const Inversion& inversion) {
    const RefinedQuadrature* const before = find(inversion.element);
    RefinedRule finer = before ? before->rule : RefinedRule(*cell_);
    if (!finer.refine(inversion.at, inversion.ratio)) return false;
    set(inversion.element, std::make_shared<RefinedQuadrature>(std::move(finer), usual().reference.degree, of_pieces_));
    state_.refinements.push_back(inversion);
    return true;
}

// Each element once, where it would have inverted last.
bool ElementRules::refine(const std::vector<int>& nodes, const std::vector<double>& x) {
    bool changed = has_plain() && !x.empty() && valid_step_.add_bent(nodes, x, bent_);
    some_bent_ = some_bent_ || changed;
    std::vector<Inversion> last;
    for (auto inversion = state_.inversions.rbegin(); inversion != state_.inversions.rend(); ++inversion) {
        if (find_element(last, inversion->element) != last.end()) continue;
        last.push_back(*inversion);
        changed = bend(inversion->element) || refine(*inversion) || changed;
    }
    state_.inversions.clear();
    return changed;
}

bool ElementRules::take_over(const ElementRules& part) {
    bool changed = !part.state_.refinements.empty();
    for (std::size_t k = 0; k < part.bent_.size(); ++k)
        if (part.bent_[k]) changed = bend(part.place_in_whole_[k]) || changed;
    for (Inversion inversion : part.state_.refinements) {
        const auto there = find_element(part.refined_, inversion.element);
        inversion.element = part.place_in_whole_[inversion.element];
        set(inversion.element, there->rule);
        state_.refinements.push_back(inversion);
    }
    return changed;
}

void ElementRules::set_state(const QuadratureState& state) {
    for (std::size_t k = state_.refinements.size(); k < state.refinements.size(); ++k) refine(state.refinements[k]);
    state_.inversions = state.inversions;
    std::fill(bent_.begin(), bent_.end(), 0);
    some_bent_ = false;
}

}  // namespace almesh
