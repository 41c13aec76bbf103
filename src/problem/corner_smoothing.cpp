// s = det(a, b, c) / (|a| |b| |c|) over that of the regular cell, a, b, c the edges at the corner:
// grad_a s = (b x c) / (|a| |b| |c|) - s a / |a|^2.
#include "problem/corner_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/interrupt.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "check/scaled_jacobian.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/patch.hpp"
#include "linalg/ordering/graph.hpp"
#include "mesh/restriction.hpp"

namespace almesh {
namespace {

constexpr int stages = 8;  // k = 10, 20, ..., 1280
constexpr int fewest_steps = 100, most_steps = 400;  // of a stage
constexpr double work_of_stage = 5.6e6;              // corners times steps, between these
constexpr double least_fall = 1e-3;                  // of E_k in ten steps
// w; beyond this k it falls as 1 / k, where the least s is below `good` with its square too.
constexpr double weight_of_others = 0.0015, good = 0.3, last_k_of_weight = 40;
constexpr double part_of_shape = 0.3, usual_shape = 3.5;           // a, where no eta is larger than that
constexpr double negligible = -40;                                 // exponent
constexpr double free_part = 0.8, stiffness = 20;                  // of the bound for sizes
constexpr double worthwhile = 1e-7, flat = 1e-9;  // of s
constexpr int most_vertices = 8;

// The determinant and the edges at a corner, in 2D with a third edge of (0, 0, 1).
struct CornerEdges {
    std::array<Vec<3>, 3> edge{{{}, {}, {0, 0, 1}}};
    Vec<3> square{1, 1, 1};  // of their lengths
    double determinant;

    CornerEdges(const Corner& corner, const std::array<Vec<3>, most_vertices>& vertex, int dim) {
        for (int j = 0; j < dim; ++j) {
            edge[j] = vertex[corner.vertex[j + 1]] - vertex[corner.vertex[0]];
            square[j] = dot(edge[j], edge[j]);
        }
        determinant = dot(edge[0], normal(0));
    }
    Vec<3> normal(int j) const { return cross(edge[(j + 1) % 3], edge[(j + 2) % 3]); }  // the slope of the determinant
};

std::array<Vec<3>, most_vertices> vertices_of(const Mesh& mesh, const std::vector<double>& x, int e) {
    std::array<Vec<3>, most_vertices> vertex;
    for (int v = 0; v < mesh.cell(e).vertices; ++v) vertex[v] = at_node(x, mesh.element(e)[v], mesh.dim);
    return vertex;
}

double size_of(const std::vector<Corner>& corners, const std::array<Vec<3>, most_vertices>& vertex, int dim) {
    double sum = 0;
    for (const Corner& corner : corners) sum += CornerEdges(corner, vertex, dim).determinant / corner.regular;
    return sum / static_cast<double>(corners.size());
}

class CornerFunction : public SmoothFunction {
public:
    CornerFunction(const MovingNodes& moving, const std::vector<double>& x)
        : moving_(moving), mesh_(moving.mesh), dim_(mesh_.dim), from_(x), x_(x), best_(x),
          first_size_(moving.size_change > 0 ? element_sizes(mesh_, x) : std::vector<double>()) {
        find_elements();
        scale_by_edges();
        find_sliding();
    }

    int steps() const { return steps_; }
    int steps_of_stage() const {
        return std::clamp(static_cast<int>(work_of_stage / count_), fewest_steps, most_steps);
    }
    int elements() const { return static_cast<int>(element_.size()); }
    int corners() const { return count_; }
    double least() const { return least_; }
    // Of all iterates since begin(): the positions with the largest least s, and that.
    const std::vector<double>& best() const { return best_; }
    double best_least() const { return best_least_; }

    // A stage, from the mesh at z on. Whether all is valid there.
    bool begin(double k, const std::vector<double>& z, std::vector<double>& g) {
        k_ = k;
        of_others_ = 0;
        const bool is_valid = std::isfinite(value(z, g));
        double eta = usual_shape;
        for (const Terms& of : terms_) eta = std::max(eta, of.eta);
        a_ = part_of_shape * std::pow((usual_shape - 1) / (eta - 1), 2);
        weight_ = weight_of_others;
        if (k > last_k_of_weight) weight_ *= last_k_of_weight / k * std::min(1.0, std::pow(least_ / good, 2));
        value(z, g);
        of_others_ = sum_of_others_;
        reference_ = best_least_ = least_;
        best_ = x_;
        return is_valid;
    }

    double value(const std::vector<double>& z, std::vector<double>& g) override {
        to_positions(z);
        constexpr double work = 500;
        parallel_for(elements(), [&](int k) { measure(k); }, work);
        least_ = 1;
        double sum = -of_others_;
        sum_of_others_ = 0;
        for (const Terms& of : terms_) {
            least_ = std::min(least_, of.least);
            sum += of.worst + of.others;
            sum_of_others_ += of.others;
        }
        if (!std::isfinite(sum)) return std::numeric_limits<double>::infinity();
        parallel_for(mesh_.nodes(), [&](int i) { gather(i, point(g, i, dim_)); }, work / 10);
        moving_.pairs.fold(g);
        for (SlidingNode& node : sliding_) project(node, g);
        for (int i = 0; i < mesh_.nodes(); ++i)
            for (int a = 0; a < dim_; ++a) point(g, i, dim_)[a] *= moving_.moves[i] ? edge_[i] : 0;
        return sum;
    }

    void retract(std::vector<double>& z) const override {
        constexpr int corrections = 3;
        moving_.pairs.spread(z);
        for (const SlidingNode& node : sliding_) {
            if (!node.is_curved) continue;
            const Vec<3> from = at_node(from_, node.i, dim_);
            Vec<3> x = from + edge_[node.i] * at_node(z, node.i, dim_);
            for (int k = 0; k < corrections; ++k) x = x - moving_.surfaces.distance(node.t, x).r;
            set_node(z, node.i, dim_, 1 / edge_[node.i] * (x - from));
        }
    }

    bool accept(const std::vector<double>&) override {
        ++steps_;
        if (moving_.observe) moving_.observe(steps_, stages * steps_of_stage());
        if (least_ <= best_least_) return true;
        best_least_ = least_;
        best_ = x_;
        return true;
    }

    // Nodes that slide, exactly onto their surfaces.
    void put_back(std::vector<double>& x) const {
        if (sliding_.empty()) return;
        const std::vector<double> to = moving_.surfaces.targets(x);
        for (const SlidingNode& node : sliding_) std::copy_n(point(to, node.t, dim_), dim_, point(x, node.i, dim_));
    }

private:
    struct Terms {
        double least = 1, eta = 1, worst = 0, others = 0;
    };

    struct SlidingNode {
        int t, i;  // of surfaces.nodes(), of the mesh
        bool is_curved;
        std::vector<Vec<3>> normals;
    };

    const MovingNodes moving_;
    const Mesh& mesh_;
    int dim_, steps_ = 0, count_ = 0;
    double k_ = 1, weight_ = 0, a_ = 0, reference_ = 0, least_ = 1, best_least_ = 1, of_others_ = 0, sum_of_others_ = 0;
    std::vector<double> from_;       // positions at z = 0
    std::vector<double> x_;          // and at z
    std::vector<double> best_, first_size_;
    std::vector<double> edge_;                  // per node: the mean of the edges there
    std::vector<SlidingNode> sliding_;
    std::vector<int> element_;                  // with a node that moves
    std::vector<std::vector<Corner>> corners_;  // by group of elements
    Groups places_;                             // per node, its vertices: 8 k + v, v of element_[k]
    std::vector<unsigned char> counts_;         // of these elements, bit c: whether the corner counts
    std::vector<Terms> terms_;                  // of these elements
    std::vector<Vec<3>> slopes_;                // at 8 k + v

    void find_elements() {
        for (const ElementGroup& group : mesh_.element_groups()) corners_.push_back(corners_of(*group.cell));
        element_ = restriction_to(moving_.moves, mesh_).element;
        std::vector<int> node(element_.size() * most_vertices, mesh_.nodes());
        for (int k = 0; k < elements(); ++k)
            std::copy_n(mesh_.element(element_[k]), mesh_.cell(element_[k]).vertices, &node[k * most_vertices]);
        places_ = sorted_by_group(node, mesh_.nodes() + 1);
        find_corners();
        terms_.resize(element_.size());
        slopes_.resize(element_.size() * most_vertices);
    }

    // Those that count have a node that moves. Of an element that cannot be valid, flat and inverted ones do not.
    void find_corners() {
        counts_.resize(element_.size());
        for (int k = 0; k < elements(); ++k) {
            const std::array<Vec<3>, most_vertices> vertex = vertices_of(mesh_, from_, element_[k]);
            const std::vector<Corner>& corners = corners_[mesh_.group_number(element_[k])];
            for (std::size_t c = 0; c < corners.size(); ++c) {
                bool moves = false;
                for (int j = 0; j <= dim_; ++j)
                    moves = moves || moving_.moves[mesh_.element(element_[k])[corners[c].vertex[j]]];
                const CornerEdges at(corners[c], vertex, dim_);
                const double lengths = std::sqrt(at.square[0] * at.square[1] * at.square[2]);
                if (!moves || !(at.determinant / corners[c].regular > flat * lengths)) continue;
                counts_[k] |= static_cast<unsigned char>(1 << c);
                ++count_;
            }
        }
    }

    void scale_by_edges() {
        std::vector<double> logs(mesh_.nodes(), 0), count(mesh_.nodes(), 0);
        for (const int e : element_)
            for (const auto& [i, j] : mesh_.cell(e).edges) {
                const int a = mesh_.element(e)[i], b = mesh_.element(e)[j];
                const double log = std::log(length(at_node(from_, a, dim_) - at_node(from_, b, dim_)));
                for (const int node : {a, b})
                    if (std::isfinite(log)) logs[node] += log, ++count[node];
            }
        for (int i = 0; i < mesh_.nodes(); ++i) edge_.push_back(count[i] > 0 ? std::exp(logs[i] / count[i]) : 1);
        for (const PeriodicPairs::Pair& pair : moving_.pairs.pairs) edge_[pair.slave] = edge_[pair.master];
    }

    void to_positions(const std::vector<double>& z) {
        for (int i = 0; i < mesh_.nodes(); ++i)
            for (int a = 0; a < dim_; ++a)
                point(x_, i, dim_)[a] = point(from_, i, dim_)[a] + edge_[i] * point(z, i, dim_)[a];
    }

    void find_sliding() {
        const std::vector<int>& nodes = moving_.surfaces.nodes();
        for (int t = 0; t < static_cast<int>(nodes.size()); ++t) {
            if (!moving_.moves[nodes[t]]) continue;
            sliding_.push_back({t, nodes[t], false, {}});
            const Vec<3> at = at_node(from_, nodes[t], dim_);
            find_normals(sliding_.back(), at);
            for (const Vec<3>& force : {Vec<3>{1, 0, 0}, Vec<3>{0, 1, 0}, Vec<3>{0, 0, 1}})
                for (const Vec<3>& row : moving_.surfaces.second_derivative_at(t, at, force))
                    sliding_.back().is_curved |= dot(row, row) > 0;
        }
    }

    // The columns of the residual's derivative, made orthonormal.
    void find_normals(SlidingNode& node, const Vec<3>& x) const {
        const Mat<3> slope = moving_.surfaces.distance(node.t, x).slope;
        node.normals.clear();
        for (int a = 0; a < dim_; ++a) {
            Vec<3> n{slope[0][a], slope[1][a], slope[2][a]};
            for (const Vec<3>& other : node.normals) n = n - dot(n, other) * other;
            if (length(n) > 1e-3) node.normals.push_back(unit(n));
        }
    }

    // g onto the directions in which the node slides.
    void project(SlidingNode& node, std::vector<double>& g) const {
        if (node.is_curved) find_normals(node, at_node(x_, node.i, dim_));
        Vec<3> along = at_node(g, node.i, dim_);
        for (const Vec<3>& n : node.normals) along = along - dot(along, n) * n;
        set_node(g, node.i, dim_, along);
    }

    // What an element adds, and the derivatives by its vertices.
    void measure(int k) {
        const int e = element_[k];
        const std::array<Vec<3>, most_vertices> vertex = vertices_of(mesh_, x_, e);
        Vec<3>* const slopes = &slopes_[static_cast<std::size_t>(k) * most_vertices];
        std::fill_n(slopes, most_vertices, Vec<3>{});
        Terms& of = terms_[k] = {};
        const std::vector<Corner>& corners = corners_[mesh_.group_number(e)];
        for (std::size_t c = 0; c < corners.size(); ++c)
            if (counts_[k] >> c & 1) add_corner(corners[c], vertex, of, slopes);
        if (!first_size_.empty() && first_size_[e] > 0) add_size(k, vertex, of, slopes);
    }

    void add_corner(const Corner& corner, const std::array<Vec<3>, most_vertices>& vertex, Terms& of,
                    Vec<3>* slopes) const {
        const CornerEdges at(corner, vertex, dim_);
        const double det = at.determinant / corner.regular;
        if (!(det > 0)) {
            of.worst = std::numeric_limits<double>::infinity();
            of.least = std::min(of.least, 0.0);
            return;
        }
        const double sum = at.square[0] + at.square[1] + (dim_ == 3 ? at.square[2] : 0);
        const double s = det / std::sqrt(at.square[0] * at.square[1] * at.square[2]);
        const double eta = sum / (dim_ * (dim_ == 2 ? det : std::cbrt(det * det)));
        const double exponent = -k_ * (s - reference_), power = exponent < negligible ? 0 : std::exp(exponent);
        of.least = std::min(of.least, s);
        of.eta = std::max(of.eta, eta);
        of.worst += power / k_;
        of.others += 0.5 * weight_ * ((1 - s) * (1 - s) + a_ * (eta - 1) * (eta - 1));
        const double by_s = -power - weight_ * (1 - s), by_eta = weight_ * a_ * (eta - 1);
        const double by_det = (s * by_s - 2.0 / dim_ * eta * by_eta) / at.determinant, by_sum = by_eta * eta / sum;
        for (int j = 0; j < dim_; ++j)
            add(corner, j, by_det * at.normal(j) + (2 * by_sum - by_s * s / at.square[j]) * at.edge[j], slopes);
    }

    static void add(const Corner& corner, int j, const Vec<3>& by_edge, Vec<3>* slopes) {
        slopes[corner.vertex[j + 1]] = slopes[corner.vertex[j + 1]] + by_edge;
        slopes[corner.vertex[0]] = slopes[corner.vertex[0]] - by_edge;
    }

    // stiffness/2 h^2, h = |log(size / first size)| / log(1 + size_change) beyond the part that is free.
    void add_size(int k, const std::array<Vec<3>, most_vertices>& vertex, Terms& of, Vec<3>* slopes) {
        const std::vector<Corner>& corners = corners_[mesh_.group_number(element_[k])];
        const double count = static_cast<double>(corners.size()), bound = std::log1p(moving_.size_change);
        const double size = size_of(corners, vertex, dim_);
        const double change = size > 0 ? std::log(size / first_size_[element_[k]]) / bound
                                       : -std::numeric_limits<double>::infinity();
        const double beyond = std::max(0.0, std::abs(change) - free_part);
        of.worst += 0.5 * stiffness * beyond * beyond;
        if (beyond == 0 || !std::isfinite(of.worst)) return;
        const double slope = stiffness * beyond * (change > 0 ? 1 : -1) / (bound * size);
        for (const Corner& corner : corners)
            for (int j = 0; j < dim_; ++j)
                add(corner, j, slope / corner.regular / count * CornerEdges(corner, vertex, dim_).normal(j), slopes);
    }

    void gather(int i, double* g) const {
        Vec<3> sum{};
        for (const int place : places_.of(i)) sum = sum + slopes_[place];
        std::copy_n(sum.begin(), dim_, g);
    }
};

}  // namespace

std::vector<double> element_sizes(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<double> sizes(mesh.element_count(), 0);
    for (const ElementGroup& group : mesh.element_groups()) {
        const std::vector<Corner> corners = corners_of(*group.cell);
        parallel_for(group.count, [&](int k) {
            sizes[group.first + k] = size_of(corners, vertices_of(mesh, x, group.first + k), mesh.dim);
        });
    }
    return sizes;
}

std::unique_ptr<SmoothFunction> corner_function(const MovingNodes& moving, const std::vector<double>& x, double k) {
    auto E = std::make_unique<CornerFunction>(moving, x);
    std::vector<double> g(x.size());
    E->begin(k, std::vector<double>(x.size(), 0.0), g);
    return E;
}

int smooth_corners(const MovingNodes& moving,
                   const std::function<bool(const std::vector<double>& from, std::vector<double>& to)>& taken,
                   std::vector<double>& x) {
    CornerFunction E(moving, x);
    if (E.corners() == 0) return 0;
    std::vector<double> z(x.size(), 0.0), g(x.size());
    double reached = -1;
    for (int stage = 0; stage < stages && !interrupted(); ++stage) {
        if (!E.begin(10 << stage, z, g)) break;
        if (stage == 0) reached = E.least();
        minimise(E, {.max_iterations = E.steps_of_stage(), .least_fall = least_fall}, z);
        if (E.best_least() <= reached + worthwhile) continue;
        std::vector<double> to = E.best();
        E.put_back(to);
        if (!taken(x, to)) continue;
        reached = E.best_least();
        x = std::move(to);
    }
    return E.steps();
}

}  // namespace almesh
