#include "energy/group_energy.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "mesh/regular_cell.hpp"

namespace almesh {
namespace {

// 0 if det A is not positive at some point.
template <int n>
double mean_jacobian(const int* node, const std::vector<double>& y, const ReferenceElement& reference) {
    double sum = 0;
    for (int q = 0; q < reference.points; ++q) {
        const double jacobian = determinant(jacobian_at<n>(node, y, reference, q));
        if (!(jacobian > 0)) return 0;
        sum += reference.weight[q] * jacobian;
    }
    return sum / reference.cell->volume();
}

// Exponents of |e| in w_e |e| and w'_e |e|: alpha; and 3/(2n), which is the power 3/2 of the element's size, or alpha
// if that is less.
std::array<double, 2> weight_exponents(const DistortionParams& params, int dim) {
    return {params.weight_exponent, std::min(1.5 / dim, params.weight_exponent)};
}

}  // namespace

GroupEnergy::GroupEnergy(const DistortionParams& params, const Mesh& mesh, const std::vector<double>& ideal)
    : DistortionEnergy(params, mesh.dim),
      element_count_(mesh.element_count()),
      rules_(mesh.cell(), mesh.degree, params, element_count_),
      reference_(rules_.plain().reference) {
    has_one_ideal_ = !params.regular.empty() && mesh.cell().is_collapsed;
    params_.curved_ideal = params.regular.empty() && (params.curved_ideal || !mesh.cell().is_simplex());
    if (params_.curved_ideal) curved_ideal_ = ideal;
    if (has_one_ideal_) curved_ideal_ = regular_nodes(mesh.cell(), mesh.degree);
}

GroupEnergy::GroupEnergy(const GroupEnergy& whole, const std::vector<int>& place, const std::vector<int>& node)
    : DistortionEnergy(whole.params_, whole.dim_),
      element_count_(static_cast<int>(place.size())),
      rules_(whole.rules_.part(place)),
      reference_(rules_.plain().reference),
      has_one_ideal_(whole.has_one_ideal_) {
    const bool has_nodes = !has_one_ideal_ && !whole.curved_ideal_.empty();
    curved_ideal_ = has_nodes ? at_nodes(node, whole.curved_ideal_, dim_) : whole.curved_ideal_;
}

std::unique_ptr<DistortionEnergy> GroupEnergy::part(const std::vector<double>& x, const std::vector<char>& moves,
                                                    Restriction& around) const {
    around = restriction_to(moves, std::vector{cell_nodes()});
    return part(x, around);
}

double GroupEnergy::hessian_work() const {
    constexpr double of_density = 125, of_entry = 0.2;  // at a point
    const double entries = static_cast<double>(reference_.nodes) * reference_.nodes * dim_ * dim_;
    double points = static_cast<double>(element_count_) * reference_.points;
    for (const auto& refined : rules_.refined()) points += rules_.of(refined.element).reference.points;
    return (of_density + of_entry * entries) * points;
}

// So far the weights are det A^a = (|e| / v)^a, v the volume of the reference cell, instead of |e|^a / v.
void GroupEnergy::normalise_weights(const std::array<double, 2>& factor) {
    scale_weights(factor);
    const std::array<double, 2> exponents = weight_exponents(params_, dim_);
    for (int k = 0; k < 2; ++k)
        weight_units_[k] = factor[k] * std::pow(reference_.cell->volume(), 1 - exponents[k]);
}

void GroupEnergy::use_pattern_of_mesh(const LargeVector<int>& place) {
    blocks_moved(place);
    pattern_ = {};
}

IdealElement ideal_element(const Mesh& mesh, int e, const std::vector<double>& ideal, const DistortionParams& params,
                           const ReferenceElement& reference) {
    IdealElement result{};
    with_dimension(mesh.dim, [&](auto n) {
        const bool has_map = params.regular.size() > offset(mesh.element_count(), 1);
        Mat<n> A = params.regular.empty() ? straight_jacobian<n>(mesh.element(e), ideal)
                                          : regular_jacobian<n>(mesh.cell(e), has_map ? mesh.cell(e).volume()
                                                                                      : params.regular[e]);
        if (has_map) A = multiply<n>(matrix_at<n>(params.regular, e), A);
        const Mat<n> inverse_of_A = inverse<n>(A);
        const std::array<double, 2> exponents = weight_exponents(params, mesh.dim);
        result.jacobian = params.curved_ideal ? mean_jacobian<n>(mesh.element(e), ideal, reference) : determinant(A);
        result.weight = std::pow(result.jacobian, exponents[0]);
        result.damping_weight = std::pow(result.jacobian, exponents[1]);
        for (int i = 0; i < n; ++i) std::copy_n(inverse_of_A[i].begin(), n(), &result.inverse[i * n]);
    });
    return result;
}

void refuse_ideal_element(const Mesh& mesh, int e) {
    throw InputError("element ", mesh.file.element_id[e], " of the ideal mesh has no positive volume");
}

}  // namespace almesh
