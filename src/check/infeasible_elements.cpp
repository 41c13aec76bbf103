// The Bezier coefficients of det J on a face s of the element are those of the whole with indices that are zero off s.
#include "check/infeasible.hpp"

#include <algorithm>
#include <optional>

#include "base/parallel.hpp"
#include "geometry/element_jacobian.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double element_work = 100;  // simple operations for one element, at least
constexpr int bisections = 500;

using Corners = std::vector<int>;

// A face of the element, of any dimension: where the determinant on it comes from.
struct Part {
    Corners corners;
    std::vector<int> nodes;         // of the element, on which it depends
    Bernstein basis;                // of the determinant on it,
    std::vector<int> coefficients;  // and where its coefficients are among those of the element
};

struct Table {
    JacobianBasis jacobian;
    LagrangeBasis lagrange;
    std::vector<Part> parts;

    Table(int n, int degree) : jacobian(n, degree), lagrange(n, degree) {
        for (int subset = 1; subset < 1 << (n + 1); ++subset) {
            Corners corners;
            for (int k = 0; k <= n; ++k)
                if (subset >> k & 1) corners.push_back(k);
            parts.push_back(part(corners, n));
        }
    }

    Part part(const Corners& corners, int n) const {
        const auto off = [&](const MultiIndex& index) {  // how many vertices outside it the index has
            int count = 0;
            for (int k = 0; k <= n; ++k)
                count += index[k] > 0 && std::find(corners.begin(), corners.end(), k) == corners.end();
            return count;
        };
        const int m = static_cast<int>(corners.size()) - 1;
        Part part{corners, {}, Bernstein(m, jacobian.jacobian.degree), {}};
        for (int i = 0; i < lagrange.count; ++i)
            if (off(lagrange.nodes[i]) <= 1) part.nodes.push_back(i);
        for (const MultiIndex& index : part.basis.index) {
            MultiIndex whole{};
            for (int k = 0; k <= m; ++k) whole[corners[k]] = index[k];
            part.coefficients.push_back(jacobian.jacobian.place(whole));
        }
        return part;
    }
};

bool all_of(const std::vector<int>& places, const int* node, const std::vector<char>& flag) {
    return std::all_of(places.begin(), places.end(), [&](int i) { return flag[node[i]]; });
}

std::optional<double> up_to(double bound, double value) {
    return value <= bound ? std::optional<double>(value) : std::nullopt;
}

// Nodes that are not held are at their positions on the straight element: where they count nothing is determined.
template <int n>
std::optional<double> value_of_curved(const Table& table, const int* node, const std::vector<double>& x,
                                      const std::vector<char>& held, double bound) {
    if (!std::any_of(table.parts.begin(), table.parts.end(),
                     [&](const Part& part) { return all_of(part.nodes, node, held); }))
        return std::nullopt;
    ElementJacobian<n, double> element(table.jacobian);
    for (int i = 0; i < table.lagrange.count; ++i) {
        Vec<n>& at = element.position(0)[i];
        std::copy_n(point(x, node[i], n), n, at.begin());
        if (held[node[i]]) continue;
        for (int a = 0; a < n; ++a) {
            at[a] = 0;
            for (int k = 0; k <= n; ++k)
                at[a] += table.lagrange.nodes[i][k] * x[offset(node[k], n, a)] / table.lagrange.degree;
        }
    }
    element.compute(1);
    if (!element.has_frame()) return up_to(bound, 0);
    const double straight = std::abs(determinant(straight_jacobian<n>(node, x)));
    const double scale = straight > 0 ? element.unit() / straight : 0;
    std::optional<double> least;
    for (const Part& part : table.parts) {
        if (!all_of(part.nodes, node, held)) continue;
        std::vector<double> c;
        for (const int place : part.coefficients) c.push_back(scale * element.coefficients(0)[place]);
        const double value = part.basis.dim == 0 ? c[0] : compare_with(part.basis, c.data(), bound, bisections).upper;
        if (value <= bound) least = std::min(value, least.value_or(value));
    }
    return least;
}

// At a corner of a cell that is no simplex det J is determined by the nodes of its edges there: the least one, over the
// lengths of the tangents. At the apex of a pyramid no corner's edges determine it.
template <int n>
std::optional<double> value_at_corners(const LagrangeBasis& basis, const int* node, const std::vector<double>& x,
                                       const std::vector<char>& held, double bound) {
    std::optional<double> least;
    std::array<double, n * most_element_nodes> dN;
    const int corners = basis.cell.vertices - basis.cell.is_collapsed;
    for (int v = 0; v < corners; ++v) {
        if (!held[node[v]]) continue;
        basis.gradients(basis.point(v).data(), dN.data());
        Mat<n> J{};
        bool is_determined = true;
        for (int i = 0; i < basis.count; ++i) {
            double size = 0;
            for (int k = 0; k < n; ++k) size += std::abs(dN[n * i + k]);
            is_determined = is_determined && (size <= 1e-12 || held[node[i]]);
            for (int a = 0; a < n; ++a)
                for (int k = 0; k < n; ++k)
                    J[a][k] += dN[n * i + k] * (point(x, node[i], n)[a] - point(x, node[v], n)[a]);
        }
        double lengths = 1;
        for (int k = 0; k < n; ++k)
            lengths *= n == 2 ? std::hypot(J[0][k], J[1][k]) : std::hypot(J[0][k], J[1][k], J[n - 1][k]);
        const double value = lengths > 0 ? determinant(J) / lengths : 0;
        if (is_determined && value <= bound) least = std::min(value, least.value_or(value));
    }
    return least;
}

}  // namespace

std::vector<InfeasibleElement> infeasible_elements(const Mesh& mesh, const std::vector<double>& x,
                                                   const std::vector<char>& held, double bound) {
    std::optional<Table> table;
    if (mesh.degree > 1) table.emplace(mesh.dim, mesh.degree);
    std::vector<std::optional<double>> value(mesh.element_count());
    std::vector<InfeasibleElement> found;
    const std::vector<LagrangeBasis> bases = bases_of(mesh.element_groups(), mesh.degree);
    with_dimension(mesh.dim, [&](auto n) {
        parallel_for(mesh.element_count(), [&](int e) {
            const int* const node = mesh.element(e);
            if (const LagrangeBasis& basis = bases[mesh.group_number(e)]; !basis.cell.is_simplex())
                value[e] = value_at_corners<n>(basis, node, x, held, bound);
            else if (std::all_of(node, node + n + 1, [&](int i) { return held[i]; }))
                value[e] = table ? value_of_curved<n>(*table, node, x, held, bound)
                                 : up_to(bound, straight_scaled_determinant<n>(node, x));
        }, element_work);
        for (int e = 0; e < mesh.element_count(); ++e)
            if (value[e])
                found.push_back({e, *value[e],
                                 mesh.cell(e).is_simplex() && straight_scaled_determinant<n>(mesh.element(e), x) > 0});
    });
    return found;
}

}  // namespace almesh
