// What plain and SIMD assembly of the energy share: see the formulas of distortion_energy.hpp.
#include "energy/distortion_energy.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "energy/densities.hpp"
#include "energy/plain_energy.hpp"
#include "energy/simd_energy.hpp"

namespace almesh {

DistortionEnergy::DistortionEnergy(const DistortionParams& params, const Mesh& mesh)
    : params_(params),
      dim_(mesh.dim),
      element_count_(mesh.element_count()),
      quadrature_(element_quadrature(mesh.dim, mesh.degree, params.exactness)),
      reference_(reference_element(mesh.degree, quadrature_)),
      valid_step_(mesh.dim, mesh.degree) {}

DistortionEnergy::DistortionEnergy(const DistortionEnergy& whole, int element_count)
    : params_(whole.params_),
      dim_(whole.dim_),
      element_count_(element_count),
      quadrature_(whole.quadrature_),
      reference_(whole.reference_),
      valid_step_(whole.valid_step_) {}

void DistortionEnergy::take_refined_of(const DistortionEnergy& whole) {
    for (const Refined& there : whole.refined_) {
        const auto here = std::find(place_in_whole_.begin(), place_in_whole_.end(), there.element);
        if (here == place_in_whole_.end()) continue;
        set_quadrature(static_cast<int>(here - place_in_whole_.begin()), there.quadrature);
    }
}

double DistortionEnergy::valid_fraction(const std::vector<double>& x, const std::vector<double>& to) {
    return params_.delta > 0 ? 1 : valid_step_.fraction(nodes_, element_count_, x, to, folds_);
}

bool DistortionEnergy::certified(const std::vector<double>& x) {
    std::vector<Fold> folds;
    return params_.delta > 0 || valid_step_.fraction(nodes_, element_count_, x, x, folds) == 1;
}

int DistortionEnergy::find_refined(int element) const {
    const auto is_it = [element](const Refined& refined) { return refined.element == element; };
    return static_cast<int>(std::find_if(refined_.begin(), refined_.end(), is_it) - refined_.begin());
}

void DistortionEnergy::set_quadrature(int element, std::shared_ptr<const RefinedQuadrature> quadrature) {
    const int r = find_refined(element);
    const bool is_new = r == refined_elements();
    if (is_new) refined_.push_back({element, nullptr});
    refined_[r].quadrature = std::move(quadrature);
    if (is_new) added_refined(r);
}

bool DistortionEnergy::refine(const Fold& fold) {
    const int r = find_refined(fold.element);
    RefinedRule finer = r < refined_elements() ? refined_[r].quadrature->rule : RefinedRule(dim_);
    if (!finer.refine(fold.at, fold.ratio)) return false;
    set_quadrature(fold.element,
                   std::make_shared<RefinedQuadrature>(std::move(finer), reference_.degree, quadrature_));
    refinements_.push_back(fold);
    return true;
}

bool DistortionEnergy::refine_quadrature() {
    bool changed = false;
    std::vector<int> seen;
    for (auto fold = folds_.rbegin(); fold != folds_.rend(); ++fold) {  // each element once, where it folded last
        if (std::find(seen.begin(), seen.end(), fold->element) != seen.end()) continue;
        seen.push_back(fold->element);
        changed = refine(*fold) || changed;
    }
    folds_.clear();
    return changed;
}

bool DistortionEnergy::take_over_refinements(const DistortionEnergy& part) {
    for (const Fold& fold : part.refinements_) {
        const int element = part.place_in_whole_[fold.element];
        set_quadrature(element, part.refined_[part.find_refined(fold.element)].quadrature);
        refinements_.push_back({element, fold.at, fold.ratio});
    }
    return !part.refinements_.empty();
}

void DistortionEnergy::set_quadrature(const QuadratureState& state) {
    for (std::size_t k = refinements_.size(); k < state.refinements.size(); ++k) refine(state.refinements[k]);
    folds_ = state.folds;
}

double DistortionEnergy::uniform(double eta) const {
    return volume_ * with_density(params_, [eta](auto density) { return density.f(eta); });
}

double DistortionEnergy::hessian_passes() const {
    constexpr double of_density = 125, of_entry = 0.2;  // at a point
    const double entries = static_cast<double>(reference_.nodes) * reference_.nodes * dim_ * dim_;
    double points = static_cast<double>(element_count_) * reference_.points;
    for (const Refined& refined : refined_) points += refined.quadrature->reference.points;
    return (of_density + of_entry * entries) * points;
}

double DistortionEnergy::mean_slope(double energy) const {
    const double mean = std::max(0.0, energy) / volume_;
    return with_density(params_, [mean](auto density) { return density.half_slope(mean); });
}

std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params) {
    if (params.assembly == Assembly::plain) return std::make_unique<PlainEnergy>(mesh, ideal, params);
    return std::make_unique<SimdEnergy>(mesh, ideal, params);
}

double damping_exponent(int dim, double weight_exponent) { return std::min(1.5 / dim, weight_exponent); }

SubMesh elements_around(const std::vector<int>& elements, int count, int m, const std::vector<char>& moves) {
    SubMesh part;
    for (int e = 0; e < count; ++e) {
        const int* const node = &elements[offset(e, m)];
        if (std::any_of(node, node + m, [&](int i) { return moves[i]; })) part.place.push_back(e);
    }
    std::vector<int> number(moves.size(), -1);  // node of the mesh -> node of the part
    for (const bool moving : {true, false})
        for (const int e : part.place)
            for (int i = 0; i < m; ++i) {
                const int node = elements[offset(e, m, i)];
                if (number[node] >= 0 || static_cast<bool>(moves[node]) != moving) continue;
                number[node] = static_cast<int>(part.node.size());
                part.node.push_back(node);
            }
    for (const int e : part.place)
        for (int i = 0; i < m; ++i) part.elements.push_back(number[elements[offset(e, m, i)]]);
    return part;
}

}  // namespace almesh
