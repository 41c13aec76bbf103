// Assembly of E, its gradient and its Hessian (distortion_energy.hpp), one element per SIMD lane: blocks of elements
// in schedule order -> batches of `lanes` elements -> sums, gradients and Hessian blocks in closed form -> the global
// arrays.
#include "energy/simd_energy.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "energy/curved_batch.hpp"
#include "energy/linear_batch.hpp"
#include "energy/refined_rule.hpp"

namespace almesh {
namespace {

constexpr int refined_at_once = 64;  // refined elements whose Hessians are kept until they are added

// Asks for the blocks to come: a block may straddle two cache lines.
template <int size>
void prefetch_blocks(const double* values, const int* block, int count) {
    for (int k = 0; k < count; ++k) {
        const double* const first = values + offset(block[k], size);
        __builtin_prefetch(first, 1);
        __builtin_prefetch(first + size - 1, 1);
    }
}

// to += part, blocks of `size` numbers. The block is loaded whole, then stored: they cannot alias.
template <int size, class Number>
void add_block(const double* part, Number* to) {
    Number sum[size];
    for (int e = 0; e < size; ++e) sum[e] = static_cast<Number>(to[e] + part[e]);
    std::copy_n(sum, size, to);
}

}  // namespace

SimdEnergy::SimdEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : GroupEnergy(params, mesh, ideal),
      products_(std::make_shared<GradientProducts>(
          mesh.cell().is_simplex() ? GradientProducts(dim_, mesh.degree) : GradientProducts())),
      blocks_(schedule_elements(mesh)) {
    fill(mesh, [&](int k) { return ideal_element(mesh, blocks_.order[k], ideal, params_, rules_.usual().reference); });
    int flat = element_count_;  // first element without volume
    for (int k = 0; k < element_count_; ++k)
        if (!(ideal_jacobian_[k / lanes][k % lanes] > 0)) flat = std::min(flat, blocks_.order[k]);
    if (flat < element_count_) refuse_ideal_element(mesh, flat);
    normalise_weights({volume_ / integral(weight_), volume_ / integral(damping_weight_)});
}

void SimdEnergy::scale_weights(const std::array<double, 2>& factor) {
    for (Lanes& weight : weight_) weight *= factor[0];
    for (Lanes& weight : damping_weight_) weight *= factor[1];
}

SimdEnergy::SimdEnergy(const SimdEnergy& whole, const Mesh& part, ElementBlocks blocks, const std::vector<int>& place,
                       const std::vector<int>& node)
    : GroupEnergy(whole, place, node), products_(whole.products_), blocks_(std::move(blocks)) {
    fill(part, [&](int k) { return whole.ideal_at(place[k]); });
}

std::unique_ptr<GroupEnergy> SimdEnergy::part(const std::vector<double>& x, const Restriction& around) const {
    Mesh mesh;
    mesh.dim = dim_;
    mesh.degree = reference_.degree;
    mesh.elements = around.elements;
    if (!reference_.cell->is_simplex())
        mesh.groups = {{reference_.cell, 0, static_cast<int>(around.element.size()), 0}};
    mesh.x = at_nodes(around.node, x, dim_);
    ElementBlocks blocks = schedule_elements(mesh);
    std::vector<int> place;
    for (const int e : blocks.order) place.push_back(around.element[e]);
    return std::unique_ptr<SimdEnergy>(new SimdEnergy(*this, mesh, std::move(blocks), place, around.node));
}

// element_of(k): the element blocks_.order[k] of the ideal mesh. What fills up the last batch weighs nothing.
template <class ElementOf>
void SimdEnergy::fill(const Mesh& mesh, const ElementOf& element_of) {
    const int m = reference_.nodes, batches = (element_count_ + lanes - 1) / lanes;
    block_value_.resize(blocks_.count());
    targets_ = m * m;
    nodes_.resize(offset(batches, lanes * m));
    ideal_inverse_.resize(offset(batches, dim_ * dim_));
    for (std::vector<Lanes>* values : {&ideal_jacobian_, &weight_, &damping_weight_}) values->resize(batches);
    is_large_ = static_cast<double>(element_count_) * reference_.points * m >= parallel_work;
    // A batch is one thread's: to write a lane may be to write the whole register.
    parallel_for(batches, [&](int batch) {
        for (int lane = 0; lane < lanes; ++lane) {
            const int k = batch * lanes + lane, last = std::min(k, element_count_ - 1);
            std::copy_n(mesh.element(blocks_.order[last]), m, &nodes_[offset(k, m)]);
            IdealElement of = element_of(last);
            if (k > last) of.jacobian = of.weight = of.damping_weight = 0;
            set_ideal(k, of);
        }
    }, 10.0 * lanes);
    volume_ = integral(ideal_jacobian_);
    pattern_ = pattern_of_cells(mesh.nodes(), dim_, nodes_, m, &hessian_block_);
}

void SimdEnergy::set_ideal(int place, const IdealElement& of) {
    const int batch = place / lanes, lane = place % lanes;
    for (int ij = 0; ij < dim_ * dim_; ++ij) ideal_inverse_[offset(batch, dim_ * dim_, ij)][lane] = of.inverse[ij];
    ideal_jacobian_[batch][lane] = of.jacobian;
    weight_[batch][lane] = of.weight;
    damping_weight_[batch][lane] = of.damping_weight;
}

IdealElement SimdEnergy::ideal_at(int place) const {
    for (std::size_t r = 0; r < singles_.size(); ++r)  // these weigh nothing in their batch
        if (rules_.refined()[r].element == place) return singles_[r].ideal;
    const int batch = place / lanes, lane = place % lanes;
    IdealElement of{{}, ideal_jacobian_[batch][lane], weight_[batch][lane], damping_weight_[batch][lane]};
    for (int ij = 0; ij < dim_ * dim_; ++ij) of.inverse[ij] = ideal_inverse_[offset(batch, dim_ * dim_, ij)][lane];
    return of;
}

// Elements that have got a rule of their own since the last evaluation leave their batches.
void SimdEnergy::take_refined_out() {
    while (singles_.size() < rules_.refined().size()) {
        const int place = rules_.refined()[singles_.size()].element;
        const IdealElement ideal = ideal_at(place);
        Single single{ideal, {}, {}};
        for (int l = 0; l < lanes; ++l)
            single.nodes.insert(single.nodes.end(), element(place), element(place) + reference_.nodes);
        for (int ij = 0; ij < dim_ * dim_; ++ij) single.ideal_inverse.push_back(in_all_lanes(ideal.inverse[ij]));
        singles_.push_back(std::move(single));
        set_ideal(place, {ideal.inverse, 0, 0, 0});
    }
}

// Of a function that is constant on each element, times det A: per batch.
double SimdEnergy::integral(const std::vector<Lanes>& values) const {
    const auto of_element = [&](int k) { return values[k / lanes][k % lanes]; };
    return reference_.cell->volume() * deterministic_sum(element_count_, of_element);
}

void SimdEnergy::blocks_moved(const LargeVector<int>& place) {
    const int m = reference_.nodes, mm = m * m;
    const bool half = place[hessian_block_.front()] < 0;  // a block of the diagonal
    targets_ = half ? m * (m - 1) / 2 : mm;
    LargeVector<int> moved(offset(element_count_, targets_));
    parallel_for(element_count_, [&](int e) {
        const int* const block = &hessian_block_[offset(e, mm)];
        int* to = &moved[offset(e, targets_)];
        for (int k = 0; k < mm; ++k) {
            const int a = k / m, b = k % m, here = place[block[k]];
            if (!half) *to++ = here;
            else if (b < a) *to++ = here >= 0 ? 2 * here : 2 * place[block[b * m + a]] + 1;
        }
    }, m);
    hessian_block_ = std::move(moved);
}

// Begins an evaluation. body(std::type_identity<Batch>): the batch for elements of this dimension and degree.
template <class Body>
void SimdEnergy::dispatch(const Body& body) {
    take_refined_out();
    with_dimension(dim_, [&](auto n) {
        if (is_linear()) body(std::type_identity<LinearBatch<n()>>());
        else body(std::type_identity<CurvedBatch<n()>>());
    });
}

// body(batch of elements, its number, 1 for elements with the rule at work and 0 for others) for the batches of a
// block, in order: with the rule of plain elements, then with that of bent ones, or with the usual rule for all.
template <class Batch, class Body>
void SimdEnergy::every_batch(int block, const std::vector<double>& x, const Body& body, bool usual) {
    constexpr int n = Batch::dimension;
    const int last = element_count_ - 1, end = std::min(last + 1, (block + 1) * blocks_.size);
    const bool all = usual || !rules_.some_bent();
    for (const bool bent : {false, true}) {
        if (bent && all) break;
        Batch elements((usual || bent ? rules_.usual() : rules_.plain()).reference, *products_);
        for (int k = block * blocks_.size; k < end; k += lanes) {
            const int batch = k / lanes;
            Lanes part = in_all_lanes(1);
            for (int l = 0; l < lanes && !all; ++l) part[l] = rules_.is_bent(std::min(k + l, last)) == bent;
            if (!all && !any(part > 0)) continue;
            elements.start(&nodes_[offset(k, reference_.nodes)], x,
                           {reinterpret_cast<const Mat<n, Lanes>&>(ideal_inverse_[offset(batch, n * n)]),
                            ideal_jacobian_[batch], curved_ideal_, has_one_ideal_});
            body(elements, batch, part);
        }
    }
}

// compute(element, r, to) makes `size` numbers of the refined element r, a CurvedBatch of its own, those with the
// longest rules first; add(r, from) takes them, for one r after the other.
template <class Compute, class Add>
void SimdEnergy::every_refined(const std::vector<double>& x, int size, const Compute& compute, const Add& add) {
    const int count = refined_elements();
    of_refined_.resize(std::max(of_refined_.size(), offset(std::min(count, refined_at_once), size)));
    with_dimension(dim_, [&](auto n) {
        for (int first = 0; first < count; first += refined_at_once) {
            const int end = std::min(count, first + refined_at_once);
            std::array<int, refined_at_once> order;
            std::iota(order.begin(), order.end(), first);
            const auto points_of = [&](int r) { return rules_.refined()[r].rule->reference.points; };
            std::sort(order.begin(), order.begin() + (end - first),
                      [&](int r, int s) { return points_of(r) > points_of(s); });
            const auto compute_one = [&](int k) {
                const int r = order[k];
                CurvedBatch<n(), PointLanes> element(rules_.refined()[r].rule->lanes, *products_);
                element.start(singles_[r].nodes.data(), x,
                              {reinterpret_cast<const Mat<n(), Lanes>&>(singles_[r].ideal_inverse.front()),
                               in_all_lanes(singles_[r].ideal.jacobian), curved_ideal_, has_one_ideal_});
                compute(element, r, &of_refined_[offset(r - first, size)]);
            };
            parallel_for_uneven(end - first, compute_one, 10.0 * points_of(order[0]) * reference_.nodes);
            for (int r = first; r < end; ++r) add(r, &of_refined_[offset(r - first, size)]);
        }
    });
}

double SimdEnergy::energy(const std::vector<double>& x) {
    double refined = 0;
    std::atomic<bool> inverted = false;  // one inverted element settles it: the other blocks are skipped
    with_density(params_, [&](auto density) {
        dispatch([&](auto type) {
            using Batch = typename decltype(type)::type;
            parallel_tasks(blocks_.count(), is_large_, [&](int block) {
                if (inverted.load(std::memory_order_relaxed)) return;
                SumOfBatches sum;
                every_batch<Batch>(block, x, [&](const Batch& elements, int batch, Lanes part) {
                    sum.add(part * weight_[batch] * elements.energy(density, params_.delta), batch);
                });
                block_value_[block] = sum.total();
                if (!std::isfinite(block_value_[block])) inverted.store(true, std::memory_order_relaxed);
            });
        });
        const auto energy_of = [&](const auto& element, int r, double* to) {
            *to = singles_[r].ideal.weight * element.energy_of_element(density, params_.delta);
        };
        every_refined(x, 1, energy_of, [&](int, const double* energy) { refined += *energy; });
    });
    if (inverted || !std::isfinite(refined)) return std::numeric_limits<double>::infinity();
    return deterministic_sum(blocks_.count(), [this](int block) { return block_value_[block]; }) + refined;
}

void SimdEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) {
    with_density(params_, [&](auto density) {
        dispatch([&](auto type) {
            using Batch = typename decltype(type)::type;
            blocks_.in_schedule(is_large_, [&](int block) {
                every_batch<Batch>(block, x, [&](Batch& elements, int batch, Lanes part) {
                    const int count = std::min(lanes, element_count_ - batch * lanes);
                    elements.add_gradient(density, params_.delta, part * weight_[batch], count, g.data());
                });
            });
        });
        const int size = reference_.nodes * dim_;
        const auto gradient_of = [&](auto& element, int r, double* to) {
            std::copy_n(element.gradient(density, params_.delta, in_all_lanes(singles_[r].ideal.weight)), size, to);
        };
        every_refined(x, size, gradient_of, [&](int r, const double* part) {
            for (int i = 0; i < reference_.nodes; ++i)
                for (int a = 0; a < dim_; ++a) g[offset(singles_[r].nodes[i], dim_, a)] += *part++;
        });
    });
}

// With own = w_e and added = t w'_e the density is own f + added eta^2 = (own + added) (share f + (1 - share) eta^2).
void SimdEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H,
                             const Projection& projection) {
    const bool projected = kind == HessianKind::projected, of_objective = kind != HessianKind::damping;
    const double t = projected ? projection.damping : of_objective ? 0 : 1;
    const double kept_negative = projected ? projection.kept_negative : of_objective ? 1 : 0;
    const int m = reference_.nodes, mm = m * m;
    const bool half = H.in_half();
    const auto target_of = [&](int place) { return &hessian_block_[offset(place, targets_)]; };
    const auto add = [&](auto size, const double* part, int place) {
        const int* target = target_of(place);
        double* const values = H.value.data();
        for (int k = 0; k < mm && !half; ++k) add_block<size>(part + k * size, values + offset(target[k], size));
        for (int a = 0; a < m && half; ++a) {
            for (int b = 0; b < a; ++b, ++target)
                add_block<size>(part + (*target % 2 == 0 ? a * m + b : b * m + a) * size, H.block_below(*target / 2));
            add_block<size>(part + a * (m + 1) * size, H.diagonal(H.row_of(element(place)[a])));
        }
    };
    with_density(params_, [&](auto density) {
        const auto hessian_of = [&](auto& elements, Lanes own, Lanes added) {
            if (!of_objective) own = Lanes{};
            const Lanes weight = own + t * added;
            const Lanes share = own / max(weight, in_all_lanes(std::numeric_limits<double>::min()));
            return elements.hessian(damped(density, share), params_.delta, kept_negative, weight);
        };
        dispatch([&](auto type) {
            using Batch = typename decltype(type)::type;
            using Size = std::integral_constant<int, Batch::dimension * Batch::dimension>;
            blocks_.in_schedule(is_large_, [&](int block) {
                every_batch<Batch>(block, x, [&](Batch& elements, int batch, Lanes of_rule) {
                    const int first = batch * lanes, count = std::min(lanes, element_count_ - first);
                    const int* const target = target_of(first);
                    if (!half) prefetch_blocks<Size::value>(H.value.data(), target, count * mm);
                    const double* const part = hessian_of(elements, of_rule * weight_[batch],
                                                          of_rule * damping_weight_[batch]);
                    for (int k = 0; k < count; ++k) add(Size(), part + k * elements.stride(), first + k);
                });
            });
        });
        const auto hessian_of_refined = [&](auto& element, int r, double* to) {
            const IdealElement& of = singles_[r].ideal;
            const Lanes own = in_all_lanes(of.weight), added = in_all_lanes(of.damping_weight);
            std::copy_n(hessian_of(element, own, added), mm * dim_ * dim_, to);
        };
        every_refined(x, mm * dim_ * dim_, hessian_of_refined, [&](int r, const double* part) {
            with_dimension(dim_, [&](auto n) {
                add(std::integral_constant<int, n() * n()>(), part, rules_.refined()[r].element);
            });
        });
    });
}

DistortionStatistics SimdEnergy::statistics(const std::vector<double>& x) {
    DistortionStatistics result;
    result.element_max.resize(element_count_);
    double refined_norm = 0;
    const ReferenceElement& usual = rules_.usual().reference;
    dispatch([&](auto type) {
        using Batch = typename decltype(type)::type;
        parallel_for(blocks_.count(), [&](int block) {
            SumOfBatches sum;
            every_batch<Batch>(block, x, [&](const Batch& elements, int batch, Lanes) {
                Lanes largest{}, squared{};
                for (int q = 0; q < usual.points; ++q) {
                    const Lanes eta = elements.distortion_at(q);
                    squared += usual.weight[q] * eta * eta * elements.share_at(q);
                    largest = max(largest, eta);
                }
                // not 0 infinity
                sum.add(select(ideal_jacobian_[batch] > 0, ideal_jacobian_[batch] * squared, Lanes{}), batch);
                const int first = batch * lanes, count = std::min(lanes, element_count_ - first);
                for (int l = 0; l < count; ++l) result.element_max[blocks_.order[first + l]] = largest[l];
            }, true);
            block_value_[block] = sum.total();
        }, is_large_ ? parallel_work : 0);
    });
    const auto measure = [&](const auto& element, int r, double* to) {
        const RefinedQuadrature& rule = *rules_.refined()[r].rule;
        double squared = 0, largest = 0;
        for (int q = 0; q < rule.reference.points; ++q) {
            const auto [pack, lane] = rule.lanes.place_of(q);
            const double eta = element.distortion_at(pack)[lane];
            squared += rule.volume[q] * eta * eta * element.share_at(pack)[lane];
            largest = std::max(largest, eta);
        }
        to[0] = squared;
        to[1] = largest;
    };
    every_refined(x, 2, measure, [&](int r, const double* of) {
        refined_norm += singles_[r].ideal.jacobian * of[0];
        double& largest = result.element_max[blocks_.order[rules_.refined()[r].element]];
        largest = std::max(largest, of[1]);
    });
    const double squared_norm = deterministic_sum(blocks_.count(), [this](int block) { return block_value_[block]; });
    result.relative_quality = std::sqrt(volume_ / (squared_norm + refined_norm));
    for (double eta : result.element_max) result.max_distortion = std::max(result.max_distortion, eta);
    return result;
}

}  // namespace almesh
