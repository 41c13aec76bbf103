// K u = 0 inside, u = u_D at the fixed nodes:   K u_I = -K u_D with rows and columns of fixed nodes those of the unit
// matrix.
#include "method/linear_extension.hpp"

#include <algorithm>
#include <cmath>

#include "base/small_matrix.hpp"
#include "mesh/part.hpp"
#include "method/fixed_nodes.hpp"

namespace almesh {
namespace {

// K times a linear function, on curved elements too: an integral of cofactors of J, of degree n (p - 1); in each
// coordinate of a quadrilateral that is 2 p - 1.
int exactness(const CellType& cell, int degree) {
    return cell.is_simplex() && degree == 1 ? 0 : std::max(2 * degree, cell.dim * (degree - 1));
}

}  // namespace

Stiffness harmonic_stiffness(double) { return {.a = 1}; }

Stiffness elastic_stiffness(double jacobian) {
    constexpr double ratio = 0.3;  // v
    const double E = 1 / jacobian, l = E * ratio / ((1 + ratio) * (1 - 2 * ratio)), m = E / (2 * (1 + ratio));
    return {.a = m, .b = m, .c = l};
}

LinearExtension::LinearExtension(const Mesh& mesh, BlockCsr pattern, const LinearSolverParams& linear)
    : dim_(mesh.dim), K_(std::move(pattern)), solver_(mesh.dim, linear) {
    for (const ElementGroup& group : mesh.element_groups()) {
        const CellType& cell = *group.cell;
        const Quadrature quadrature = cell_quadrature(cell, exactness(cell, mesh.degree));
        const Mesh& of = groups_.emplace_back(Group{of_one_type(mesh, elements_of(group)), {}, {}}).mesh;
        groups_.back().reference = reference_element(cell, mesh.degree, quadrature);
        groups_.back().blocks = schedule_elements(of);
    }
}

template <int n>
void LinearExtension::add_element(const Group& of, StiffnessAt stiffness, const std::vector<double>& x, int e) {
    const ReferenceElement& reference = of.reference;
    const int m = reference.nodes;
    const int* const node = of.mesh.element(e);
    std::vector<Vec<n>> g(m);
    std::vector<Mat<n>> block(offset(m, m));
    for (int q = 0; q < reference.points; ++q) {
        const double* const dN = &reference.gradients[offset(q, m * n)];
        Mat<n> J{};  // dx/dxi
        for (int i = 0; i < m; ++i)
            for (int r = 0; r < n; ++r)
                for (int k = 0; k < n; ++k)
                    J[r][k] += (point(x, node[i], n)[r] - point(x, node[0], n)[r]) * dN[i * n + k];
        const double jacobian = std::abs(determinant(J)), weight = reference.weight[q] * jacobian;
        const Mat<n> inverse_of_J = inverse<n>(J);
        for (int i = 0; i < m; ++i) {
            g[i] = {};
            for (int r = 0; r < n; ++r)
                for (int k = 0; k < n; ++k) g[i][r] += dN[i * n + k] * inverse_of_J[k][r];
        }
        const Stiffness at = stiffness(jacobian);
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < m; ++j) {
                double product = 0;
                for (int r = 0; r < n; ++r) product += g[i][r] * g[j][r];
                Mat<n>& B = block[i * m + j];
                for (int r = 0; r < n; ++r) {
                    B[r][r] += weight * at.a * product;
                    for (int s = 0; s < n; ++s)
                        B[r][s] += weight * (at.b * g[j][r] * g[i][s] + at.c * g[i][r] * g[j][s]);
                }
            }
    }
    for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) {
            double* const entry = K_.block(K_.find(K_.row_of(node[i]), K_.row_of(node[j])));
            for (int r = 0; r < n; ++r)
                for (int s = 0; s < n; ++s) entry[r * n + s] += block[i * m + j][r][s];
        }
}

SolveResult LinearExtension::extend(StiffnessAt stiffness, const std::vector<double>& x, const std::vector<char>& fixed,
                                    std::vector<double>& u) {
    std::fill(K_.value.begin(), K_.value.end(), 0.0);
    for (Group& of : groups_)
        with_dimension(dim_, [&](auto n) {
            of.blocks.in_schedule(true, [&](int block) {
                const int end = std::min((block + 1) * of.blocks.size, of.mesh.element_count());
                for (int k = block * of.blocks.size; k < end; ++k)
                    add_element<n()>(of, stiffness, x, of.blocks.order[k]);
            });
        });
    std::vector<double> b = times_at_nodes(K_, u), inside;
    for (double& value : b) value = -value;
    fix_nodes(fixed, dim_, b);
    fix_nodes(fixed, K_);
    const SolveResult result = solver_.solve(K_, b, inside);
    fix_nodes(fixed, dim_, inside);  // to the last bit, whatever the solver
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += inside[i];
    return result;
}

}  // namespace almesh
