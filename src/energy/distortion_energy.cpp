// What plain and SIMD assembly of the energy share: see the formulas of distortion_energy.hpp.
#include "energy/distortion_energy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "energy/densities.hpp"
#include "energy/plain_energy.hpp"
#include "energy/simd_energy.hpp"

namespace almesh {

namespace {

template <int n>
double mean_jacobian(const int* node, const std::vector<double>& y, const ReferenceElement& reference) {
    double sum = 0;
    for (int q = 0; q < reference.points; ++q)
        sum += reference.weight[q] * determinant(jacobian_at<n>(node, y, reference, q));
    return sum / simplex(n).volume();
}

}  // namespace

DistortionEnergy::DistortionEnergy(const DistortionParams& params, const Mesh& mesh, const std::vector<double>& ideal)
    : params_(params),
      dim_(mesh.dim),
      element_count_(mesh.element_count()),
      rules_(mesh.dim, mesh.degree, params.exactness),
      reference_(rules_.common()) {
    if (params.curved_ideal) curved_ideal_ = ideal;
}

DistortionEnergy::DistortionEnergy(const DistortionEnergy& whole, const std::vector<int>& place,
                                   const std::vector<int>& node)
    : params_(whole.params_),
      dim_(whole.dim_),
      element_count_(static_cast<int>(place.size())),
      rules_(whole.rules_.part(place)),
      reference_(rules_.common()) {
    if (whole.curved_ideal_.empty()) return;
    for (const int i : node) {
        const double* const y = point(whole.curved_ideal_, i, dim_);
        curved_ideal_.insert(curved_ideal_.end(), y, y + dim_);
    }
}

BlockCsr DistortionEnergy::hessian_pattern() const {
    BlockCsr H = pattern_;
    H.value.assign(H.col.size() * H.d * H.d, 0.0);
    return H;
}

void DistortionEnergy::order_hessian(const ChooseOrder& choose) {
    auto order = choose(pattern_);
    if (!order) return;
    LargeVector<int> place;
    pattern_ = ordered_pattern(pattern_, std::move(order), place);
    blocks_moved(place);
}

double DistortionEnergy::uniform(double eta) const {
    return volume_ * with_density(params_, [eta](auto density) { return density.f(eta); });
}

double DistortionEnergy::mean_slope(double energy) const {
    const double mean = std::max(0.0, energy) / volume_;
    return with_density(params_, [mean](auto density) { return density.half_slope(mean); });
}

double DistortionEnergy::hessian_work() const {
    constexpr double of_density = 125, of_entry = 0.2;  // at a point
    const double entries = static_cast<double>(reference_.nodes) * reference_.nodes * dim_ * dim_;
    double points = static_cast<double>(element_count_) * reference_.points;
    for (const auto& refined : rules_.refined()) points += rules_.of(refined.element).reference.points;
    return (of_density + of_entry * entries) * points;
}

std::unique_ptr<DistortionEnergy> make_energy(const Mesh& mesh, const std::vector<double>& ideal,
                                              const DistortionParams& params) {
    if (params.assembly == Assembly::plain) return std::make_unique<PlainEnergy>(mesh, ideal, params);
    return std::make_unique<SimdEnergy>(mesh, ideal, params);
}

IdealElement ideal_element(const Mesh& mesh, int e, const std::vector<double>& ideal, const DistortionParams& params,
                           const ReferenceElement& reference) {
    IdealElement of{};
    with_dimension(mesh.dim, [&](auto n) {
        const Mat<n> A = straight_jacobian<n>(mesh.element(e), ideal), inverse_of_A = inverse<n>(A);
        // Of |e| in w'_e |e|: 3/(2n), in 2D and 3D the power 3/2 of the element's size, or alpha if that is less.
        const double exponent = std::min(1.5 / mesh.dim, params.weight_exponent);
        of.jacobian = params.curved_ideal ? mean_jacobian<n>(mesh.element(e), ideal, reference) : determinant(A);
        of.weight = std::pow(of.jacobian, params.weight_exponent);
        of.damping_weight = std::pow(of.jacobian, exponent);
        for (int i = 0; i < n; ++i) std::copy_n(inverse_of_A[i].begin(), n(), &of.inverse[i * n]);
    });
    return of;
}

void refuse_ideal_element(const Mesh& mesh, int e) {
    throw InputError("element ", mesh.file.element_id[e], " of the ideal mesh has no positive volume");
}

}  // namespace almesh
