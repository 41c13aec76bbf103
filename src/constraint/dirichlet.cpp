// The trace mass matrix M, the projection M g_h = (N, g_D) of the target, and the quadratic form of dirichlet.hpp.
#include "constraint/dirichlet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/small_matrix.hpp"
#include "linalg/direct/cholesky.hpp"
#include "linalg/vector_ops.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double mass_work = 40;  // simple operations that a row of M takes

// Length of the edge or area of the triangle spanned by the face's vertices.
double face_measure(const Mesh& mesh, const std::vector<double>& ideal, int f) {
    const auto edge = [&](int v, int a) {
        return ideal[offset(mesh.face(f)[v], mesh.dim, a)] - ideal[offset(mesh.face(f)[0], mesh.dim, a)];
    };
    if (mesh.dim == 2) return std::hypot(edge(1, 0), edge(1, 1));
    const double n0 = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1),
                 n1 = edge(1, 2) * edge(2, 0) - edge(1, 0) * edge(2, 2),
                 n2 = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
    return 0.5 * std::hypot(n0, n1, n2);
}

}  // namespace

Dirichlet::Dirichlet(const Mesh& mesh, const std::vector<double>& ideal, const BoundaryTarget& target, TargetKind kind)
    : dim_(mesh.dim), kind_(kind), mesh_(mesh), target_(target) {
    const LagrangeBasis basis(dim_ - 1, mesh.degree);
    face_values_.resize(offset(target.quadrature.count, basis.count));
    for (int q = 0; q < target.quadrature.count; ++q)
        basis.values(&target.quadrature.xi[q * (dim_ - 1)], &face_values_[offset(q, basis.count)]);

    // |f| / h_f over the volume of the reference face: what a reference integral is multiplied by.
    std::vector<double> face_weight(mesh.face_count());
    double one_squared = 0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const double measure = face_measure(mesh, ideal, f), h = dim_ == 2 ? measure : std::sqrt(measure);
        one_squared += measure / h;
        face_weight[f] = measure / h * (dim_ == 2 ? 1 : 2);
    }
    norm_of_one_ = std::sqrt(one_squared);
    number_trace_nodes();
    measure_heights(ideal);
    assemble_mass(face_weight);
    if (kind == TargetKind::nodal || target.in_trace_space) interpolate_target();
    else project_target(ideal, face_weight);
    if (kind == TargetKind::exact) measure_best_approximation(face_weight);
}

void Dirichlet::number_trace_nodes() {
    std::vector<int> trace(mesh_.nodes(), -1);
    for (int node : mesh_.faces) trace[node] = 0;
    for (int node = 0; node < mesh_.nodes(); ++node) {
        if (trace[node] < 0) continue;
        trace[node] = static_cast<int>(nodes_.size());
        nodes_.push_back(node);
    }
    faces_.resize(mesh_.faces.size());
    std::transform(mesh_.faces.begin(), mesh_.faces.end(), faces_.begin(), [&](int node) { return trace[node]; });
    v_.resize(nodes_.size() * dim_);
    g_h_.resize(nodes_.size() * dim_);
}

void Dirichlet::measure_heights(const std::vector<double>& ideal) {
    const int m = mesh_.face_nodes();
    height_.assign(nodes_.size(), std::numeric_limits<double>::infinity());
    with_dimension(dim_, [&](auto n) {
        for (int f = 0; f < mesh_.face_count(); ++f) {
            const double volume = determinant(straight_jacobian<n>(mesh_.element(mesh_.face_element[f]), ideal));
            const double height = volume / ((dim_ - 1) * face_measure(mesh_, ideal, f));
            for (int i = 0; i < m; ++i) {
                double& least = height_[faces_[offset(f, m, i)]];
                least = std::min(least, height);
            }
        }
    });
}

void Dirichlet::assemble_mass(const std::vector<double>& face_weight) {
    const int m = mesh_.face_nodes();
    std::vector<double> reference(m * m, 0.0);  // integrals of N_i N_j over the reference face
    for (int q = 0; q < target_.quadrature.count; ++q)
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j)
                reference[i * m + j] +=
                    target_.quadrature.weight[q] * face_values_[offset(q, m, i)] * face_values_[offset(q, m, j)];
    LargeVector<int> place;
    M_ = pattern_of_cells(static_cast<int>(nodes_.size()), 1, faces_, m, &place);
    M_.value.assign(M_.col.size(), 0.0);
    for (int f = 0; f < mesh_.face_count(); ++f)
        for (int ij = 0; ij < m * m; ++ij) M_.value[place[offset(f, m * m, ij)]] += face_weight[f] * reference[ij];
}

// Solves M (g_h - y) = (N, g_D - y): relative to the ideal positions y, a boundary that stays has no rounding error.
void Dirichlet::project_target(const std::vector<double>& ideal, const std::vector<double>& face_weight) {
    const int m = mesh_.face_nodes(), points = target_.quadrature.count;
    Cholesky factorisation(M_);
    if (factorisation.factor(M_).status != SolveStatus::success)
        throw InputError(
            "the mass matrix of the boundary cannot be factored: a boundary face is degenerate or memory is short");
    const auto ideal_at = [&](int t, int a) { return ideal[offset(nodes_[t], dim_, a)]; };
    std::vector<double> right(nodes_.size()), displacement(nodes_.size());
    for (int a = 0; a < dim_; ++a) {
        std::fill(right.begin(), right.end(), 0.0);
        for (int f = 0; f < mesh_.face_count(); ++f) {
            const int* trace = &faces_[offset(f, m)];
            for (int q = 0; q < points; ++q) {
                const double* N = &face_values_[offset(q, m)];
                double d = target_.sample[offset(offset(f, points, q), dim_, a)];
                for (int i = 0; i < m; ++i) d -= N[i] * ideal_at(trace[i], a);
                for (int i = 0; i < m; ++i) right[trace[i]] += face_weight[f] * target_.quadrature.weight[q] * N[i] * d;
            }
        }
        factorisation.solve(right.data(), displacement.data());
        for (std::size_t t = 0; t < nodes_.size(); ++t)
            g_h_[t * dim_ + a] = ideal_at(static_cast<int>(t), a) + displacement[t];
    }
}

void Dirichlet::interpolate_target() {
    for (std::size_t k = faces_.size(); k-- > 0;)  // the first face that holds a node decides, as in target_check
        for (int a = 0; a < dim_; ++a) g_h_[offset(faces_[k], dim_, a)] = target_.node[k * dim_ + a];
}

// e_h^2 = sum over faces of the weighted integral of |g_h - g_D|^2.
void Dirichlet::measure_best_approximation(const std::vector<double>& face_weight) {
    const double squared = deterministic_sum(mesh_.face_count(), [&](int f) {
        double sum = 0;
        for (int q = 0; q < target_.quadrature.count; ++q)
            sum += target_.quadrature.weight[q] * squared_difference_at(g_h_, faces_, f, q);
        return face_weight[f] * sum;
    });
    best_approximation_error_ = std::sqrt(squared) / norm_of_one_;
}

double Dirichlet::difference(const std::vector<double>& x, int trace_node, int component) const {
    return x[offset(nodes_[trace_node], dim_, component)] - g_h_[offset(trace_node, dim_, component)];
}

// |u - g_D|^2 at a quadrature point of a face, u having the value trace[nodes[face node] x dim] at each face node.
double Dirichlet::squared_difference_at(const std::vector<double>& trace, const std::vector<int>& nodes,
                                                 int face, int point) const {
    const int m = mesh_.face_nodes(), points = target_.quadrature.count;
    double squared = 0;
    for (int a = 0; a < dim_; ++a) {
        double d = -target_.sample[offset(offset(face, points, point), dim_, a)];
        for (int i = 0; i < m; ++i)
            d += face_values_[offset(point, m, i)] * trace[offset(nodes[offset(face, m, i)], dim_, a)];
        squared += d * d;
    }
    return squared;
}

// v <- entry(trace node, component)
template <class Entry>
void Dirichlet::set_v(const Entry& entry) {
    parallel_for(M_.n, [&](int t) {
        for (int a = 0; a < dim_; ++a) v_[offset(t, dim_, a)] = entry(t, a);
    });
}

// The n entries of M v at a trace node.
template <int n>
void Dirichlet::mass_times_v(int trace_node, double* Mv) const {
    std::fill_n(Mv, n, 0.0);
    for (int k = M_.row[trace_node]; k < M_.row[trace_node + 1]; ++k)
        for (int a = 0; a < n; ++a) Mv[a] += M_.value[k] * v_[offset(M_.col[k], n, a)];
}

// w^T M v, w_k = weight(k), k = trace node * dim + component.
template <class Weight>
double Dirichlet::dot_mass_times_v(const Weight& weight) const {
    double sum = 0;
    with_dimension(dim_, [&](auto n) {
        sum = deterministic_sum(M_.n, [&](int t) {
            double Mv[n], product = 0;
            mass_times_v<n>(t, Mv);
            for (int a = 0; a < n; ++a) product += weight(t * n + a) * Mv[a];
            return product;
        }, mass_work);
    });
    return sum;
}

double Dirichlet::projected_norm(const std::vector<double>& x) {
    set_v([&](int t, int a) { return difference(x, t, a); });
    const double squared = dot_mass_times_v([this](int k) { return v_[k]; });
    return std::sqrt(squared < 0 ? 0 : squared) / norm_of_one_;  // rounding may be negative; nan stays nan
}

double Dirichlet::norm(const std::vector<double>& x) {
    return std::hypot(projected_norm(x), best_approximation_error_);
}

double Dirichlet::max_error(const std::vector<double>& x) {
    double squared = 0;
    for (std::size_t k = 0; k < mesh_.faces.size(); ++k) {
        double s = 0;
        for (int a = 0; a < dim_; ++a)
            s += std::pow(x[offset(mesh_.faces[k], dim_, a)] - target_.node[k * dim_ + a], 2);
        squared = std::max(squared, s);
    }
    if (kind_ == TargetKind::exact)
        for (int f = 0; f < mesh_.face_count(); ++f)
            for (int q = 0; q < target_.quadrature.count; ++q)
                squared = std::max(squared, squared_difference_at(x, mesh_.faces, f, q));
    return std::sqrt(squared);
}

double Dirichlet::relative_error(const std::vector<double>& x) const {
    double largest = 0;
    for (std::size_t t = 0; t < nodes_.size(); ++t) {
        double squared = 0;
        for (int a = 0; a < dim_; ++a) squared += std::pow(difference(x, static_cast<int>(t), a), 2);
        largest = std::max(largest, std::sqrt(squared) / height_[t]);
    }
    return largest;
}

double Dirichlet::value(const std::vector<double>& x, const std::vector<double>& lambda, double mu) {
    set_v([&](int t, int a) { return difference(x, t, a); });
    const double half = 0.5 * mu / norm_of_one_;
    const double of_projection = dot_mass_times_v([&](int k) { return half * v_[k] - lambda[k]; }) / norm_of_one_;
    return of_projection + 0.5 * mu * best_approximation_error_ * best_approximation_error_;
}

void Dirichlet::add_gradient(const std::vector<double>& x, const std::vector<double>& lambda, double mu,
                             std::vector<double>& g) {
    set_v([&](int t, int a) {
        const double scaled = mu * difference(x, t, a) / norm_of_one_;
        return (scaled - lambda[offset(t, dim_, a)]) / norm_of_one_;
    });
    with_dimension(dim_, [&](auto n) {
        parallel_for(M_.n, [&](int t) {
            double Mv[n];
            mass_times_v<n>(t, Mv);
            for (int a = 0; a < n; ++a) g[offset(nodes_[t], n, a)] += Mv[a];
        }, mass_work);
    });
}

// Adds factor M; row(mesh node): its block row in H, or -1 where H leaves it out.
template <class Row>
void Dirichlet::add_mass(double factor, const Row& row, BlockCsr& H) const {
    parallel_for(M_.n, [&](int t) {
        const int i = row(nodes_[t]);
        for (int k = M_.row[t]; k < M_.row[t + 1] && i >= 0; ++k) {
            const int j = row(nodes_[M_.col[k]]), place = j < 0 ? -1 : H.find(i, j);
            if (place < 0) continue;
            double* const block = H.block(place);
            for (int a = 0; a < dim_; ++a) block[a * dim_ + a] += factor * M_.value[k];
        }
    }, 200);
}

// Positive semidefinite as it is.
void Dirichlet::add_hessian(const std::vector<double>&, const std::vector<double>&, double mu, bool, BlockCsr& H) {
    add_mass(mu / (norm_of_one_ * norm_of_one_), [&H](int node) { return H.row_of(node); }, H);
}

void Dirichlet::update_multipliers(const std::vector<double>& x, double mu, std::vector<double>& lambda) {
    for (int t = 0; t < M_.n; ++t)
        for (int a = 0; a < dim_; ++a) lambda[offset(t, dim_, a)] -= mu * difference(x, t, a) / norm_of_one_;
}

std::vector<double> Dirichlet::constraint_field(const std::vector<double>& x) const {
    std::vector<double> c(g_h_.size());
    for (int t = 0; t < M_.n; ++t)
        for (int a = 0; a < dim_; ++a) c[offset(t, dim_, a)] = difference(x, t, a) / norm_of_one_;
    return c;
}

namespace {

// With u = y - x, x where the part was made, C is exactly g.u + u'Cu/2 up to a constant, g its gradient at x.
class QuadraticPart : public ConstraintPart {
public:
    std::vector<double> x, g;  // nodes of the part x dim
    BlockCsr C;

    void add_value(const std::vector<double>& y, double& E) override {
        multiply_displacement(y);
        E += dot(g, u_);
        E += 0.5 * dot(u_, Cu_);
    }
    void add_gradient(const std::vector<double>& y, std::vector<double>& gradient) override {
        multiply_displacement(y);
        for (std::size_t i = 0; i < y.size(); ++i) gradient[i] += g[i] + Cu_[i];
    }
    void add_hessian(const std::vector<double>&, bool, BlockCsr& H) override {
        for (std::size_t k = 0; k < H.value.size(); ++k) H.value[k] += C.value[k];
    }

private:
    std::vector<double> u_, Cu_;

    void multiply_displacement(const std::vector<double>& y) {
        u_.resize(y.size());
        Cu_.resize(y.size());
        for (std::size_t i = 0; i < y.size(); ++i) u_[i] = y[i] - x[i];
        multiply(C, u_.data(), Cu_.data());
    }
};

}  // namespace

std::unique_ptr<ConstraintPart> Dirichlet::part(const std::vector<double>& x, const std::vector<double>& lambda,
                                                double mu, const std::vector<int>& node, const BlockCsr& pattern) {
    std::vector<double> gradient(x.size(), 0.0);
    add_gradient(x, lambda, mu, gradient);
    std::vector<int> row(mesh_.nodes(), -1);
    auto part = std::make_unique<QuadraticPart>();
    for (std::size_t k = 0; k < node.size(); ++k) {
        const int i = node[k];
        row[i] = static_cast<int>(k);
        part->x.insert(part->x.end(), point(x, i, dim_), point(x, i, dim_) + dim_);
        part->g.insert(part->g.end(), point(gradient, i, dim_), point(gradient, i, dim_) + dim_);
    }
    part->C = pattern;
    add_mass(mu / (norm_of_one_ * norm_of_one_), [&row](int i) { return row[i]; }, part->C);
    return part;
}

}  // namespace almesh
