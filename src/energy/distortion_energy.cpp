#include "energy/distortion_energy.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "energy/curved_batch.hpp"
#include "energy/linear_batch.hpp"

namespace almesh {

namespace {

// The damping weighs elements by their size to the power 3/2, in 2D and 3D, or like the objective if that has less.
double damping_exponent(int dim, double weight_exponent) { return std::min(1.5 / dim, weight_exponent); }

// body(position, batch, lane) for all lanes. A batch is one thread's: to write a lane may be to write the whole
// register.
template <class Body>
void each_lane(int batches, const Body& body) {
    parallel_for(batches, [&](int batch) {
        for (int lane = 0; lane < lanes; ++lane) body(batch * lanes + lane, batch, lane);
    }, 10.0 * lanes);
}

double simplex_volume(int dim) { return simplex(dim).volume(); }

}  // namespace

DistortionEnergy::DistortionEnergy(const Mesh& mesh, const std::vector<double>& ideal, const DistortionParams& params)
    : dim_(mesh.dim),
      element_count_(mesh.element_count()),
      params_(params),
      reference_(reference_element(mesh.dim, mesh.degree, params.exactness)),
      chunks_(chunk_elements(mesh)),
      chunk_value_(chunks_.count()) {
    resize();
    set_geometry(mesh, ideal);
    set_places(mesh.nodes());
}

void DistortionEnergy::resize() {
    const int m = reference_.nodes, batches = (element_count_ + lanes - 1) / lanes;
    nodes_.resize(static_cast<std::size_t>(batches) * lanes * m);
    ideal_inverse_.resize(static_cast<std::size_t>(batches) * dim_ * dim_);
    ideal_jacobian_.resize(batches);
    weight_.resize(batches);
    damping_weight_.resize(batches);
    is_large_ = static_cast<double>(element_count_) * reference_.points * reference_.nodes >= parallel_work;
}

void DistortionEnergy::set_geometry(const Mesh& mesh, const std::vector<double>& ideal) {
    const int m = reference_.nodes, batches = static_cast<int>(weight_.size());
    const double exponent = damping_exponent(dim_, params_.weight_exponent);
    std::atomic<int> flat = element_count_;  // first element without volume
    with_dimension(dim_, [&](auto dimension) {
        constexpr int n = dimension;
        each_lane(batches, [&](int k, int batch, int lane) {
            const int e = chunks_.order[std::min(k, element_count_ - 1)];
            std::copy_n(mesh.element(e), m, &nodes_[static_cast<std::size_t>(k) * m]);
            const Mat<n> A = straight_jacobian<n>(mesh.element(e), ideal);
            const double jacobian = determinant(A);
            if (!(jacobian > 0))
                for (int first = flat; e < first && !flat.compare_exchange_weak(first, e);) {}
            const Mat<n> inverse_of_A = inverse<n>(A);
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j)
                    ideal_inverse_[static_cast<std::size_t>(batch) * n * n + i * n + j][lane] = inverse_of_A[i][j];
            ideal_jacobian_[batch][lane] = k < element_count_ ? jacobian : 0;
            weight_[batch][lane] = k < element_count_ ? std::pow(jacobian, params_.weight_exponent) : 0;
            damping_weight_[batch][lane] = k < element_count_ ? std::pow(jacobian, exponent) : 0;
        });
    });
    if (flat < element_count_)
        throw InputError("element " + std::to_string(mesh.file.element_id[flat]) +
                         " of the ideal mesh has no positive volume");

    measure();
    for (std::vector<Lanes>* weights : {&weight_, &damping_weight_}) {
        const auto of_batch = [&](int k) { return sum_of_lanes((*weights)[k]); };
        const double weighted = simplex_volume(dim_) * deterministic_sum(batches, of_batch);
        for (Lanes& weight : *weights) weight *= volume_ / weighted;
    }
}

void DistortionEnergy::measure() {
    const int batches = static_cast<int>(ideal_jacobian_.size());
    volume_ =
        simplex_volume(dim_) * deterministic_sum(batches, [this](int k) { return sum_of_lanes(ideal_jacobian_[k]); });
}

DistortionEnergy::DistortionEnergy(const DistortionEnergy& whole, const Mesh& mesh, const std::vector<int>& position)
    : dim_(whole.dim_),
      element_count_(mesh.element_count()),
      params_(whole.params_),
      reference_(whole.reference_),
      chunks_(chunk_elements(mesh)),
      chunk_value_(chunks_.count()) {
    resize();
    const int m = reference_.nodes, entries = dim_ * dim_;
    each_lane(static_cast<int>(weight_.size()), [&](int k, int batch, int lane) {
        const int e = chunks_.order[std::min(k, element_count_ - 1)];
        const int from = position[e] / lanes, from_lane = position[e] % lanes;
        std::copy_n(mesh.element(e), m, &nodes_[static_cast<std::size_t>(k) * m]);
        for (int ij = 0; ij < entries; ++ij)
            ideal_inverse_[static_cast<std::size_t>(batch) * entries + ij][lane] =
                whole.ideal_inverse_[static_cast<std::size_t>(from) * entries + ij][from_lane];
        const bool weighs = k < element_count_;
        ideal_jacobian_[batch][lane] = weighs ? whole.ideal_jacobian_[from][from_lane] : 0;
        weight_[batch][lane] = weighs ? whole.weight_[from][from_lane] : 0;
        damping_weight_[batch][lane] = weighs ? whole.damping_weight_[from][from_lane] : 0;
    });
    measure();
    set_places(mesh.nodes());
}

DistortionEnergy DistortionEnergy::part(const std::vector<double>& x, const std::vector<char>& moves,
                                        std::vector<int>& node) const {
    const int m = reference_.nodes;
    Mesh mesh;
    mesh.dim = dim_;
    mesh.degree = reference_.degree;
    node.clear();
    std::vector<int> position, number(moves.size(), -1);
    for (int k = 0; k < element_count_; ++k) {
        const int* const of_element = &nodes_[static_cast<std::size_t>(k) * m];
        if (std::none_of(of_element, of_element + m, [&](int i) { return moves[i]; })) continue;
        position.push_back(k);
        for (int i = 0; i < m; ++i) {
            int& own = number[of_element[i]];
            if (own < 0) {
                own = static_cast<int>(node.size());
                node.push_back(of_element[i]);
                mesh.x.insert(mesh.x.end(), &x[static_cast<std::size_t>(of_element[i]) * dim_],
                              &x[static_cast<std::size_t>(of_element[i]) * dim_] + dim_);
            }
            mesh.elements.push_back(own);
        }
    }
    return {*this, mesh, position};
}

void DistortionEnergy::set_places(int node_count) {
    CellPattern of_elements = pattern_and_places_of_cells(node_count, dim_, nodes_, reference_.nodes);
    pattern_ = std::move(of_elements.pattern);
    place_ = std::move(of_elements.place);
}

BlockCsr DistortionEnergy::hessian_pattern() const {
    BlockCsr H = pattern_;
    H.value.assign(H.col.size() * H.d * H.d, 0.0);
    return H;
}

// body(std::type_identity<Batch>), Batch: the class for elements of this dimension and degree.
template <class Body>
void DistortionEnergy::with_batches(const Body& body) const {
    with_dimension(dim_, [&](auto n) {
        if (reference_.degree == 1) body(std::type_identity<LinearBatch<n()>>());
        else body(std::type_identity<CurvedBatch<n()>>());
    });
}

// body(batch of elements, its number) for the batches of a chunk, in order.
template <class Batch, class Body>
void DistortionEnergy::every_batch(int chunk, const std::vector<double>& x, const Body& body) const {
    constexpr int n = Batch::dimension;
    Batch elements(reference_);
    const int end = std::min(element_count_, (chunk + 1) * chunks_.size);
    for (int k = chunk * chunks_.size; k < end; k += lanes) {
        const int batch = k / lanes;
        elements.start(&nodes_[static_cast<std::size_t>(k) * reference_.nodes], x,
                       reinterpret_cast<const Mat<n, Lanes>&>(ideal_inverse_[static_cast<std::size_t>(batch) * n * n]));
        body(elements, batch);
    }
}

double DistortionEnergy::energy(const std::vector<double>& x) const {
    std::atomic<bool> inverted = false;  // one inverted element settles it: the other chunks are skipped
    with_batches([&](auto of_type) {
        using Batch = typename decltype(of_type)::type;
#pragma omp parallel for schedule(dynamic, 1) if (is_large_)
        for (int chunk = 0; chunk < chunks_.count(); ++chunk) {
            if (inverted.load(std::memory_order_relaxed)) continue;
            Lanes sum{};
            every_batch<Batch>(chunk, x, [&](const Batch& elements, int batch) {
                sum += weight_[batch] * elements.energy(params_.delta, params_.objective);
            });
            chunk_value_[chunk] = sum_of_lanes(sum);
            if (!std::isfinite(chunk_value_[chunk])) inverted.store(true, std::memory_order_relaxed);
        }
    });
    if (inverted) return std::numeric_limits<double>::infinity();
    return deterministic_sum(chunks_.count(), [this](int c) { return chunk_value_[c]; });
}

void DistortionEnergy::add_gradient(const std::vector<double>& x, std::vector<double>& g) const {
    with_batches([&](auto of_type) {
        using Batch = typename decltype(of_type)::type;
        chunks_.in_turn(is_large_, [&](int chunk) {
            every_batch<Batch>(chunk, x, [&](Batch& elements, int batch) {
                const int count = std::min(lanes, element_count_ - batch * lanes);
                elements.add_gradient(params_.delta, params_.objective, weight_[batch], count, g.data());
            });
        });
    });
}

void DistortionEnergy::add_hessian(const std::vector<double>& x, HessianKind kind, BlockCsr& H, double damping) const {
    const bool projected = kind != HessianKind::full, of_objective = kind != HessianKind::squared_projected;
    const double added = kind == HessianKind::projected ? damping : of_objective ? 0 : 1;
    with_batches([&](auto of_type) {
        using Batch = typename decltype(of_type)::type;
        chunks_.in_turn(is_large_, [&](int chunk) {
            every_batch<Batch>(chunk, x, [&](Batch& elements, int batch) {
                const Lanes own = of_objective ? weight_[batch] : Lanes{};
                const Lanes weight = own + added * damping_weight_[batch];
                const bool shifted = params_.objective == Objective::deviation;
                const Lanes shift = shifted ? own / max(weight, in_all_lanes(1e-300)) : Lanes{};
                const int m = elements.nodes(), first = batch * lanes, count = std::min(lanes, element_count_ - first);
                const int* place = &place_[static_cast<std::size_t>(first) * m * m];
                // On their way from memory while the numbers to add are computed: a block may lie on two cache lines.
                constexpr int n = Batch::dimension, block_size = n * n;
                double* const values = H.value.data();
                for (int k = 0; k < count * m * m; ++k) {
                    const double* const block = values + static_cast<std::size_t>(place[k]) * block_size;
                    __builtin_prefetch(block, 1);
                    __builtin_prefetch(block + block_size - 1, 1);
                }
                const double* part = elements.hessian(params_.delta, shift, projected, weight);
                for (int k = 0; k < count; ++k, part += elements.stride(), place += m * m) {
                    for (int ij = 0; ij < m * m; ++ij) {
                        double* const block = values + static_cast<std::size_t>(place[ij]) * block_size;
                        double sum[block_size];  // first all, then stored: the compiler need not fear that they overlap
                        for (int ab = 0; ab < block_size; ++ab) sum[ab] = block[ab] + part[ij * block_size + ab];
                        std::copy_n(sum, block_size, block);
                    }
                }
            });
        });
    });
}

DistortionStatistics DistortionEnergy::statistics(const std::vector<double>& x) const {
    DistortionStatistics result;
    result.element_max.resize(element_count_);
    with_batches([&](auto of_type) {
        using Batch = typename decltype(of_type)::type;
        parallel_for(chunks_.count(), [&](int chunk) {
            Lanes sum{};
            every_batch<Batch>(chunk, x, [&](const Batch& elements, int batch) {
                Lanes largest{}, squared{};
                for (int q = 0; q < reference_.points; ++q) {
                    const Lanes eta = elements.distortion_at(q);
                    squared += reference_.weight[q] * eta * eta;
                    largest = max(largest, eta);
                }
                sum += select(ideal_jacobian_[batch] > 0, ideal_jacobian_[batch] * squared, Lanes{});  // not 0 infinity
                const int first = batch * lanes, count = std::min(lanes, element_count_ - first);
                for (int l = 0; l < count; ++l) result.element_max[chunks_.order[first + l]] = largest[l];
            });
            chunk_value_[chunk] = sum_of_lanes(sum);
        }, is_large_ ? parallel_work : 0);
    });
    const double squared_norm = deterministic_sum(chunks_.count(), [this](int c) { return chunk_value_[c]; });
    result.relative_quality = std::sqrt(volume_ / squared_norm);
    for (double eta : result.element_max) result.max_distortion = std::max(result.max_distortion, eta);
    return result;
}

}  // namespace almesh
